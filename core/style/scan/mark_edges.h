// Refines the corners of a mark from the change of light along its sides in the full picture. The detector's own
// corners come from steps of whole pixels of the encoded picture, in which blur makes black squares smaller. With those
// corners the template lies up to eighteen times as far off (five times, in the middle), and marks on one side only do
// not determine it.
#pragma once

#include "core/style/scan/marker_detection.h"
#include "scumble/picture.h"

namespace scumble {

// `mark` has corners to within a module; sets its corners, module_pixels and blur_pixels. False, and `mark` unchanged,
// where a side cannot be found.
bool RefineMark(const Picture& picture, FoundMark& mark);

}  // namespace scumble
