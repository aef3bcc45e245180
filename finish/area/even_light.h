// Light without the noise of its samples.
#pragma once

#include <span>

#include "core/image/guides.h"
#include "finish/area/float_plane.h"

namespace scumble::internal {

// Two lights whose difference is below this share of the brightest may be the same one, sampled by chance: about three
// standard errors of kUnseenLightError.
inline constexpr float kLightNoise = 0.05f;
// Noisier light is evened out as if it had this noise: beyond it are forms.
inline constexpr float kMostLightNoise = 0.25f;

// The noise of the guides' light: kLightNoise, or three standard errors where they are known and larger.
float LightNoiseOf(const GuideSet& guides);

// What light lies on, by pixel: objects, and the x and y of normals that face the eye; without normals: empty.
struct LitSurface {
  std::span<const float> object, normal_x = {}, normal_y = {};
};

// Where light is cut into steps, its noise becomes specks and torn borders. Each pixel takes the mean of itself and of
// pairs of pixels that lie opposite each other beside it. Pairs count if they are of its object and turned alike, to
// about 14 degrees, and if their mean is nearer to its light than `range`. So slopes keep their values up to the
// object's border, and creases and steps of more than twice `range` stay sharp (after the symmetric neighbours of
// Harwood, Subbarao, Hakalahti, Davis, "A new class of edge-preserving smoothing filters", 1987). Five times, with
// pairs at 1, 2, 4, 8 and 16 pixels. The last two have an eighth and a sixteenth of the range, as little noise is left
// and light bends. Noise falls to less than a hundredth. A binomial's weights, 4 for the pixel, 2 and 1 beside it,
// leave no pattern of single pixels. Before that, what stands out by a quarter of `range` from three or more around it,
// all that are of its surface, takes the nearest of their values. What is no number stays. `apart`: pixels from one
// sample to the next, where planes were made larger. O(pixels).
FloatPlane EvenedLight(std::span<const float> light, const LitSurface& surface, int width, int height, float range,
                       int apart = 1);

// The guides' objects and normals.
LitSurface LitSurfaceOf(const GuideSet& guides);

}  // namespace scumble::internal
