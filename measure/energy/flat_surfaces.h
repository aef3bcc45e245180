// Where a picture shows flat surfaces: there a style's `variety` lets pieces of paint come from elsewhere.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image/guides.h"

namespace scumble {

// 1 for each covered pixel of a flat surface, 0 for others; rows from the top. A place is flat all round where the
// pixels `reach` to its left and right, above and below are covered and show the same object and normals that are equal
// to within half a degree; those outside the picture do not count against it. A pixel is of a flat surface where it is
// flat all round, or where one of the eight places a reach away is, which shows the same object and normal: pieces
// begin there and reach so far. `guides` has normals and objects; `reach` is at least 1.
std::vector<std::uint8_t> FlatSurfaces(const GuideSet& guides, int reach);

}  // namespace scumble
