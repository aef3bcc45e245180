#include "transfer/vote/edge/support_regions.h"

#include <algorithm>

#include "core/filter/parallel.h"

namespace scumble::internal {
namespace {

// The last pixel on one arm with each pixel of a line of `count`. open(i): whether the step from i to i + 1 is open;
// alike(i, j): whether the normals of i and j are less than the crease apart.
template <class Open, class Alike>
void EndsOfArms(int count, int radius, const Open& open, const Alike& alike, std::vector<int>& ends) {
  ends.resize(static_cast<std::size_t>(count));
  int end = 0;
  for (int i = 0; i < count; ++i) {
    end = std::max(end, i);
    const auto joins = [&](int next) {
      if (next >= count || next - i > radius || !open(next - 1)) return false;
      for (int j = i; j < next; ++j) {
        if (!alike(j, next)) return false;
      }
      return true;
    };
    while (joins(end + 1)) ++end;
    ends[static_cast<std::size_t>(i)] = end;
  }
}

}  // namespace

SupportRegions::SupportRegions(const EdgeRules& rules, std::span<const std::uint8_t> active, int radius,
                               const Region& region)
    : width_(rules.guides.width()), grown_(region.GrownBy(radius, rules.guides.width(), rules.guides.height())) {
  if (region.empty()) return;
  const int columns = grown_.x1 - grown_.x0, rows = grown_.y1 - grown_.y0;
  arms_.resize(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  const EdgeTest test(rules);
  // The arms of a line of pixels, `stride` apart in the guides; set(i, back, front) stores the result of pixel i.
  const auto measure = [&](int count, std::size_t first, std::size_t stride, int dx, int dy, const auto& set) {
    std::vector<int> ends;
    const auto pixel = [&](int i) { return first + static_cast<std::size_t>(i) * stride; };
    const auto open = [&](int i) {
      const std::size_t p = pixel(i), q = pixel(i + 1);
      return active[p] && active[q] && test.SameSurface(test.At(p), test.At(q), dx, dy);
    };
    const auto alike = [&](int i, int j) { return test.NormalsAlike(test.At(pixel(i)), test.At(pixel(j))); };
    EndsOfArms(count, radius, open, alike, ends);
    for (int i = 0, begin = 0; i < count; ++i) {
      while (ends[static_cast<std::size_t>(begin)] < i) ++begin;  // the first pixel whose arm holds i
      set(i, static_cast<std::uint16_t>(i - begin), static_cast<std::uint16_t>(ends[static_cast<std::size_t>(i)] - i));
    }
  };
  tbb::parallel_for(grown_.y0, grown_.y1, [&](int y) {
    measure(columns, rules.guides.Index(grown_.x0, y), 1, 1, 0, [&](int i, std::uint16_t left, std::uint16_t right) {
      Arms& arms = arms_[Index(grown_.x0 + i, y)];
      arms.left = left, arms.right = right;
    });
  });
  tbb::parallel_for(grown_.x0, grown_.x1, [&](int x) {
    const auto stride = static_cast<std::size_t>(width_);
    measure(rows, rules.guides.Index(x, grown_.y0), stride, 0, 1, [&](int i, std::uint16_t up, std::uint16_t down) {
      Arms& arms = arms_[Index(x, grown_.y0 + i)];
      arms.up = up, arms.down = down;
    });
  });
}

}  // namespace scumble::internal
