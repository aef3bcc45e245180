// LDR-FLIP: the visibility of the difference of two pictures to a viewer who flips between them.
//
// P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M. D. Fairchild: FLIP: A Difference Evaluator
// for Alternating Images, HPG 2020. Its colour pipeline: both pictures are filtered by the eye's contrast sensitivity,
// compared in Hunt-adjusted L*a*b* by the HyAB distance, and errors are spread over 0 … 1. Its feature pipeline raises
// the error where one picture has an edge or a point that the other lacks. The constants are the
// paper's: q_c 0.7, p_c 0.4, p_t 0.95, q_f 0.5, w 0.082°, its contrast sensitivity functions, primaries and white of
// sRGB; luminance is divided by 116 as the authors' errata have it. Border pixels are repeated, as in
// their code. Of a whole map they recommend the mean.
#pragma once

#include <array>
#include <numbers>
#include <vector>

#include "core/image/status.h"
#include "scumble/picture.h"

namespace scumble {

// Pixels of a display in one degree of the viewer's sight: distance · (pixels / width) · π / 180.
constexpr double PixelsPerDegree(double distance_m, double width_pixels, double width_m) {
  return distance_m * (width_pixels / width_m) * std::numbers::pi / 180.0;
}

struct FlipOptions {
  // Above 0 and at most 1000. The published default: a display of 4K, 0.7 m wide and 0.7 m away, 67.02.
  double pixels_per_degree = PixelsPerDegree(0.7, 3840.0, 0.7);
  int threads = 0;  // 0: all; the result does not depend on them
};

struct FlipReport {
  int width = 0;  // of the map
  int height = 0;
  double mean = 0.0;
  double max = 0.0;
  double rms = 0.0;        // root mean square of the differences of R, G and B, as they were given
  std::vector<float> map;  // 0 … 1 by pixel, rows from the top
};

// Linear Rec.709 of any source, 0 … 1: values outside are clamped, NaN counts as 0. Expose light first.
struct LinearColors {
  int width = 0;
  int height = 0;
  std::array<std::vector<float>, 3> planes;  // width × height each
};

// Transparent paint lies on white, in the encoding, where `rms` is taken as well (0 … 1). Order matters only to the
// last bits of rounding: it is symmetric by formula. Errors: sizes differ, or nothing to compare (kInput), pixels per
// degree out of range (kUsage). O(pixels · pixels per degree), about 70 bytes a pixel.
Expected<FlipReport> MeasureFlip(const Picture& reference, const Picture& test, const FlipOptions& options = {});

// MeasureFlip of linear colours; `rms` is of the clamped linear values.
Expected<FlipReport> MeasureFlip(const LinearColors& reference, const LinearColors& test,
                                 const FlipOptions& options = {});

}  // namespace scumble
