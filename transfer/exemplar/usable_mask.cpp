#include "transfer/exemplar/usable_mask.h"

#include <algorithm>

#include "core/filter/distance_transform.h"

namespace scumble::internal {

std::vector<std::uint8_t> UsableMask(const GuideSet& guides, double rim) {
  const auto coverage = guides.Plane(Layer::kCoverage);
  std::vector<std::uint8_t> mask(guides.pixel_count());
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = coverage[i] > 0.0f;
  const double limit = rim * rim;
  ForNearestFeature(
      guides.width(), guides.height(), [&](std::size_t i) { return !(coverage[i] > 0.0f); },
      [&](std::size_t i, int x, int y, int u, int v) {
        const double dx = x - u, dy = y - v;
        if (dx * dx + dy * dy < limit) mask[i] = 0;
      });
  return mask;
}

Picture ExtendPaint(const Picture& picture, std::span<const std::uint8_t> mask) {
  Picture extended = picture;
  ForNearestFeature(
      picture.width, picture.height, [&](std::size_t i) { return mask[i] != 0; },
      [&](std::size_t, int x, int y, int u, int v) {
        if (u != x || v != y) std::copy_n(picture.At(u, v), 4, extended.At(x, y));
      });
  return extended;
}

}  // namespace scumble::internal
