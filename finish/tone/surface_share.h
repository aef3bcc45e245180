// How much of a pixel is the surface that its guides describe.
#pragma once

#include <cstddef>
#include <cstdint>

namespace scumble::internal {

// What a block of shares has: only 0, only 1, some in between.
struct ShareKinds {
  bool all_zero = true, all_one = true, is_mixed = false;
};

// Of `count` pixels from `texels` on, the share of their colour that is the surface's, 0 … 1. It is 1 where a picture
// is as transparent as the guides say (to half a step of 8 bits). It is the coverage where the picture is opaque,
// because a renderer has mixed what lies behind into it. Painted rims, whose alpha is the brush's, are in between, so
// that an effect fades out over them. 0 where nothing is covered. `of_guides`: the picture is of the guides themselves,
// opaque wherever anything is covered, and with nothing mixed in.
ShareKinds SurfaceShares(const float* coverage, const std::uint16_t* texels, bool of_guides, std::size_t count,
                         float* shares);

}  // namespace scumble::internal
