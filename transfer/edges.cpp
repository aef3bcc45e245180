#include "transfer/edges.h"

#include <algorithm>
#include <optional>

#include "transfer/parallel.h"

namespace scumble::internal {
namespace {

constexpr float kCreaseCosine = 0.5f;  // 60°
constexpr float kDistanceFactor = 0.002f;

// The surface's slope in depth per pixel, from both neighbours: the gentler difference where both point the same way (the
// steeper may be an edge), 0 where they do not. A part one pixel wide is such a turning point, and so is the top of a
// hill, whose slope is small. Without a neighbour on both sides nothing tells a slope from a step: it counts as none.
float Slope(std::optional<float> before, float here, std::optional<float> after) {
  if (!before || !after) return 0.0f;
  const float back = here - *before, front = *after - here;
  if (!(back * front > 0.0f)) return 0.0f;
  return std::fabs(back) < std::fabs(front) ? back : front;
}

}  // namespace

EdgeTest::EdgeTest(const GuideSet& guides)
    : guides_(guides),
      depth_(guides.Plane(Layer::kDepth)),
      object_(guides.Plane(Layer::kObject)),
      slope_x_(guides.pixel_count(), 0.0f),
      slope_y_(guides.pixel_count(), 0.0f) {
  const auto coverage = guides.Plane(Layer::kCoverage);
  const int width = guides.width(), height = guides.height();
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = guides.Index(x, y);
      if (!(coverage[i] > 0.0f)) continue;
      const auto depth_at = [&](bool inside, std::size_t index) -> std::optional<float> {
        if (!inside || !(coverage[index] > 0.0f)) return std::nullopt;
        return depth_[index];
      };
      slope_x_[i] = Slope(depth_at(x > 0, i - 1), depth_[i], depth_at(x + 1 < width, i + 1));
      slope_y_[i] = Slope(depth_at(y > 0, i - width), depth_[i], depth_at(y + 1 < height, i + width));
    }
  });
}

bool EdgeTest::SameSurface(std::size_t p, std::size_t q, int dx, int dy) const {
  if (p == q) return true;
  if (object_[p] != object_[q]) return false;
  const float x = static_cast<float>(dx), y = static_cast<float>(dy);
  const float expected = 0.5f * ((slope_x_[p] + slope_x_[q]) * x + (slope_y_[p] + slope_y_[q]) * y);
  const float leeway = std::min(std::fabs(slope_x_[p]), std::fabs(slope_x_[q])) * std::fabs(x) +
                       std::min(std::fabs(slope_y_[p]), std::fabs(slope_y_[q])) * std::fabs(y);
  const float tolerance = leeway + kDistanceFactor * std::min(depth_[p], depth_[q]);
  if (!(std::fabs(depth_[q] - depth_[p] - expected) <= tolerance)) return false;
  const glm::vec3 a = guides_.Vec3(Layer::kNormal, p), b = guides_.Vec3(Layer::kNormal, q);
  return a.x * b.x + a.y * b.y + a.z * b.z > kCreaseCosine;
}

}  // namespace scumble::internal
