// The edge test between neighbouring pixels, 64 at a time: which steps of support_regions.h are open.
#pragma once

#include "core/filter/edge_test.h"
#include "transfer/vote/bit_mask_rows.h"

namespace scumble::internal {

struct OpenSteps {
  BitMaskRows right;  // the step to the pixel on the right is open
  BitMaskRows down;   // the step to the pixel below is open
};

// Fills the steps of the tile's pixels in `wanted`, exactly as support_regions.h defines them; the steps of other
// pixels are undefined. Both masks have the tile's rows and words. `active` must also hold the pixels to the right of
// the wanted ones and below; active pixels are covered. O(pixels of the tile). Safe from several threads.
void MarkOpenSteps(const EdgeRules& rules, const MaskedTile& tile, const BitMaskRows& active, const BitMaskRows& wanted,
                   OpenSteps& steps);

}  // namespace scumble::internal
