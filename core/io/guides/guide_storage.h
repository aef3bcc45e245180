// Storage rules of guides, shared by the parts of guide_file.h.
#pragma once

#include <string>

#include "core/image/guides.h"

namespace scumble::internal {

// Whether `compression` names one of OpenEXR's lossless compressions.
bool IsLossless(const std::string& compression);

// Whether normals look squeezed into [0, 1] for an 8-bit picture: no component is negative anywhere, and lengths are
// rarely 1. A few pixels prove nothing.
bool LookPacked(const GuideSet& guides);

// Brings coverage into 0 to 1 where it is outside by an eighth or less, as by the rounding of a sum or the negative
// lobes of a pixel filter. Validate refuses what is farther outside.
void ClampCoverage(GuideSet& guides);

// Makes normals unit vectors where eight bits, half floats or filtered passes changed their length. Near a silhouette a
// length that is off finds no normal on the sphere: x and y alone would find paint of a normal √(2 · deficit) radians
// away. Lengths within float precision stay, so that a file gives the bytes it was written from. Lengths that no
// rounding or filter explains stay too, and Validate refuses them: a partly covered pixel's may be all but 0, as
// filters mix them with the background's.
void NormalizeNormals(GuideSet& guides);

// Gives the pixels that nothing covers the values of background in the layers of surfaces, whatever a renderer left
// there: zeros, -1, NaN. Light and colours stay, which may be a sky's. Nothing without coverage.
void ClearBackground(GuideSet& guides);

// Depths of covered pixels that are infinite, because half floats cannot hold them, become 10^30 m: all equally far.
void LimitDepths(GuideSet& guides);

}  // namespace scumble::internal
