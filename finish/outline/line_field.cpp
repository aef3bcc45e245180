// CoverByDistance.
#include <algorithm>
#include <cmath>

#include "core/filter/distance_transform.h"
#include "finish/outline/strokes.h"

namespace scumble::internal {
namespace {

// The line beside a pixel.
struct BesideLine {
  float width = 0.0f;
  std::size_t owner = 0;
};

class LinesBeside {
 public:
  LinesBeside(const BorderMap& borders, const LineWidth& width)
      : borders_(borders), width_of_(width), width_(static_cast<std::size_t>(borders.width)) {}

  bool Has(std::size_t i) const {
    return borders_.right[i] || borders_.below[i] || (i % width_ > 0 && borders_.right[i - 1]) ||
           (i >= width_ && borders_.below[i - width_]);
  }

  BesideLine At(std::size_t i) const {
    BesideLine widest;
    const auto offer = [&](std::uint8_t border, std::size_t p, std::size_t q) {
      if (!border) return;
      const std::size_t owner = (border & kSecondOwns) != 0 ? q : p;
      const float width = width_of_.At(owner, static_cast<LineClass>((border & ~kSecondOwns) - 1));
      if (width > widest.width) widest = {width, owner};
    };
    offer(borders_.right[i], i, i + 1);
    offer(borders_.below[i], i, i + width_);
    if (i % width_ > 0) offer(borders_.right[i - 1], i - 1, i);
    if (i >= width_) offer(borders_.below[i - width_], i - width_, i);
    return widest;
  }

 private:
  const BorderMap& borders_;
  const LineWidth& width_of_;
  std::size_t width_;
};

}  // namespace

StrokeCover CoverByDistance(const OutlinePass& pass, const FinishFrame& frame, const NoiseField* gaps,
                            const BorderMap& borders, bool with_owner) {
  StrokeCover cover;
  const std::size_t pixels = std::size_t(borders.width) * std::size_t(borders.height);
  cover.share.assign(pixels, 0.0f);
  if (with_owner) cover.owner.assign(pixels, 0);
  const LineWidth width(pass, frame, gaps);
  const LinesBeside lines(borders, width);
  const double widest = 64.0 * 4.0 * frame.scale;
  const double most = 2.0 * std::max(widest, 1.0) + 1.0, most_squared = most * most;
  ForNearestFeature(
      borders.width, borders.height, [&](std::size_t i) { return lines.Has(i); },
      [&](std::size_t i, int x, int y, int u, int v) {
        const double dx = x - u, dy = y - v, squared = dx * dx + dy * dy;
        if (squared > most_squared) return;
        const std::size_t nearest = std::size_t(v) * std::size_t(borders.width) + std::size_t(u);
        const BesideLine line = lines.At(nearest);
        if (!(line.width > 0.0f)) return;
        const float away = static_cast<float>(std::sqrt(squared)) + 0.5f;
        const float edge = std::max(line.width, 1.0f) * 0.5f + 0.5f - away;
        cover.share[i] = std::clamp(edge, 0.0f, 1.0f) * std::min(line.width, 1.0f);
        if (with_owner) cover.owner[i] = static_cast<std::uint32_t>(line.owner);
      });
  return cover;
}

}  // namespace scumble::internal
