// Pictures as the page gets them.
#pragma once

#include <optional>
#include <string>

#include "core/image/status.h"
#include "scumble/picture.h"

namespace scumble {

enum class FrameFormat { kJpeg, kRgba, kPng };
std::optional<FrameFormat> FindFrameFormat(const std::string& name);  // "jpeg", "rgba", "png"
std::string ContentTypeOf(FrameFormat format);

// The bytes. JPEG (libjpeg-turbo) lies on white: drafts at quality 90, with colours at half the resolution; finals at
// 92, with colours at full resolution. RGBA is 8 bits a channel, straight alpha, rows from the top. PNG is 8 bits and
// packed as fast as zlib can.
Expected<std::string> EncodeFrame(const Picture& picture, FrameFormat format, bool draft);

}  // namespace scumble
