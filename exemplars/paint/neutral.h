// Exemplars in greys alone, for scenes with their own colours.
#pragma once

#include "exemplars/paint/engine/canvas.h"

namespace scumble::paint {

// Removes the colour that the brushes mixed in: red, green and blue become equal, to the bit.
Colors Neutral(Colors colors);

}  // namespace scumble::paint
