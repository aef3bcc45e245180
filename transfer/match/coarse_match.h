// The source field matched at some pixels and taken on by those between: positions are upsampled, paint is not blurred.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "transfer/match/match.h"

namespace scumble::internal {

// One active pixel for each block of step × step pixels, blocks counted from the picture's top left corner and cut off
// at its right and lower edge: the active pixel nearest the block's centre, ties to the lowest (y, x). Blocks that lie
// in the region as a whole or in part have one; a block without active pixels has none.
class CoarseGrid {
 public:
  CoarseGrid(std::span<const std::uint8_t> active, int width, int height, int step, const Region& region);

  int step() const { return step_; }
  // The block's pixel; null where the block has none or is not in the region.
  const PixelPosition* Find(int column, int row) const;
  // Writes `value` for every block's pixel.
  void Mark(std::uint8_t value, int width, std::vector<std::uint8_t>& pixels) const;

 private:
  static constexpr int kNone = -1;
  int step_, first_column_ = 0, first_row_ = 0, columns_ = 0, rows_ = 0;
  std::vector<PixelPosition> pixels_;  // x kNone: none
};

// How far from a pixel the pixels of its blocks may be; a match that covers so many pixels around a region has them.
constexpr int CoarseReach(int step) { return 2 * step; }

// The finest grid of seeds worth a look: one whose cells are larger than a block. On finer ones every block is its own
// seed, or nearly so, which is what taking its own nearest neighbour means.
constexpr int CoarseLeastLevel(int step) { return std::bit_width(static_cast<unsigned>(step)); }

// Fills the active pixels of input.region. `field` holds what the pixels of `grid` were matched to. A pixel p looks at
// the four blocks whose centres are nearest, at the picture's edge fewer: each with its pixel q offers S(q) + (p - q),
// and where that is usable and its guide is like p's, light included, p may take it. It takes the one of the coarsest
// level, as the match itself does; of these the one whose guide is nearest to its own; of equal ones the first, its own
// block's before the others' in row order. Where none is like it, p takes its own nearest neighbour.
// False: asked to stop.
bool UpsampleField(const MatchInput& input, const CoarseGrid& grid, SourceField& field, RowProgress& progress);

}  // namespace scumble::internal
