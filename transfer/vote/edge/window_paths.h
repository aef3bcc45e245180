// Which pixels of a small window are joined to its centre, 64 windows at a time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "transfer/field/bit_mask_rows.h"
#include "core/filter/edge_test.h"

namespace scumble::internal {

// Bit i of joined[k]: whether the pixel 64·word + i of that row is joined to the one `ways[k]` from it, as JoinedWindow
// has it.
struct JoinedWays {
  explicit JoinedWays(int radius);
  int count() const { return static_cast<int>(ways.size()); }
  void Join(const std::vector<BitRows>& same, int row, int word, std::span<std::uint64_t> joined) const;

  std::vector<PixelStep> ways;  // all pixels of the window but its centre

 private:
  struct Test {
    int step;    // of ForwardSteps
    int dx, dy;  // where the mark stands, from the centre
  };
  Test TestOf(PixelStep from, PixelStep to) const;
  struct Way {
    int before = -1;  // the way that this one follows; -1: the centre
    Test step, whole;
  };
  int radius_;
  std::vector<Way> tests_;
};

}  // namespace scumble::internal
