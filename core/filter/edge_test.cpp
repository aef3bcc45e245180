#include "core/filter/edge_test.h"

#include <limits>
#include <optional>

#include "core/filter/parallel.h"
#include "core/image/exact_math.h"

namespace scumble::internal {
namespace {

// The surface's slope in depth per pixel, from both neighbours. Where both differences have one sign, the gentler one:
// the steeper may be an edge. Where the signs differ, 0: a part one pixel wide turns there, and so does the top of a
// hill, whose slope is small. Without a neighbour on both sides a slope looks like a step, so the slope counts as 0.
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

DepthTolerance::DepthTolerance(const GuideSet& guides, double depth_tolerance) {
  const bool flat = guides.camera && guides.camera->IsOrthographic();
  const double height = flat ? 2.0 / std::abs(guides.camera->clip_from_view[1][1]) : 0.0;
  const auto metres = static_cast<float>(depth_tolerance * height);
  const bool seen = height > 0.0 && std::isfinite(metres);
  fixed = seen ? metres : 0.0f;
  share = seen ? 0x1p-20f : static_cast<float>(depth_tolerance);
}

float EdgeRules::CreaseCosine(double degrees) {
  return degrees < 180.0 ? static_cast<float>(CosDegrees(degrees)) : -std::numeric_limits<float>::infinity();
}

EdgeTest::EdgeTest(const GuideSet& guides, const DepthSlopes& slopes, double crease_degrees, double depth_tolerance)
    : object_(guides.Plane(Layer::kObject)),
      depth_(guides.Plane(Layer::kDepth)),
      slope_x_(slopes.x),
      slope_y_(slopes.y),
      normal_x_(guides.Plane(Layer::kNormal, 0)),
      normal_y_(guides.Plane(Layer::kNormal, 1)),
      normal_z_(guides.Plane(Layer::kNormal, 2)),
      crease_cosine_(EdgeRules::CreaseCosine(crease_degrees)),
      tolerance_(guides, depth_tolerance) {}

}  // namespace scumble::internal
