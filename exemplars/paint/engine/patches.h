// Brushwork in groups: a few touches side by side in one tone, then another place and direction. The caller draws each
// touch.
#pragma once

#include <functional>

#include "exemplars/paint/engine/chance.h"
#include "exemplars/paint/engine/strokes.h"

namespace scumble::paint {

struct PatchOptions {
  float spacing = 60.0f;  // between the patches' middles
  int touches_min = 3;    // in a patch
  int touches_max = 6;
  float apart = 14.0f;  // between neighbours of a patch
  float length_min = 50.0f;
  float length_max = 90.0f;
  float slant = 0.35f;       // radians by which the patches' directions vary
  float unevenness = 0.20f;  // of spacing, ends and directions inside a patch
};

// Calls `draw(path, middle of the patch)` for each touch. `flow` is called at the middle of a patch only, and the
// touches bend as it does there. Covers the picture and its margin evenly.
void LayPatches(Chance& chance, const Flow& flow, const PatchOptions& options,
                const std::function<void(Stroke path, glm::vec2 patch)>& draw);

// A flow turned by that angle, in radians.
Flow Turned(const Flow& flow, float angle);

}  // namespace scumble::paint
