// Measures the flicker of a sequence: the mean change of colour of visible surfaces, followed along their motion.
#pragma once

#include <cstddef>
#include <vector>

#include "core/image/guides.h"
#include "core/image/status.h"
#include "scumble/picture.h"

namespace scumble {

struct FlickerReport {
  std::size_t pixels = 0;  // that were compared
  std::size_t hidden =
      0;              // fully covered ones of the first frame that the second does not show, or that lie at an edge
  double mean = 0.0;  // of |a - b| over R, G and B, sRGB units 0 … 255; 0 without pixels
  // The score of the same motion if the first picture's colours all moved along. Pixels that move by fractions are
  // resampled, which blurs fine paint. It is 0 for whole pixels. A mean below it shows a blurred picture, not a steady
  // one.
  double floor = 0.0;
  std::vector<float> changes;  // by pixel of the first frame, row by row: the changes behind `mean`; NaN: not compared
};

// `a` and `b` are a frame and the next one; `guides` are the first one's, with layer `motion`: pixels to the next
// frame, +Y down. Transparent paint lies on white. A pixel p counts where the guides cover it fully, as they do its
// eight neighbours with the same object; b is read at p + motion from the four pixels around, bilinearly. With the next
// frame's guides, it counts only where those four are fully covered by the same object and show the same place: where
// both guides hold `pref` it may not be farther off than p's neighbours are, otherwise depth may not change by more
// than 5 %. Error: sizes differ, or no motion. Deterministic. O(pixels).
Expected<FlickerReport> MeasureFlicker(const Picture& a, const Picture& b, const GuideSet& guides,
                                       const GuideSet* next_guides = nullptr);

}  // namespace scumble
