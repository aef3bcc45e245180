// The layer `outline`: how far it is to the nearest outline.
#pragma once

#include "core/filter/region.h"
#include "core/image/guides.h"

namespace scumble::internal {

// Pixels beyond which the layer does not count on.
inline constexpr float kMostOutlineDistance = 256.0f;

// Adds the layer, or fills it: pixels from a pixel's centre to the nearest border at which its own object ends. It ends
// against nothing, against another object farther away, or at a step in depth. A border is half a pixel from the pixel
// beside it. At most kMostOutlineDistance, which is also the value where there is none; 0 on background. The edge of
// `window` is no border. The guides hold coverage, object and depth. Distances spread from pixel to pixel of one
// object, in four sweeps (Danielsson, "Euclidean Distance Mapping", 1980), which is exact to a fraction of a pixel.
// O(pixels).
void FillOutlineDistance(const Region& window, GuideSet& guides);

}  // namespace scumble::internal
