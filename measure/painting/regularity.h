// Whether a texture comes back at even distances, as halftone, canvas, a checker or ruled lines do. Pieces of such a
// texture never fit where they meet: the eye sees every seam. Brush strokes and grain are alike everywhere and the same
// nowhere.
#pragma once

#include <vector>

#include "measure/mosaic/repetition.h"

namespace scumble {

struct RegularityReport {
  int windows = 0;  // that were looked at: those with texture
  // Highest peak (0 … 1) of the autocorrelation of the windows' average: what is regular all over the picture in one
  // direction adds up, what is there by chance goes.
  double peak = 0.0;
  // The highest that is two periods or more, and 5/8 of the largest shift, away: what a machine made is as much the
  // same there as it is after one period, what a hand made is not.
  double echo = 0.0;
  // That of each window by itself, its upper quartile: patterns that follow the form have another direction in each.
  double local_echo = 0.0;
  // The shortest period, pixels, and its direction, 0 … 180 degrees from the right turning up: of the average, or of
  // the window that shows the pattern best, whichever has the higher peak; 0 without one.
  double period = 0.0;
  double direction = 0.0;
  bool grid = false;  // the pattern comes back across its direction too: dots, squares, weave; otherwise it is lines
  int x = 0, y = 0;   // middle of the window that shows it best
};

struct RegularityOptions {
  int window = 128;           // side of the square windows, pixels, at least 16; periods up to 3/8 of it are seen
  double least_spread = 0.5;  // windows whose high-passed values spread less (standard deviation) have no texture
};

// `plane` holds width × height values 0 … 100, lightness; `windows` are the regions to look at, each of window × window
// pixels inside the plane. From each a Gaussian blur of 3/32 of its side is subtracted. A peak is a local maximum of
// the autocorrelation, 2 pixels or more from the middle, that a trough at least half as deep as the peak is high
// divides from the middle; a texture that is only smooth, or strokes that are only long, have none. Direct sums of
// integers: O(windows · side⁴ · 9/32).
RegularityReport MeasureRegularity(const std::vector<float>& plane, int width,
                                   const std::vector<PictureRegion>& windows, const RegularityOptions& options = {});

}  // namespace scumble
