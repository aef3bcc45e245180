#include "core/painting/paint_mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/image/exact_math.h"

namespace scumble {
namespace {

std::array<std::uint16_t, 4> MeanTexel(const Picture& picture, int x, int y) {
  std::array<std::uint32_t, 4> sums{};
  std::uint32_t count = 0;
  for (int j = std::max(0, y - 1); j <= std::min(picture.height - 1, y + 1); ++j) {
    for (int i = std::max(0, x - 1); i <= std::min(picture.width - 1, x + 1); ++i) {
      for (std::size_t c = 0; c < 4; ++c) sums[c] += picture.At(i, j)[c];
      ++count;
    }
  }
  std::array<std::uint16_t, 4> mean{};
  for (std::size_t c = 0; c < 4; ++c) mean[c] = static_cast<std::uint16_t>(sums[c] / count);
  return mean;
}

}  // namespace

bool IsPaint(const Picture& picture, const BarePaper& ground, int x, int y) {
  std::array<std::uint16_t, 4> texel = MeanTexel(picture, x, y);
  if (ground.kind != BarePaper::Kind::kPaper) return texel[3] > 32767;
  LiftPaint(ground, texel.data());
  return texel[3] > 0;
}

PaintMask::PaintMask(const Picture& picture) : PaintMask(picture, FindBarePaper(picture)) {}

PaintMask::PaintMask(const Picture& picture, const BarePaper& ground)
    : width_(picture.width),
      height_(picture.height),
      ground_(ground),
      values_(std::size_t(picture.width) * picture.height, 1) {
  if (!known()) return;
  // Paint that continues into the corners may have nearly one colour there; on paper there is almost none of it.
  constexpr double kCornersFrom = 1.15, kMostPaint = 0.15;
  std::size_t corners = 0, painted = 0;
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const bool is_paint = IsPaint(picture, ground_, x, y);
      values_[std::size_t(y) * width_ + x] = is_paint;
      const double dx = (2.0 * x + 1) / width_ - 1.0, dy = (2.0 * y + 1) / height_ - 1.0;
      if (dx * dx + dy * dy < kCornersFrom * kCornersFrom) continue;
      ++corners, painted += is_paint;
    }
  }
  if (static_cast<double>(painted) <= kMostPaint * static_cast<double>(corners)) return;
  ground_ = {};
  std::fill(values_.begin(), values_.end(), std::uint8_t{1});
}

glm::dvec2 OutlineDirection(int i) {
  const double turns = 2.0 * i / kOutlineDirections;
  return {CosPi(turns), SinPi(turns)};
}

std::vector<glm::dvec2> PaintOutline(const std::vector<std::uint8_t>& mask, int width, int height, glm::dvec2 towards) {
  std::vector<glm::dvec2> points;
  const auto room = [](double at, double direction, int size) {
    if (direction == 0.0) return std::numeric_limits<double>::infinity();
    return (direction > 0.0 ? size - at : at) / std::fabs(direction);
  };
  for (int i = 0; i < kOutlineDirections; ++i) {
    const glm::dvec2 direction = OutlineDirection(i);
    const double longest = std::min(room(towards.x, direction.x, width), room(towards.y, direction.y, height)) - 0.5;
    int run = 0, ground = 0;  // in half pixels
    for (double distance = longest; distance > 0.0; distance -= 0.5) {
      const glm::dvec2 at = towards + distance * direction;
      const int x = std::clamp(static_cast<int>(at.x), 0, width - 1),
                y = std::clamp(static_cast<int>(at.y), 0, height - 1);
      if (!mask[std::size_t(y) * width + x]) {
        run = 0, ++ground;
        continue;
      }
      if (++run < 6) continue;
      // The mask's mean over 3×3 texels moves the outline half a pixel to a pixel outward.
      if (ground >= 6) points.push_back(towards + (distance + 2.5 - 0.5) * direction);
      break;
    }
  }
  return points;
}

}  // namespace scumble
