// What the edge test reads of one row of the picture.
#pragma once

#include <cstdint>

namespace scumble::internal {

// Each from column 0 on. Depth and slopes are copies and have 64 values more on either side of a tile: depth is NaN
// where nothing is covered, which neither has a slope nor passes a test.
struct EdgeRow {
  const float* depth;
  const float* slope_x;
  const float* slope_y;
  const float* object;
  const float* normal[3];
  std::int64_t before, readable;  // values of the guides before column 0, and from it to the end
};

}  // namespace scumble::internal
