// What a painting's alpha channel lets through.
#pragma once

#include "measure/painting/connected_regions.h"
#include "measure/painting/paint_sheet.h"

namespace scumble {

struct AlphaReport {
  Patches holes;                     // usable pixels that are fully transparent (alpha of 1% or less)
  Patches translucent;               // usable pixels of paint that is partly see-through, edges of holes left out
  double transparent_percent = 0.0;  // of what is usable: all pixels that are not opaque
  double translucent_percent = 0.0;
  bool premultiplied = false;  // colours fade to black with alpha: they were saved multiplied by it
  bool clear_corners = false;  // of a sphere: what lies beyond 1.15 radii is transparent
};

// Premultiplied is what fits better, by half, as the colour of the nearest opaque paint (within 4 pixels) times alpha
// than as that colour itself; over the pixels of the whole picture that are between 5% and 95% opaque, if there are 16
// of them. Dark paint tells nothing. O(pixels).
AlphaReport MeasureAlpha(const PaintSheet& sheet);

}  // namespace scumble
