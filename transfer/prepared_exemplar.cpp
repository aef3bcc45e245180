#include "transfer/prepared_exemplar.h"

#include <algorithm>
#include <limits>

#include "image/check.h"
#include "transfer/resample.h"

namespace scumble {
namespace {

// (N · usable fraction)² in half pixels, but never without the pixels at the centre.
std::int64_t UsableLimit(int size, double fraction) {
  const double radius = size * std::max(0.0, fraction);
  return std::max<std::int64_t>(2, static_cast<std::int64_t>(std::floor(radius * radius)));
}

// Replaces everything beyond the usable disc by the nearest usable paint along the radius, so that a filter which
// reaches over the rim meets paint and not what lies around the sphere.
Picture ExtendPaint(const Picture& picture, std::int64_t limit) {
  Picture extended = picture;
  const int size = picture.width;
  const double radius = std::sqrt(static_cast<double>(limit));
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const std::int64_t dx = 2 * x + 1 - size, dy = 2 * y + 1 - size;
      if (dx * dx + dy * dy <= limit) continue;
      const double length = std::sqrt(static_cast<double>(dx * dx + dy * dy));
      // Steps inward until the pixel is usable: rounding to pixels may need one or two beyond the exact radius.
      for (double r = radius;; r -= 1.0) {
        const int sx = std::clamp(static_cast<int>(std::floor((dx / length * std::max(r, 0.0) + size) / 2)), 0, size - 1);
        const int sy = std::clamp(static_cast<int>(std::floor((dy / length * std::max(r, 0.0) + size) / 2)), 0, size - 1);
        const std::int64_t ex = 2 * sx + 1 - size, ey = 2 * sy + 1 - size;
        if (ex * ex + ey * ey > limit && r > 0.0) continue;
        std::copy_n(picture.At(sx, sy), 4, extended.At(x, y));
        break;
      }
    }
  }
  return extended;
}

}  // namespace

PreparedExemplar::PreparedExemplar(std::span<const Picture* const> pictures, double rim, int size) : size_(size) {
  SCUMBLE_CHECK(!pictures.empty() && size >= 1 && size <= 32767);
  const auto fraction = [rim](const Picture& picture) { return 1.0 - rim / (0.5 * picture.width); };
  limit_ = std::numeric_limits<std::int64_t>::max();
  for (const Picture* picture : pictures) {
    SCUMBLE_CHECK_EQ(picture->width, picture->height);
    limit_ = std::min(limit_, UsableLimit(size, fraction(*picture)));
  }
  usable_radius_ = static_cast<float>(std::sqrt(static_cast<double>(limit_)) / size);
  coordinate_.resize(size);
  for (int i = 0; i < size; ++i) coordinate_[i] = static_cast<float>(2 * i + 1 - size) / static_cast<float>(size);
  for (const Picture* picture : pictures) {
    pictures_.push_back(Resample(ExtendPaint(*picture, UsableLimit(picture->width, fraction(*picture))), size, size));
  }
}

Source PreparedExemplar::NearestNeighbour(glm::vec3 normal) const {
  float nx = normal.x, ny = normal.y;
  float length = std::sqrt(nx * nx + ny * ny);
  if (!(length <= 3.0e38f)) nx = 0.0f, ny = 0.0f, length = 0.0f;  // NaN and infinity look at the centre
  if (normal.z < 0.0f && !(length > 0.0f)) nx = 0.0f, ny = 1.0f, length = 1.0f;
  if (length > usable_radius_ || normal.z < 0.0f) {
    nx = nx / length * usable_radius_;
    ny = ny / length * usable_radius_;
  }
  // A position on the border of two pixels is equally near to both: the lower index wins, hence ceil - 1.
  const float half = 0.5f * static_cast<float>(size_);
  const int x = std::clamp(static_cast<int>(std::ceil(nx * half + half)) - 1, 0, size_ - 1);
  const int y = std::clamp(static_cast<int>(std::ceil(half - ny * half)) - 1, 0, size_ - 1);
  return Usable(x, y) ? Source{x, y} : NearestUsable(nx, ny, x, y);
}

Source PreparedExemplar::NearestUsable(float nx, float ny, int x, int y) const {
  for (int reach = 1; reach <= size_; ++reach) {
    Source best;
    float best_distance = std::numeric_limits<float>::infinity();
    for (int v = y - reach; v <= y + reach; ++v) {
      for (int u = x - reach; u <= x + reach; ++u) {
        if (!Usable(u, v)) continue;
        const float dx = nx - coordinate_[u], dy = ny + coordinate_[v];
        const float distance = dx * dx + dy * dy;
        if (distance < best_distance) best = {u, v}, best_distance = distance;
      }
    }
    if (best_distance < std::numeric_limits<float>::infinity()) return best;
  }
  SCUMBLE_CHECK(!"every exemplar has a usable pixel");
  return {};
}

int ScaledSize(int size, double scale, int reference_height, int output_height) {
  const double height_ratio = reference_height > 0 ? static_cast<double>(output_height) / reference_height : 1.0;
  return static_cast<int>(std::clamp(std::floor(size * scale * height_ratio + 0.5), 1.0, 1e9));
}

}  // namespace scumble
