#include "core/filter/outline_distance.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/filter/edge_test.h"

namespace scumble::internal {
namespace {

// As outlines have it (finish/outline/border_map.cpp).
constexpr double kDepthTolerance = 0.002;

// Where the nearest border's pixel lies, from here.
struct Offset {
  std::int16_t x, y;
  std::int32_t Squared() const { return std::int32_t(x) * x + std::int32_t(y) * y; }
};
constexpr Offset kNowhere{20000, 20000};

// Offsets of 0 beside an object's own borders, kNowhere elsewhere.
std::vector<Offset> OwnBorders(const Region& window, const GuideSet& guides) {
  const DepthSlopes slopes(guides);
  const EdgeTest edges(guides, slopes, 180.0, kDepthTolerance);
  const auto coverage = guides.Plane(Layer::kCoverage), depth = guides.Plane(Layer::kDepth);
  std::vector<Offset> offsets(guides.pixel_count(), kNowhere);
  tbb::parallel_for(window.y0, std::max(window.y0, window.y1), [&](int y) {
    for (int x = window.x0; x < window.x1; ++x) {
      const std::size_t p = guides.Index(x, y);
      if (!(coverage[p] > 0.0f)) continue;
      for (const auto& [dx, dy] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
        const int u = x + dx, v = y + dy;
        if (u < window.x0 || v < window.y0 || u >= window.x1 || v >= window.y1) continue;
        const std::size_t q = guides.Index(u, v);
        const bool ends =
            !(coverage[q] > 0.0f) || (!edges.SameSurface(edges.At(p), edges.At(q), dx, dy) && depth[p] <= depth[q]);
        if (ends) offsets[p] = {0, 0};
      }
    }
  });
  return offsets;
}

class Sweeps {
 public:
  Sweeps(const GuideSet& guides, std::vector<Offset>& offsets)
      : width_(guides.width()), height_(guides.height()), object_(guides.Plane(Layer::kObject)), offsets_(offsets) {}

  void Run() {
    for (int y = 0; y < height_; ++y) Row(y, -1);
    for (int y = height_ - 1; y >= 0; --y) Row(y, 1);
  }

 private:
  // From the row above (side -1) or below, then along the row, there and back.
  void Row(int y, int side) {
    for (int x = 0; x < width_; ++x) {
      for (const int dx : {-1, 0, 1}) Take(x, y, dx, side);
      Take(x, y, -1, 0);
    }
    for (int x = width_ - 1; x >= 0; --x) Take(x, y, 1, 0);
  }

  void Take(int x, int y, int dx, int dy) {
    const int u = x + dx, v = y + dy;
    if (u < 0 || v < 0 || u >= width_ || v >= height_) return;
    const std::size_t p = std::size_t(y) * std::size_t(width_) + std::size_t(x),
                      q = std::size_t(v) * std::size_t(width_) + std::size_t(u);
    if (object_[p] != object_[q]) return;
    const Offset from = offsets_[q];
    if (from.x == kNowhere.x) return;
    const Offset offset{static_cast<std::int16_t>(from.x + dx), static_cast<std::int16_t>(from.y + dy)};
    if (offset.Squared() < offsets_[p].Squared() && std::abs(offset.x) <= kReach && std::abs(offset.y) <= kReach)
      offsets_[p] = offset;
  }

  static constexpr int kReach = static_cast<int>(kMostOutlineDistance);
  int width_, height_;
  std::span<const float> object_;
  std::vector<Offset>& offsets_;
};

}  // namespace

void FillOutlineDistance(const Region& window, GuideSet& guides) {
  guides.Add(Layer::kOutline);
  std::vector<Offset> offsets = OwnBorders(window, guides);
  Sweeps(guides, offsets).Run();
  const auto distance = guides.Plane(Layer::kOutline);
  const auto coverage = guides.Plane(Layer::kCoverage);
  for (std::size_t i = 0; i < distance.size(); ++i) {
    const double away = std::sqrt(double(offsets[i].Squared())) + 0.5;
    distance[i] = coverage[i] > 0.0f ? std::min(static_cast<float>(away), kMostOutlineDistance) : 0.0f;
  }
}

}  // namespace scumble::internal
