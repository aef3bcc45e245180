// Light without the noise of its samples.
#pragma once

#include <span>

#include "finish/area/float_plane.h"

namespace scumble::internal {

// Two lights whose difference is below this share of the brightest may be the same one, sampled by chance: about three
// standard errors of kUnseenLightError.
inline constexpr float kLightNoise = 0.05f;

// Where light is cut into steps, its noise becomes specks. Each pixel takes the mean of itself and of those pairs of
// pixels that lie opposite each other beside it, are of its object, and whose mean is nearer to its light than `range`:
// so slopes keep their values up to the object's border, and steps of more than twice `range` stay sharp (after the
// symmetric neighbours of Harwood, Subbarao, Hakalahti, Davis, "A new class of edge-preserving smoothing filters",
// 1987). Three times, with pairs at 1, 2 and 4 pixels: noise of single pixels falls to a twelfth. Before that, what
// stands out by a quarter of `range` from three or more around it, all that are of its object, takes the nearest of
// their values. What is no number stays. `apart`: pixels from one sample to the next, where planes were made larger.
// O(pixels).
FloatPlane EvenedLight(std::span<const float> light, std::span<const float> object, int width, int height, float range,
                       int apart = 1);

}  // namespace scumble::internal
