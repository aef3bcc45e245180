// The soft edge of a sphere that is cut out of its picture.
#pragma once

#include "scumble/picture.h"

namespace scumble {

// How many pixels inside the circle that fills the square the paint is not yet as opaque as farther inside: whole
// pixels, 0 where it is opaque up to the circle. By rings of a pixel's width, from outside: the first three in a row in
// which no smaller share of the pixels is opaque than in the rings between 0.75 and 0.9 of the radius. Opaque is what
// has 99% of the median alpha of all paint.
//
// 0 too where the corners are not transparent, and where the edge has no such end within a tenth of the radius: then
// the paint is see-through everywhere, and no edge is softer than the rest. `picture` is square. O(pixels), and
// O(corners) where they are not transparent.
int SoftEdge(const Picture& picture);

}  // namespace scumble
