// The tone of an exemplar, and the direction of its light.
#pragma once

#include <vector>

#include "measure/painting/paint_sheet.h"

namespace scumble {

// CIE L* over usable pixels that are not transparent; all 0 where there is none. Percentiles, because a single speck is
// no range.
struct ToneReport {
  double darkest = 0.0;    // 1st percentile
  double brightest = 0.0;  // 99th percentile
  double mean = 0.0;
  double range() const { return brightest - darkest; }
};
ToneReport MeasureTone(const PaintSheet& sheet);

// The direction of a distant light that would shade a matt surface as the exemplar is painted.
struct PaintedLight {
  double azimuth = 0.0;  // degrees, as in core/image/direction.h
  double elevation = 0.0;
  double correlation = 0.0;  // Pearson's, 0 … 1, of the exemplar's L* with max(0, n · light); 0: no light was found
};

// Searches all directions from which some usable pixel would be lit, to a degree. The lightness is averaged in cells of
// 1/48 of the picture first, so strokes do not count. Transparent pixels are left out. O(pixels).
PaintedLight FindPaintedLight(const PaintSheet& sheet);

// Degrees between two directions.
double AngleBetween(const PaintedLight& a, const PaintedLight& b);

}  // namespace scumble
