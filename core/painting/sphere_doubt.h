// Why paint shows no clear sphere, as far as its picture tells.
#pragma once

#include "core/image/style.h"
#include "core/painting/circle_fit.h"
#include "core/painting/paint_mask.h"

namespace scumble {

// `circle` is the one on which most of the outline lies, if that is a good part of it, and `tolerance` how far from it
// paint still belongs to it. Ground that is darker below the circle and touches it is a shadow; wide and faint paint
// around it is uneven ground. kNoCircle, if it is neither.
SphereDoubt DoubtAbout(const Picture& picture, const PaintMask& mask, const Circle& circle, double tolerance);

// Whether colour steps across the circle in a good part of its directions, as where paint ends on paper. Where light
// falls off across paper, the line of one brightness may be a circle too, but colour changes gradually across it.
bool HasColorStep(const Picture& picture, const Circle& circle);

}  // namespace scumble
