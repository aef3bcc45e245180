// Storage rules of guides, shared by the parts of guide_file.h.
#pragma once

#include <string>

#include "core/image/guides.h"
#include "scumble/status.h"

namespace scumble::internal {

// Whether `compression` names one of OpenEXR's lossless compressions.
bool IsLossless(const std::string& compression);

// Makes normals unit vectors where eight bits, half floats or filtered passes changed their length. Near a silhouette a
// length that is off finds no normal on the sphere: x and y alone would find paint of a normal √(2 · deficit) radians
// away. Lengths within float precision stay, so that a file gives the bytes it was written from. Lengths that no
// rounding or filter explains stay too, and Validate refuses them: a partly covered pixel's may be all but 0, as
// filters mix them with the background's.
void NormalizeNormals(GuideSet& guides);

// Puts guides of any program into their ranges: coverage a little outside 0 to 1, backgrounds, lengths of normals, and
// infinite depths. Then the error of Validate, or of normals that are packed into 0 to 1; `name` is the file's.
Status MakeValid(const std::string& name, GuideSet& guides);

}  // namespace scumble::internal
