// Evenly spaced lines, like an engraver's: no two are much nearer than the spacing, and no gap has room for another
// (after Jobard and Lefer, Creating Evenly-Spaced Streamlines of Arbitrary Density, 1997). Nothing here uses a canvas.
#pragma once

#include <vector>

#include "exemplars/paint/engine/strokes.h"

namespace scumble::paint {

struct EvenLineOptions {
  float closest = 0.45f;   // a line ends where its neighbour is nearer than this share of the spacing
  float shortest = 40.0f;  // units; shorter lines are left out
  float margin = 90.0f;    // lines continue this far past the picture's edges
};

// Lines of `flow` wherever `spacing`, the distance between neighbours in units, is more than 0; 60 at most. Pressures
// are 1, and points lie 4 units apart.
std::vector<Stroke> PlanEvenLines(Chance& chance, const Flow& flow, const Touch& spacing,
                                  const EvenLineOptions& options = {});

}  // namespace scumble::paint
