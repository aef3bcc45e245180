// How guides may be stored: what the halves of guide_file.h share.
#pragma once

#include <string>

#include "core/image/guides.h"

namespace scumble::internal {

// Whether it is the name of one of OpenEXR's lossless compressions.
bool IsLossless(const std::string& compression);

// Normals squeezed into [0, 1] for an 8-bit picture have no negative component anywhere and are rarely of length 1. A
// few pixels prove nothing.
bool LookPacked(const GuideSet& guides);

// Eight bits, half floats and filtered passes make normals longer or shorter; a direction is what the transfer needs,
// and near a silhouette the sphere has none for a length that is off: there, x and y alone would find paint that was
// made for a normal √(2 · what is missing) radians away. Lengths as good as floats can hold stay, so that a file gives
// the bytes it was written from; lengths that no rounding or filter explains are left for Validate to refuse.
void NormalizeNormals(GuideSet& guides);

// Depths of covered pixels beyond what half floats hold, which are infinite then, become 10^30 m: as far away as each
// other.
void LimitDepths(GuideSet& guides);

}  // namespace scumble::internal
