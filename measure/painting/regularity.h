// Whether a texture repeats at even distances, like halftone, canvas, a checker or ruled lines. Chunks of such a
// texture never match at their borders, so every seam is visible. Brush strokes and grain are alike everywhere and
// repeat nowhere.
#pragma once

#include <vector>

namespace scumble {

// A rectangle of a picture, pixels [x, x + width) × [y, y + height).
struct PictureRegion {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

struct RegularityReport {
  int windows = 0;  // measured windows: those with texture
  // Highest peak (0 … 1) of the autocorrelation of the windows' average. A pattern that is regular all over the picture
  // in one direction adds up; random texture averages out.
  double peak = 0.0;
  // The highest peak that is at least two periods, and 5/8 of the largest shift, away. A machine-made pattern is as
  // strong there as after one period; a hand-made one is not.
  double echo = 0.0;
  // The echo of each window by itself, its upper quartile: patterns that follow the form have another direction in
  // each.
  double local_echo = 0.0;
  // The shortest period, pixels, and its direction, 0 … 180 degrees from the right turning up. It is the average's, or
  // that of the window with the clearest pattern, whichever has the higher peak; 0 without one.
  double period = 0.0;
  double direction = 0.0;
  bool grid = false;  // the pattern also repeats across its direction: dots, squares, weave; otherwise it has lines
  int x = 0, y = 0;   // middle of the window with the clearest pattern
};

struct RegularityOptions {
  int window = 128;           // side of the square windows, pixels, at least 16; periods up to 3/8 of it are found
  double least_spread = 0.5;  // windows whose high-passed values spread less (standard deviation) have no texture
};

// `plane` holds width × height values 0 … 100, lightness; `windows` are the regions to measure, each of window × window
// pixels inside the plane. From each a Gaussian blur of 3/32 of its side is subtracted. A peak is a local maximum of
// the autocorrelation, at least 2 pixels from the middle. A trough at least half as deep as the peak is high must lie
// between it and the middle; smooth textures and long strokes have none. Direct sums of integers: O(windows · side⁴ ·
// 9/32).
RegularityReport MeasureRegularity(const std::vector<float>& plane, int width,
                                   const std::vector<PictureRegion>& windows, const RegularityOptions& options = {});

}  // namespace scumble
