#include "transfer/edges.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "transfer/parallel.h"

namespace scumble::internal {
namespace {

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

DepthSlopes::DepthSlopes(const GuideSet& guides) : x(guides.pixel_count(), 0.0f), y(guides.pixel_count(), 0.0f) {
  const auto coverage = guides.Plane(Layer::kCoverage), depth = guides.Plane(Layer::kDepth);
  const int width = guides.width(), height = guides.height();
  tbb::parallel_for(0, height, [&](int row) {
    for (int column = 0; column < width; ++column) {
      const std::size_t i = guides.Index(column, row);
      if (!(coverage[i] > 0.0f)) continue;
      const auto depth_at = [&](bool inside, std::size_t index) -> std::optional<float> {
        if (!inside || !(coverage[index] > 0.0f)) return std::nullopt;
        return depth[index];
      };
      x[i] = Slope(depth_at(column > 0, i - 1), depth[i], depth_at(column + 1 < width, i + 1));
      y[i] = Slope(depth_at(row > 0, i - width), depth[i], depth_at(row + 1 < height, i + width));
    }
  });
}

// At 180 degrees even opposite normals pass, whose cosine rounding may put below -1.
EdgeTest::EdgeTest(const GuideSet& guides, const DepthSlopes& slopes, double crease_degrees, double depth_tolerance)
    : guides_(guides),
      slopes_(slopes),
      depth_(guides.Plane(Layer::kDepth)),
      object_(guides.Plane(Layer::kObject)),
      crease_cosine_(crease_degrees < 180.0
                         ? static_cast<float>(std::cos(crease_degrees * (3.14159265358979323846 / 180.0)))
                         : -std::numeric_limits<float>::infinity()),
      depth_tolerance_(static_cast<float>(depth_tolerance)) {}

bool EdgeTest::SameSurface(std::size_t p, std::size_t q, int dx, int dy) const {
  if (p == q) return true;
  if (object_[p] != object_[q]) return false;
  const float x = static_cast<float>(dx), y = static_cast<float>(dy);
  const float expected = 0.5f * ((slopes_.x[p] + slopes_.x[q]) * x + (slopes_.y[p] + slopes_.y[q]) * y);
  const float leeway = std::min(std::fabs(slopes_.x[p]), std::fabs(slopes_.x[q])) * std::fabs(x) +
                       std::min(std::fabs(slopes_.y[p]), std::fabs(slopes_.y[q])) * std::fabs(y);
  const float tolerance = leeway + depth_tolerance_ * std::min(depth_[p], depth_[q]);
  if (!(std::fabs(depth_[q] - depth_[p] - expected) <= tolerance)) return false;
  const glm::vec3 a = guides_.Vec3(Layer::kNormal, p), b = guides_.Vec3(Layer::kNormal, q);
  return a.x * b.x + a.y * b.y + a.z * b.z > crease_cosine_;
}

}  // namespace scumble::internal
