#include "pipeline/requests.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "core/image/guides.h"
#include "core/io/picture_file.h"
#include "pipeline/frame_range.h"
#include "transfer/upsample_guides.h"

namespace scumble {

std::string SizeToText(const Size& size) { return fmt::format("{}x{}", size.width, size.height); }

Status CheckSize(const Size& size, const std::string& text) {
  if (size.width < 1 || size.height < 1 || size.width > kMaxImageSide || size.height > kMaxImageSide) {
    return UsageError("--size " + text + ": expected WIDTHxHEIGHT, as in 1920x1080, each 1 to " +
                      std::to_string(kMaxImageSide));
  }
  if (std::int64_t(size.width) * size.height > kMaxPicturePixels) {
    return UsageError("--size " + text + ": expected at most " + std::to_string(kMaxPicturePixels) +
                      " pixels in all, as in 16384x16384");
  }
  return Ok();
}

Expected<Size> GuideSizeFor(const Size& size, int upsample) {
  if (upsample < 1 || upsample > kMaxUpsampling) {
    return UsageError(fmt::format("--upsample {}: expected 1 to {}", upsample, kMaxUpsampling));
  }
  if (size.width % upsample || size.height % upsample) {
    return UsageError(
        fmt::format("--size {} with --upsample {}: the guides are {} times smaller, so both sides must be "
                    "multiples of {}; take --size {}x{}",
                    SizeToText(size), upsample, upsample, upsample, (size.width + upsample - 1) / upsample * upsample,
                    (size.height + upsample - 1) / upsample * upsample));
  }
  return Size{size.width / upsample, size.height / upsample};
}

bool HasEnding(const std::string& path, std::initializer_list<const char*> endings) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

Status CheckPictureRequest(const PictureRequest& request) {
  SCUMBLE_RETURN_IF_ERROR(CheckFrame(request.frame));
  if (!request.layers_out.empty() && request.output.empty()) {
    return UsageError("--layers-out " + request.layers_out + ": it goes with a picture, give -o FILE too");
  }
  if (!request.upscale) return Ok();
  if (request.upsample == 1) return UsageError("--upscale: it needs --upsample N, by which the picture is scaled up");
  if (!request.over.empty()) {
    return UsageError("--upscale with --over: the picture underneath has its full size, leave --upscale out");
  }
  if (request.IsShowing()) {
    return UsageError("--upscale with --show: what is shown is by pixel of the small picture, leave --upscale out");
  }
  if (!request.layers_out.empty()) {
    return UsageError("--upscale with --layers-out: layers have the size that is painted, leave --upscale out");
  }
  return Ok();
}

}  // namespace scumble
