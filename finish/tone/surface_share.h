// How much of a pixel is the surface that its guides describe.
#pragma once

#include <cstddef>
#include <cstdint>

namespace scumble::internal {

// Of `count` pixels from `texels` on, the share of their colour that is the surface's, 0 … 1: all of it where a picture
// is as transparent as the guides say (to half a step of 8 bits), the coverage where it is opaque, because a renderer
// has mixed what lies behind into it. 0 where nothing is covered or alpha is 0.
void SurfaceShares(const float* coverage, const std::uint16_t* texels, std::size_t count, float* shares);

}  // namespace scumble::internal
