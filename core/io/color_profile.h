// Pictures whose file says by an ICC profile what its numbers mean.
#pragma once

#include <cstddef>
#include <span>

#include "scumble/picture.h"

namespace scumble::internal {

// Converts a picture's codes from the profile's to sRGB's, by Little CMS, relative colorimetric with black point
// compensation. Colours that sRGB does not have become its nearest. Alpha stays. Where the profile is sRGB, to half a
// code of 8 bits, the codes stay. A profile that is broken, for other than RGB and grey, or a grey one of a
// picture with colours is not applied, as in web browsers. `picture` holds what the file has in each channel; of grey
// files, three times the same. Returns the largest change of a colour's code, 0 where codes stay.
int ConvertToSrgb(std::span<const std::byte> profile, Picture& picture);

// Whether ConvertToSrgb keeps the codes of every picture that has this profile.
bool IsAlwaysIgnored(std::span<const std::byte> profile);

// The ICC profile in the bytes of a WebP or HEIF file, whose readers do not always give it. Empty: none.
std::span<const std::byte> EmbeddedProfile(std::span<const std::byte> file);

}  // namespace scumble::internal
