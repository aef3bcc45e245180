#include "core/io/guide_precision.h"

#include <algorithm>
#include <cmath>

#include "core/image/fragments.h"
#include "core/io/exr/half_float.h"
#include "core/io/guides/guide_storage.h"

namespace scumble {
namespace {

float InEightBits(float value) { return std::floor(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f) / 255.0f; }

float Rounded(float value, bool is_signed, GuidePrecision precision) {
  if (precision == GuidePrecision::kHalf) return static_cast<float>(internal::ToHalf(value));
  return is_signed ? 2.0f * InEightBits(0.5f * value + 0.5f) - 1.0f : InEightBits(value);
}

}  // namespace

void RoundGuides(GuidePrecision precision, GuideSet& guides) {
  if (precision == GuidePrecision::kFloat) return;
  if (guides.fragments) {
    auto rounded = std::make_shared<Fragments>(*guides.fragments);
    RoundGuides(precision, rounded->values);
    guides.fragments = std::move(rounded);
  }
  const auto coverage = guides.Plane(Layer::kCoverage);
  for (const LayerInfo& info : AllLayers()) {
    const bool normal = info.layer == Layer::kNormal;
    if (!guides.Has(info.layer) || !(normal || info.is_color)) continue;
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      const auto plane = guides.Plane(info.layer, c);
      for (std::size_t i = 0; i < plane.size(); ++i) {
        if (coverage[i] > 0.0f) plane[i] = Rounded(plane[i], normal, precision);
      }
    }
  }
  internal::NormalizeNormals(guides);
}

}  // namespace scumble
