// A module of the same version whose types have other sizes: only that is checked.
#include <cstdint>

#define SCUMBLE_JOINED_INNER(a, b) a##b
#define SCUMBLE_JOINED(a, b) SCUMBLE_JOINED_INNER(a, b)

extern "C" {
extern const std::uint64_t SCUMBLE_JOINED(scumble_formats_, SCUMBLE_MODULE_SYMBOL)[16];
const std::uint64_t SCUMBLE_JOINED(scumble_formats_, SCUMBLE_MODULE_SYMBOL)[16] = {};
}
