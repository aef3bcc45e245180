// The smallest size a packed picture can have. A file that declares more is refused before memory is allocated for it.
#pragma once

#include <cstdint>

namespace scumble::internal {

// Most bytes that one of Deflate (RFC 1951) unpacks to: it writes at least 2 bits, a length and a distance of a bit
// each, for a run of 258 bytes.
inline constexpr std::uint64_t kMostDeflated = 258 * 8 / 2;

}  // namespace scumble::internal
