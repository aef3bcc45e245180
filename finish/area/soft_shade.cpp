#include <limits>

#include "finish/area/area_effects.h"
#include "finish/area/gaussian_rows.h"
#include "finish/area/oklab_blocks.h"
#include "finish/tone/point_effect.h"

namespace scumble::internal {

FloatPlane SoftShade(const ShadowsPass& pass, const FinishFrame& frame) {
  const GuideSet& guides = *frame.guides;
  const auto coverage = guides.Plane(Layer::kCoverage), object = guides.Plane(Layer::kObject);
  FloatPlane hard(coverage.size()), keys(coverage.size());
  ForEachOklabBlock(hard.size(), [&](std::size_t first, std::size_t count) {
    ShadeOf(pass, frame, first, count, hard.data() + first);
    for (std::size_t i = first; i < first + count; ++i) {
      const bool is_covered = coverage[i] > 0.0f;
      if (!is_covered || !(hard[i] > 0.0f)) hard[i] = 0.0f;  // not a number: none
      keys[i] = is_covered ? object[i] : std::numeric_limits<float>::quiet_NaN();
    }
  });
  return BlurredWithin(hard, keys, guides.width(), guides.height(), pass.soften * frame.scale);
}

}  // namespace scumble::internal
