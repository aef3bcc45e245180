// Measures of a painted wall: whether strokes come back, and how its tone changes.
#pragma once

#include "measure/painting/regularity.h"
#include "scumble/picture.h"

namespace scumble {

struct AutocorrelationPeak {
  double value = 0.0;  // -1 … 1; 1: the region comes back exactly; 0 for a region of one tone
  int dx = 0;          // the shift
  int dy = 0;
};

struct AutocorrelationOptions {
  int least_shift = 8;  // shifts up to this are left out: within them any texture is alike
  int step = 1;         // only shifts that are multiples of it
  // Standard deviation in pixels of the Gaussian whose blur is subtracted first; 0: no subtraction. Without it, chunks
  // of different tone correlate over every shift that is smaller than a chunk; with it, only repeated strokes do.
  double subtract_sigma = 0.0;
};

// The highest normalised correlation (Pearson's, of the Oklab lightness) of a region with itself, shifted by up to half
// its size but by more than the least shift in one direction. Direct sums: O(region² / 2 / step²). The region must lie
// in the picture; the blur ignores pixels outside it.
AutocorrelationPeak HighestAutocorrelation(const Picture& picture, const PictureRegion& region,
                                           const AutocorrelationOptions& options = {});

// The change of tone from chunk to chunk: the standard deviation over the region of its Oklab lightness (0 … 1) under a
// Gaussian blur of `sigma` pixels, which ignores pixels outside the region. 0 for one tone.
double ToneSpread(const Picture& picture, const PictureRegion& region, double sigma);

}  // namespace scumble
