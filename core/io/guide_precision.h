// Rounds guides to the precision of files with fewer bits than floats.
#pragma once

#include "core/image/guides.h"

namespace scumble {

enum class GuidePrecision {
  kFloat,
  kHalf,
  kEightBits,  // as in a PNG: 0 … 1 in 255 steps, normals packed as (n + 1) / 2
};

// Rounds normals, colours, light and shadows of covered pixels to the nearest value in such a file. Normals become unit
// length where ReadGuides would normalise them: where the square of their length is off by more than 4e-3. Eight bits
// clamp at 1, half floats at 65504. Coverage, ids, depth, positions and motion stay: no file of eight bits could hold
// them. NaN stays NaN.
void RoundGuides(GuidePrecision precision, GuideSet& guides);

}  // namespace scumble
