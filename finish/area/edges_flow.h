// The difference of Gaussians across edges, evened out along them.
#pragma once

#include <span>

#include "finish/area/float_plane.h"

namespace scumble::internal {

// The flow-based difference of Gaussians (Kyprianidis, Döllner 2008; the steps along the edge of Kang, Lee, Chui 2007).
// First narrow · G(sigma) + wide · G(1.6 sigma) + level of the tone along its gradient. Then a Gaussian of `along`
// pixels over the curve that follows the edge both ways, in steps of a pixel. Directions are those of the tone's
// structure tensor under a Gaussian of `tensor_sigma`. Lengths are in pixels and above 0. Where no value within reach
// is below `enough` the second step is left out: the result is not below it either. With `keys` every mean is over
// places of the pixel's key alone; empty: over all. The same bytes on any instruction set. O(pixels · (sigma + along)).
struct FlowLengths {
  double sigma, along, tensor_sigma;
};
struct FlowFactors {
  float narrow, wide, level, enough;
};
FloatPlane FlowResponse(const FloatPlane& tone, std::span<const float> keys, int width, int height,
                        const FlowLengths& lengths, const FlowFactors& factors);

}  // namespace scumble::internal
