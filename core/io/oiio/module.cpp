// The function table of the module of formats. The symbol's name holds the version, so that a module of another version
// is refused.
#include "core/io/format_dispatch.h"

namespace scumble {

#define SCUMBLE_JOINED_INNER(a, b) a##b
#define SCUMBLE_JOINED(a, b) SCUMBLE_JOINED_INNER(a, b)

extern "C" {
__attribute__((visibility("default"))) extern const Formats SCUMBLE_JOINED(scumble_formats_, SCUMBLE_MODULE_SYMBOL);
const Formats SCUMBLE_JOINED(scumble_formats_, SCUMBLE_MODULE_SYMBOL) = {
    kFormatsLayout,          formats::ReadPicture,   formats::DecodePicture, formats::InspectPicture,
    formats::InspectEncoded, formats::InspectStored, formats::EncodeJpeg,    formats::ReadChannels,
    formats::ReadGuides,     formats::InspectGuides, formats::SetThreads,
};
}

}  // namespace scumble
