// Paintings in greys alone, for scenes that bring their own colours.
#pragma once

#include "exemplars/paint/engine/canvas.h"

namespace scumble::paint {

// Takes out what colour the brushes mixed in: red, green and blue become the same, to the bit.
Colors Neutral(Colors colors);

}  // namespace scumble::paint
