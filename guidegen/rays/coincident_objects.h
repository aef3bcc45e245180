// Objects that stand exactly where another one stands.
#pragma once

#include <span>
#include <vector>

#include "guidegen/surface/surface.h"

namespace scumble {

// By object: whether a later one of the list is the same shape at the same place and lets nothing of it be seen. Of
// exact copies the last is the one that is seen, as with paint; left to itself, a ray meets whichever the hierarchy
// happens to offer last, another one from pixel to pixel. The same shape is the same positions and triangles under the
// same matrix. Nothing with holes, and nothing culled where the other is not, covers anything. What emits is left
// alone: it is a light besides. Shapes that merely touch, or that agree by other sums, are not looked for. Reads a
// shape only where another of its size stands in its place.
std::vector<bool> FindHiddenCoincident(std::span<const PlacedObject> objects);

}  // namespace scumble
