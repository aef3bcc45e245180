// The directions along which a picture changes least.
#pragma once

#include <cstddef>

#include "finish/area/float_plane.h"

namespace scumble::internal {

// The structure tensor Σ ∇c ∇cᵀ of a picture's channels, by pixel: products of derivatives.
struct StructureTensor {
  FloatPlane xx, xy, yy;
};

// By pixel: the direction of the smaller eigenvalue, of length 1, in pixels to the right and down; its sign has no
// meaning. And (l1 - l2) / (l1 + l2) of the eigenvalues, 0 where all directions are alike. Behind the last pixel are
// kFlowSpare more values, of no meaning, so that vectors may read beyond it.
inline constexpr std::size_t kFlowSpare = 16;
struct EdgeFlow {
  FloatPlane x, y, anisotropy;
};

// Of the tensor under a Gaussian of `sigma` pixels.
EdgeFlow FlowOf(const StructureTensor& tensor, int width, int height, double sigma);

}  // namespace scumble::internal
