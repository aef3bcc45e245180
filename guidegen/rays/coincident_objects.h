// Coincident instances: objects at exactly the same place.
#pragma once

#include <span>
#include <vector>

#include "guidegen/surface/surface.h"

namespace scumble {

// By object: whether a later object of the list has an equal shape at an equal place, and hides it. Of coincident
// objects the last one is seen, as with paint. Without this rule a ray hits the one that the hierarchy visits last,
// which differs from pixel to pixel. Equal shapes have equal positions and triangles under an equal matrix. An object
// with holes hides nothing, nor does one that is culled where the other is not. An emissive object is never hidden,
// because it is a light as well. Shapes that touch, or whose sums of matrix and positions agree, do not count. A mesh
// is only compared with another of its size at its place.
std::vector<bool> FindHiddenCoincident(std::span<const PlacedObject> objects);

// By object: whether another one that is not hidden either may be at its place. Embree then chooses, and its choice
// depends on which of the two have filters. Compares hashes alone, so a few others may be among them.
std::vector<bool> FindTied(std::span<const PlacedObject> objects, const std::vector<bool>& hidden);

}  // namespace scumble
