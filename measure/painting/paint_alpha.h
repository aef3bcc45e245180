// The transparency of an exemplar's paint.
#pragma once

#include "measure/painting/connected_regions.h"
#include "measure/painting/paint_sheet.h"

namespace scumble {

struct AlphaReport {
  Patches holes;                     // usable pixels that are fully transparent (alpha of 1% or less)
  Patches translucent;               // usable pixels of partly transparent paint, edges of holes left out
  double transparent_percent = 0.0;  // of the usable pixels: all that are not opaque
  double translucent_percent = 0.0;
  bool premultiplied = false;  // colours fade to black with alpha: they were saved multiplied by it
  int soft_edge = 0;           // of a sphere, where it is wider than the style's rim: pixels (SoftEdge)
  bool clear_corners = false;  // of a sphere: everything beyond 1.15 radii is transparent
};

// Decides whether colours are premultiplied: whether the colour of the nearest opaque paint (within 4 pixels) times
// alpha fits better, by half, than that colour itself. It uses all pixels between 5% and 95% opaque, if there are 16 of
// them. Dark paint gives no evidence. O(pixels).
AlphaReport MeasureAlpha(const PaintSheet& sheet);

}  // namespace scumble
