// A round brush of many hairs, as for ink on rice paper. More pressure fans it wider; wet it lays a wash; if dry, its
// hairs part and leave streaks of paper between them. Nothing here uses a canvas.
#pragma once

#include <vector>

#include "exemplars/paint/engine/brush.h"
#include "exemplars/paint/engine/chance.h"

namespace scumble::paint {

struct Tuft {
  float width;             // where it is pressed fully, in units
  float hair;              // radius of one, in units
  float gap = 1.5f;        // between neighbours, in radii
  float ink = 1.0f;        // 0 … 1: the pressure of a full hair, for a preset that gives more ink to more pressure
  float side = 0.0f;       // −1 … 1: dipped to one side, so that the ink is stronger there and weaker on the other
  float dryness = 0.0f;    // 0 … 1: how soon and how often hairs part from the paper
  float narrowest = 0.6f;  // share of the width where it hardly touches
  float spent = 0.35f;     // share of the ink that is gone at the stroke's end
};

// The paths of the single hairs when the tuft is drawn along `path`, whose pressures, 0 … 1, fan it. A path of fewer
// than four points leaves no mark.
std::vector<Stroke> PartIntoHairs(Chance& chance, const Stroke& path, const Tuft& tuft);

}  // namespace scumble::paint
