// What guides lose in files that hold fewer bits than floats.
#pragma once

#include "core/image/guides.h"

namespace scumble {

enum class GuidePrecision {
  kFloat,
  kHalf,
  kEightBits,  // as in a PNG: 0 … 1 in 255 steps, normals packed as (n + 1) / 2
};

// Rounds normals, colours, light and shadows of covered pixels to the nearest that such a file can hold, and brings
// normals to unit length where ReadGuides would: where the square of their length is off by more than 4e-3. Eight bits
// cut at 1 what is brighter; half floats at 65504. Coverage, ids, depth, positions and motion stay as they are: no file
// of eight bits could hold them. NaN stays NaN.
void RoundGuides(GuidePrecision precision, GuideSet& guides);

}  // namespace scumble
