#include "transfer/vote/edge/window_paths.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace scumble::internal {

JoinedWays::JoinedWays(int radius) : radius_(radius) {
  const auto index = [&](PixelStep at) {
    for (std::size_t k = 0; k < ways.size(); ++k) {
      if (ways[k].dx == at.dx && ways[k].dy == at.dy) return static_cast<int>(k);
    }
    return -1;
  };
  for (int ring = 1; ring <= radius; ++ring) {
    for (int dy = -ring; dy <= ring; ++dy) {
      for (int dx = -ring; dx <= ring; ++dx) {
        if (std::max(std::abs(dx), std::abs(dy)) != ring) continue;
        const PixelStep before = StepBefore({dx, dy});
        tests_.push_back({index(before), TestOf(before, {dx, dy}), TestOf({0, 0}, {dx, dy})});
        ways.push_back({dx, dy});
      }
    }
  }
}

JoinedWays::Test JoinedWays::TestOf(PixelStep from, PixelStep to) const {
  if (to.dy < from.dy || (to.dy == from.dy && to.dx < from.dx)) std::swap(from, to);
  const int dx = to.dx - from.dx, dy = to.dy - from.dy;
  // The order of ForwardSteps.
  const int step = dy == 0 ? dx - 1 : radius_ + (dy - 1) * (2 * radius_ + 1) + dx + radius_;
  return {step, from.dx, from.dy};
}

void JoinedWays::Join(const std::vector<BitRows>& same, int row, int word, std::span<std::uint64_t> joined) const {
  std::uint64_t reached[48];
  const auto passed = [&](const Test& test) {
    return same[std::size_t(test.step)].Shifted(row + test.dy, word, test.dx);
  };
  for (std::size_t k = 0; k < tests_.size(); ++k) {
    const Way& way = tests_[k];
    reached[k] = passed(way.step) & (way.before < 0 ? BitRows::kAll : reached[way.before]);
    joined[k] = reached[k] & passed(way.whole);
  }
}

}  // namespace scumble::internal
