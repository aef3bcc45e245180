// Where the edge test of small windows passes for certain, without testing pairs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "transfer/field/bit_mask_rows.h"
#include "transfer/vote/chunk_masks.h"
#include "transfer/vote/edge/edge_row.h"
#include "core/filter/edge_test.h"

namespace scumble::internal {

// A row of the picture and its neighbours.
struct CalmRow {
  const float* above;   // depth, as in EdgeRow
  EdgeRow here, below;  // without slopes
  std::ptrdiff_t width;
};

// A pixel is calm where it and its four neighbours are covered, its object is that of the pixels to the right and
// below, and its depth bends little: back and front, the differences to both neighbours of a row or column, differ by
// less than b·depth, and front by less than depth / 32. If all pixels of the rectangle between p and q = p + (dx, dy)
// are calm, |dx| and |dy| at most r, EdgeTest passes their objects and depths:
//
// Neighbours in the rectangle have one object.
//
// A slope is back, front or 0, and 0 only where their signs differ (or their product underflows, below). So it differs
// from both by K at most, the greatest bend. Depth from p to q is the mean of the two ways round the rectangle. Along
// p's row the i-th difference is within (i + 1)·K of p's slope, along q's row (from q) of q's; columns alike. So
// depth(q) - depth(p) is within (dx(dx + 1) + dy(dy + 1)) / 2 · K ≤ r(r + 1)·K of what slopes explain.
//
// Depths of neighbours in the rectangle differ by less than 1/32 + b ≤ 3/64 of either, so no depth there is more than
// (64/61)^2r ≤ 1.34 times the smaller, m, of p and q: K < 1.34·b·m. With b = 0.7·tolerance / r(r + 1) - 10^-6 that
// makes r(r + 1)·K less than 0.94·tolerance·m - 2·10^-6·m, and leeway is never negative. All values are below 0.35·m
// and fewer than 30 are rounded, by 2^-24 of themselves: 10^-6·m at most.
//
// Where the test gives way by T metres whatever the depth (orthographic views), so may the bend, by 0.7·T / r(r + 1): that
// is another 0.7·T at most in r(r + 1)·K. Depths of the rectangle are still within 1/32 of each other, being fronts of calm
// pixels; slopes may now be larger by K, and their rounding, 30 · 2^-24 · 6·T, is far less than the 0.3·T that are left.
//
// Depth must be above 10^-16 / b ≥ 6·10^-15. So where a product of differences underflows, the smaller of them, below
// 10^-22, is nothing beside 10^-6·m.
//
// For creases a row is cut into blocks of 16 pixels. Where all covered normals of a block, and of r pixels more on
// either side, lie within L of its middle one, c, |c|² ≤ 1.01, any of them has a product with any of another such block
// below, of middle d, of at least c·d - L(|c| + |d|) - L².
class CalmMarks {
 public:
  static constexpr int kMaxRadius = 3;
  // For steps of at most `radius`, 1 … kMaxRadius, between pixels of the tile.
  CalmMarks(const EdgeRules& rules, int radius, const MarkedTile& tile);

  // The next row of the tile, downwards from its first; not the first or last of the picture. Bit b of wanted[w]: look
  // at block b of the w-th word; nothing is told of others.
  void Add(int y, const CalmRow& row, const std::uint8_t* wanted);
  void AddNothing(int y);

  // Makes the marks below of row y. `radius` rows below it must be added, but for those below `last`.
  void Compare(int y, int last);
  // Words of the row compared, k counting ForwardSteps(radius), for steps to rows that are not below `last`: for which
  // pixels objects and depths pass the test with the one a step further on; for which of these normals do, too.
  const std::uint64_t* Level(std::size_t k) const { return level_.data() + k * std::size_t(tile_.words); }
  const std::uint64_t* Sure(std::size_t k) const { return sure_.data() + k * std::size_t(tile_.words); }

 private:
  struct Blocks {
    std::vector<float> centre[3];  // NaN: normals differ too much
  };
  Blocks& BlocksOf(int y) { return blocks_[std::size_t(y + kMaxRadius + 1) % blocks_.size()]; }

  int radius_;
  MarkedTile tile_;
  float bend_, bend_fixed_, spread_, least_product_;
  std::array<BitRows, kMaxRadius + 1> runs_;  // of k + 1 calm pixels, from this one to the right
  std::vector<Blocks> blocks_;                // of radius + 1 rows, one after the other
  std::vector<std::uint64_t> alike_, box_, level_, sure_;
};

}  // namespace scumble::internal
