#include "io/guide_storage.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "io/guide_file.h"

namespace scumble {
namespace internal {
namespace {

constexpr const char* kCompressions[] = {"none", "rle", "zips", "zip", "piz"};

}  // namespace

bool IsLossless(const std::string& compression) {
  return std::find(std::begin(kCompressions), std::end(kCompressions), compression) != std::end(kCompressions);
}

Imath::half ToHalf(float value) {
  constexpr float kLargest = 65504.0f;
  return std::isfinite(value) ? Imath::half(std::clamp(value, -kLargest, kLargest)) : Imath::half(value);
}

}  // namespace internal

Status CheckGuideTarget(const std::filesystem::path& path, const GuideWriteOptions& options) {
  if (path.extension() != ".exr" && path.extension() != ".EXR") {
    return UsageError("cannot write guides to " + path.string() + ": guides are EXR files, name it .exr");
  }
  if (!internal::IsLossless(options.compression)) {
    return UsageError("compression '" + options.compression +
                      "' is not one of none, rle, zips, zip, piz: guides are data and lossy compression is refused");
  }
  return Ok();
}

void RoundColorLayersToHalf(GuideSet& guides) {
  for (const LayerInfo& info : AllLayers()) {
    if (!guides.Has(info.layer) || !info.is_color) continue;
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      for (float& value : guides.Plane(info.layer, c)) value = static_cast<float>(internal::ToHalf(value));
    }
  }
}

}  // namespace scumble
