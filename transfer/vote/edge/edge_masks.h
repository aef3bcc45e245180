// The edge test for 64 pixels at a time, where votes are held.
#pragma once

#include <vector>

#include "transfer/field/bit_mask_rows.h"
#include "transfer/vote/chunk_masks.h"
#include "core/filter/edge_test.h"

namespace scumble::internal {

// Half of a window: every step of at most `radius` in x and y that leads to a later pixel in row order.
std::vector<PixelStep> ForwardSteps(int radius);

struct EdgeMarks {
  // For each of ForwardSteps(radius), the pixels that are the same surface as the one a step further on: both covered,
  // and EdgeTest::SameSurface to the bit. The marks hold where the pixel or that other one is a centre, and for steps
  // of one pixel wherever a way from a centre may lead; others say nothing.
  std::vector<BitRows> same;
  BitRows sure;  // pixels for which none of these marks that hold is missing
};

// Makes the marks for windows of radius 1 … 3 around `centres`, in those words of the tile that have any and one on
// either side. Centres stand at least `radius` from the tile's first and last rows, and in all but its first and last
// words. The guides must hold depth and object.
void MarkEdges(const EdgeRules& rules, int radius, const MarkedTile& tile, const BitRows& centres, EdgeMarks& marks);

}  // namespace scumble::internal
