// A rectangle of the picture.
#pragma once

#include <algorithm>

namespace scumble {

// Pixels [x0, x1) × [y0, y1).
struct Region {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;

  bool empty() const { return x0 >= x1 || y0 >= y1; }
  Region GrownBy(int pixels, int width, int height) const {
    return {std::max(0, x0 - pixels), std::max(0, y0 - pixels), std::min(width, x1 + pixels),
            std::min(height, y1 + pixels)};
  }
};

}  // namespace scumble
