// The keys of a finishing effect's mask.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/image/finish_pass.h"
#include "core/image/status.h"
#include "core/style/finish_keys.h"

namespace scumble {

// The key whose value is kRadialMask or the name of a picture.
inline constexpr const char* kMaskKey = "mask";

// mask, mask_near, mask_far, mask_soft, mask_invert. Names of pictures are relative to the working folder.
std::vector<FinishKey> FinishMaskKeys();

// Sets the shape of the mask and reads its picture, if it has one: its share is the lightness, 0.2126 R + 0.7152 G +
// 0.0722 B of the sRGB codes, times alpha. kInput names a file that cannot be read.
Status SetMaskShape(const std::string& shape, const std::filesystem::path& folder, FinishMask& mask);

}  // namespace scumble
