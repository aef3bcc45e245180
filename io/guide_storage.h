// How guides may be stored: what the halves of guide_file.h share.
#pragma once

#include <Imath/half.h>

#include <string>

#include "image/guides.h"

namespace scumble::internal {

// Whether it is the name of one of OpenEXR's lossless compressions.
bool IsLossless(const std::string& compression);

// The nearest half float. Brighter values than half floats reach become the brightest one: infinity is no radiance.
Imath::half ToHalf(float value);

// Normals squeezed into [0, 1] for an 8-bit picture have no negative component anywhere and are rarely of length 1. A few
// pixels prove nothing.
bool LookPacked(const GuideSet& guides);

// Half floats and filtered passes shorten normals; a direction is what the transfer needs. Lengths that no rounding
// or filter explains are left for Validate to refuse.
void NormalizeNormals(GuideSet& guides);

}  // namespace scumble::internal
