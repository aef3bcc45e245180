// The repetition of a picture, and the visibility of its seams: the measures of a flat wall.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/image/guides.h"
#include "measure/mosaic/coherence.h"
#include "scumble/picture.h"

namespace scumble {

// The mean number of covered pixels for each source pixel that occurs: covered / distinct sources. 0 where nothing is
// covered.
double SourceRepetition(const SourcePlanes& planes);

// A rectangle of a picture, pixels [x, x + width) × [y, y + height).
struct PictureRegion {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

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

struct SeamStrength {
  double along_borders = 0.0;  // mean difference of Oklab colours between neighbours in different chunks
  double inside = 0.0;         // the same inside chunks: without blending, the exemplar's own
  double excess = 0.0;         // along_borders / inside - 1; 0: seams do not stand out from the paint
  std::size_t border_pairs = 0;
  std::size_t inside_pairs = 0;
};

// Right and lower neighbours on one smooth surface: both covered, of one object, and with normals less than 15 degrees
// apart. Where the surface itself ends or turns, colours change for that reason, and no seam is to blame. A chunk
// shares one offset and exemplar. `guides` are of the picture's size; without ids all is one object. O(pixels).
SeamStrength MeasureSeams(const Picture& picture, const SourcePlanes& planes, const GuideSet& guides);

}  // namespace scumble
