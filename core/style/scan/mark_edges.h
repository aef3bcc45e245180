// Lays the corners of a mark anew, from where the light changes along its sides in the full picture. The detector's own
// corners come from steps of whole pixels of the encoded picture, in which blur makes black squares smaller: with them
// the template lies up to eighteen times as far off (five times, in the middle), and marks on one side only do not hold
// it.
#pragma once

#include "core/style/scan/marker_detection.h"
#include "scumble/picture.h"

namespace scumble {

// `mark` has corners to within a module; its corners, module_pixels and blur_pixels are set. False, and the mark as it
// was, where a side cannot be made out.
bool RefineMark(const Picture& picture, FoundMark& mark);

}  // namespace scumble
