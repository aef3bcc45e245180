// A picture of the differences between two files.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/image/channel_image.h"
#include "core/image/status.h"
#include "scumble/picture.h"

namespace scumble {

struct HeatMapOptions {
  double full_scale = 0.0;          // the difference shown as full yellow; 0: the largest one
  std::vector<std::string> layers;  // as in CompareOptions
};

struct HeatMap {
  Picture picture;
  double full_scale = 0.0;       // the one that was used; 0 where no finite value differs
  std::size_t incomparable = 0;  // pixels, drawn in magenta
};

// Per pixel the largest |a − b| of the channels that both files have: dark blue where equal, over grey, to yellow at
// full scale and above; magenta where a NaN or a lone infinity makes the pixel incomparable. The ramp is straight in
// Oklab with rising lightness, so it is readable in grey and by colour-blind viewers. Errors as those of Compare.
Expected<HeatMap> DifferenceHeatMap(const ChannelImage& a, const ChannelImage& b, const HeatMapOptions& options = {});

// The same colours for other values, row by row: 0 is dark blue, full_scale (above 0) and more yellow; transparent
// where NaN. `values` are width × height.
Picture ValueHeatMap(std::span<const float> values, int width, int height, double full_scale);

}  // namespace scumble
