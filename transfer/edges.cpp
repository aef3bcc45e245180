#include "transfer/edges.h"

#include <algorithm>

#include "transfer/parallel.h"

namespace scumble::internal {
namespace {

constexpr float kCreaseCosine = 0.5f;  // 60°
constexpr float kSlopeFactor = 2.0f;
constexpr float kDistanceFactor = 0.002f;

// The smaller of the differences to both neighbours; 0 where there is none.
float GentlerSide(float before, float here, float after, bool has_before, bool has_after) {
  const float back = std::fabs(here - before), front = std::fabs(after - here);
  const bool back_counts = has_before && std::isfinite(back), front_counts = has_after && std::isfinite(front);
  if (back_counts && front_counts) return std::min(back, front);
  return back_counts ? back : front_counts ? front : 0.0f;
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
      const auto depth_at = [&](bool inside, std::size_t index) { return inside ? depth_[index] : 0.0f; };
      slope_x_[i] = GentlerSide(depth_at(x > 0, i - 1), depth_[i], depth_at(x + 1 < width, i + 1), x > 0, x + 1 < width);
      slope_y_[i] = GentlerSide(depth_at(y > 0, i - width), depth_[i], depth_at(y + 1 < height, i + width), y > 0,
                                y + 1 < height);
    }
  });
}

bool EdgeTest::SameSurface(std::size_t p, std::size_t q, int dx, int dy) const {
  if (p == q) return true;
  if (object_[p] != object_[q]) return false;
  const float explained = std::max(slope_x_[p], slope_x_[q]) * static_cast<float>(std::abs(dx)) +
                          std::max(slope_y_[p], slope_y_[q]) * static_cast<float>(std::abs(dy));
  const float tolerance = kSlopeFactor * explained + kDistanceFactor * std::min(depth_[p], depth_[q]);
  if (!(std::fabs(depth_[p] - depth_[q]) <= tolerance)) return false;
  const glm::vec3 a = guides_.Vec3(Layer::kNormal, p), b = guides_.Vec3(Layer::kNormal, q);
  return a.x * b.x + a.y * b.y + a.z * b.z > kCreaseCosine;
}

}  // namespace scumble::internal
