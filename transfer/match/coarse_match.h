// Matches the source field at some pixels and upsamples it to those between: positions are upsampled, paint is not
// blurred.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "transfer/match/match.h"

namespace scumble::internal {

// One active pixel for each block of step × step pixels: the one nearest the block's centre, ties to the lowest (y, x).
// Blocks are counted from the picture's top left corner and cut off at its right and lower edge. Blocks that lie in the
// region as a whole or in part have one; a block without active pixels has none.
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

// The largest distance between a pixel and the pixels of its blocks; a match with this margin around a region has them
// all.
constexpr int CoarseReach(int step) { return 2 * step; }

// The finest useful grid of seeds: one whose cells are larger than a block. On finer grids nearly every block is its
// own seed, which equals taking its own nearest neighbour.
constexpr int CoarseLeastLevel(int step) { return std::bit_width(static_cast<unsigned>(step)); }

// Fills the active pixels of input.region. `field` holds the matches of the pixels of `grid`. A pixel p tries the four
// blocks whose centres are nearest, at the picture's edge fewer. A block with pixel q has the candidate S(q) + (p - q);
// p may take it if it is usable and its guide is like p's, light included. It takes the one of the coarsest level, as
// the match itself does, and of these the one with the nearest guide. Of equal ones it takes the first: its own
// block's, then the others' in row order. If none is like it, p takes its own nearest neighbour. False: cancelled.
bool UpsampleField(const MatchInput& input, const CoarseGrid& grid, SourceField& field, RowProgress& progress);

}  // namespace scumble::internal
