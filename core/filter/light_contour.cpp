#include "core/filter/light_contour.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/filter/wide_loops.h"

namespace scumble::internal {
namespace {

SCUMBLE_WIDE_LOOPS bool Differ(const float* a, const float* b, float least, std::size_t count) {
  int any = 0;
  for (std::size_t i = 0; i < count; ++i) any |= std::fabs(a[i] - b[i]) > least ? 1 : 0;
  return any != 0;
}

SCUMBLE_WIDE_LOOPS bool AreSeparate(const float* a, const float* b, float border, std::size_t count) {
  int any = 0;
  for (std::size_t i = 0; i < count; ++i) any |= (a[i] >= border) != (b[i] >= border) ? 1 : 0;
  return any != 0;
}

// Adds a side where pixels differ from others of their object; whether any does.
SCUMBLE_WIDE_LOOPS bool MarkSteps(const float* tone, const float* other_tone, const float* object,
                                  const float* other_object, float least, std::uint32_t side, std::size_t count,
                                  std::uint32_t* marks) {
  std::uint32_t any = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const bool differs = (std::fabs(tone[i] - other_tone[i]) > least) & (object[i] == other_object[i]);
    const std::uint32_t mark = differs ? side : 0u;
    marks[i] |= mark, any |= mark;
  }
  return any != 0;
}

// Adds a side where pixels and others of their object lie on two sides of a border; whether any do.
SCUMBLE_WIDE_LOOPS bool MarkSeparate(const float* tone, const float* other_tone, const float* object,
                                     const float* other_object, float border, std::uint32_t side, std::size_t count,
                                     std::uint32_t* marks) {
  std::uint32_t any = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const bool differs = ((tone[i] >= border) != (other_tone[i] >= border)) & (object[i] == other_object[i]);
    const std::uint32_t mark = differs ? side : 0u;
    marks[i] |= mark, any |= mark;
  }
  return any != 0;
}

// An end of a step.
struct End {
  float from = 0.0f;   // from the pixel's centre
  bool turns = false;  // the contour turns into the pixel's side there
  bool is_corner = false;
};

// The line begins there half a pixel above the contour and meets it after `length` pixels: its area in the pixel.
float AreaUnder(const End& at, float length) {
  const float begin = at.from - 0.5f, end = std::min(at.from + 0.5f, length);
  if (!at.turns || end <= begin) return 0.0f;
  return 0.5f * (end - begin - (end * end - begin * begin) / (2.0f * length));
}

}  // namespace

LightContour::LightContour(const HardLight& light, const GuideSet& guides)
    : light_(light),
      coverage_(guides.Plane(Layer::kCoverage)),
      object_(guides.Has(Layer::kObject) ? guides.Plane(Layer::kObject) : std::span<const float>()),
      width_(guides.width()),
      height_(guides.height()) {}

// Whether pixels x0 … x1 - 1 of a row may have a contour beside them.
bool LightContour::MayHave(int x0, int x1, int y) const {
  const float* const row = light_.tone.data() + std::ptrdiff_t(y) * width_;
  const float* const here = row + x0;
  const auto count = static_cast<std::size_t>(x1 - x0);
  const int left = std::max(0, x0 - 1), right = std::min(width_ - 1, x1);
  const auto is_any = [&](const auto& differ) {
    return differ(row + left, row + left + 1, static_cast<std::size_t>(right - left)) ||
           (y > 0 && differ(here, here - width_, count)) || (y + 1 < height_ && differ(here, here + width_, count));
  };
  if (light_.borders.empty()) {
    return is_any([&](const float* a, const float* b, std::size_t some) { return Differ(a, b, light_.least, some); });
  }
  return std::ranges::any_of(light_.borders, [&](float border) {
    return is_any([&](const float* a, const float* b, std::size_t some) { return AreSeparate(a, b, border, some); });
  });
}

// Marks those that have one, objects considered.
bool LightContour::Mark(int x0, int x1, int y, std::uint32_t* marks) const {
  std::fill_n(marks, x1 - x0, 0u);
  const auto mark = [&](int from, int to, std::ptrdiff_t other, std::uint32_t side) {
    const std::ptrdiff_t at = std::ptrdiff_t(y) * width_ + from;
    const float* const tone = light_.tone.data() + at;
    const float* const object = object_.empty() ? tone : object_.data() + at;
    const float* const other_object = object_.empty() ? tone : object + other;
    const auto count = static_cast<std::size_t>(std::max(0, to - from));
    std::uint32_t* const some = marks + from - x0;
    if (light_.borders.empty())
      return MarkSteps(tone, tone + other, object, other_object, light_.least, side, count, some);
    bool any = false;
    for (const float border : light_.borders)
      any = MarkSeparate(tone, tone + other, object, other_object, border, side, count, some) || any;
    return any;
  };
  const bool sideways[2] = {mark(std::max(x0, 1), x1, -1, kLeft), mark(x0, std::min(x1, width_ - 1), 1, kRight)};
  const bool above = y > 0 && mark(x0, x1, -width_, kAbove), below = y + 1 < height_ && mark(x0, x1, width_, kBelow);
  return sideways[0] || sideways[1] || above || below;
}

// Beyond the side that lies one pixel that way, along x or along y.
float LightContour::ShareBeyond(int x, int y, int side_x, int side_y) const {
  const float* const tone = light_.tone.data();
  const std::ptrdiff_t pixel = std::ptrdiff_t(y) * width_ + x, side = std::ptrdiff_t(side_y) * width_ + side_x;
  if (!(std::fabs(tone[pixel] - tone[pixel + side]) > light_.least)) return 0.0f;
  const auto own_object = std::bit_cast<std::uint32_t>(object_.empty() ? 0.0f : object_[std::size_t(pixel)]);
  const auto is_one = [&](std::ptrdiff_t i) {
    const auto place = static_cast<std::size_t>(i);
    return object_.empty() ? coverage_[place] > 0.0f : std::bit_cast<std::uint32_t>(object_[place]) == own_object;
  };
  if (!is_one(pixel) || !is_one(pixel + side)) return 0.0f;
  const float own = tone[pixel] * light_.per_tone, other = tone[pixel + side] * light_.per_tone;
  float border = 0.5f * (own + other);
  if (light_.bands > 1) {
    const auto band = [&](float at) { return std::floor(std::clamp(at, 0.0f, float(light_.bands - 1))); };
    if (band(own) == band(other)) return 0.0f;
    border = std::max(band(own), band(other));
  } else if (!light_.borders.empty()) {
    const auto above = std::ranges::upper_bound(light_.borders, std::max(own, other));
    if (above == light_.borders.begin() || !(std::min(own, other) < above[-1])) return 0.0f;
    border = above[-1];
  }
  const bool is_bright = own >= border;
  const float border_tone = border / light_.per_tone;
  const auto is_own_side = [&](std::ptrdiff_t i) { return (tone[i] >= border_tone) == is_bright; };
  const bool along_x = side_x == 0;
  const std::ptrdiff_t along = along_x ? 1 : width_;
  const bool has_row_behind =
      along_x ? y - side_y >= 0 && y - side_y < height_ : x - side_x >= 0 && x - side_x < width_;
  const auto end_at = [&](std::ptrdiff_t step, int room) {
    const int reach = std::min(kReach, room);
    std::ptrdiff_t i = pixel;
    for (int k = 1; k <= reach; ++k) {
      i += step;
      if (!is_one(i) || !is_one(i + side)) return End{static_cast<float>(k) - 0.5f};
      const bool here = is_own_side(i), there = is_own_side(i + side);
      if (here && !there) continue;
      End end{static_cast<float>(k) - 0.5f, !here && !there};
      // Whether the contour goes on that way for more than a pixel.
      end.is_corner = end.turns && has_row_behind && is_one(i - side) && is_one(i - step - side) &&
                      !is_own_side(i - side) && is_own_side(i - step - side);
      return end;
    }
    return End{static_cast<float>(reach) + 0.5f};
  };
  const End before = end_at(-along, along_x ? x : y);
  const End after = end_at(along, along_x ? width_ - 1 - x : height_ - 1 - y);
  const float length = before.from + after.from, half = 0.5f * length;
  const auto area = [&](const End& end) {
    return AreaUnder(end, end.is_corner && length > 1.0f ? std::min(half, 0.5f) : half);
  };
  return area(before) + area(after);
}

std::array<LightContour::Beyond, 2> LightContour::BeyondOf(int x, int y, std::uint32_t sides) const {
  const std::ptrdiff_t pixel = std::ptrdiff_t(y) * width_ + x;
  const auto beyond = [&](std::uint32_t side, bool has_side, int side_x, int side_y) {
    if (!(sides & side) || !has_side) return Beyond();
    return Beyond{ShareBeyond(x, y, side_x, side_y),
                  static_cast<std::size_t>(pixel + std::ptrdiff_t(side_y) * width_ + side_x)};
  };
  const Beyond left = beyond(kLeft, x > 0, -1, 0), right = beyond(kRight, x + 1 < width_, 1, 0);
  const Beyond above = beyond(kAbove, y > 0, 0, -1), below = beyond(kBelow, y + 1 < height_, 0, 1);
  const bool is_sideways = left.share + right.share >= above.share + below.share;
  std::array<Beyond, 2> both = {is_sideways ? left : above, is_sideways ? right : below};
  if (both[0].share < both[1].share) std::swap(both[0], both[1]);
  if (both[1].share > 0.0f) both[0].share = std::min(1.0f, both[0].share / (1.0f - both[1].share));
  return both;
}

}  // namespace scumble::internal
