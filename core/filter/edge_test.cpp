#include "core/filter/edge_test.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <optional>

#include "core/image/exact_math.h"
#include "core/filter/parallel.h"

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

DepthGive::DepthGive(const GuideSet& guides, double depth_tolerance) {
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
      give_(guides, depth_tolerance) {}

namespace {

constexpr PixelStep kForward[] = {{1, 0}, {-1, 1}, {0, 1}, {1, 1}};

}  // namespace

PixelStep StepBefore(PixelStep at) {
  const int wide = std::abs(at.dx), high = std::abs(at.dy), n = std::max(wide, high);
  const auto nearer = [&](int side) { return (2 * std::abs(side) * (n - 1) + n) / (2 * n) * (side < 0 ? -1 : 1); };
  return {nearer(at.dx), nearer(at.dy)};
}

JoinedWindow::JoinedWindow(const EdgeTest& test, const GuideSet& guides, int radius, const Region& region)
    : test_(test), width_(guides.width()), radius_(radius) {
  const Region grown = region.GrownBy(radius, guides.width(), guides.height());
  first_column_ = grown.x0 - 1, first_row_ = grown.y0 - 1;
  stride_ = grown.x1 - grown.x0 + 2;
  steps_.assign(std::size_t(stride_) * (grown.y1 - grown.y0 + 2), 0);
  MarkSteps(guides, grown);
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (radius > 0 && (dx != 0 || dy != 0)) Grow(dx, dy);
    }
  }
}

// The way to (dx, dy) and all that lead over it.
void JoinedWindow::Grow(int dx, int dy) {
  const PixelStep before = StepBefore({dx, dy}), step{dx - before.dx, dy - before.dy};
  // A step back is kept where it ends.
  const bool back = step.dy < 0 || (step.dy == 0 && step.dx < 0);
  const PixelStep holder = back ? PixelStep{dx, dy} : before, forward = back ? PixelStep{-step.dx, -step.dy} : step;
  std::uint8_t bit = 1;
  for (const PixelStep& one : kForward) {
    if (one.dx == forward.dx && one.dy == forward.dy) break;
    bit = static_cast<std::uint8_t>(2 * bit);
  }
  const std::size_t mine = ways_.size();
  ways_.push_back({static_cast<std::int16_t>(dx), static_cast<std::int16_t>(dy), dy * width_ + dx,
                   holder.dy * stride_ + holder.dx, 0, bit});
  for (int y = dy - 1; y <= dy + 1; ++y) {
    for (int x = dx - 1; x <= dx + 1; ++x) {
      if (std::max(std::abs(x), std::abs(y)) > radius_ || (x == dx && y == dy) || (x == 0 && y == 0)) continue;
      const PixelStep from = StepBefore({x, y});
      if (from.dx == dx && from.dy == dy) Grow(x, y);
    }
  }
  ways_[mine].beyond = static_cast<std::uint32_t>(ways_.size());
}

void JoinedWindow::MarkSteps(const GuideSet& guides, const Region& grown) {
  const auto coverage = guides.Plane(Layer::kCoverage);
  tbb::parallel_for(grown.y0, grown.y1, [&](int y) {
    for (int x = grown.x0; x < grown.x1; ++x) {
      const std::size_t p = guides.Index(x, y);
      if (!(coverage[p] > 0.0f)) continue;
      const EdgeTest::Side here = test_.At(p);
      unsigned bits = 0;
      for (int k = 0; k < 4; ++k) {
        const PixelStep step = kForward[k];
        if (x + step.dx < grown.x0 || x + step.dx >= grown.x1 || y + step.dy >= grown.y1) continue;
        const std::size_t q = guides.Index(x + step.dx, y + step.dy);
        if (coverage[q] > 0.0f && test_.SameSurface(here, test_.At(q), step.dx, step.dy)) bits |= 1u << k;
      }
      steps_[std::size_t(y - first_row_) * stride_ + (x - first_column_)] = static_cast<std::uint8_t>(bits);
    }
  });
}

}  // namespace scumble::internal
