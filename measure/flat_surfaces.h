// The flat surfaces in a picture: there a style's `variety` may take chunks from other sources.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image/guides.h"

namespace scumble {

// 1 for each covered pixel of a flat surface, 0 for others; rows from the top. A place is flat if the pixels `reach` to
// its left and right, above and below are covered and show one object and normals equal to within half a degree; those
// outside the picture are ignored. A pixel belongs to a flat surface if it is flat, or if one of the eight places a
// reach away is flat and shows the same object and normal: chunks begin there and reach that far. `guides` has normals
// and objects; `reach` is at least 1.
std::vector<std::uint8_t> FlatSurfaces(const GuideSet& guides, int reach);

}  // namespace scumble
