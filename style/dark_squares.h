// Outlines of dark patches that are squares seen in perspective, on a picture of one channel.
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

namespace scumble {

// Brightness by rows, of any scale.
struct GreyPlane {
  int width = 0;
  int height = 0;
  std::vector<float> values;  // width × height

  float At(int x, int y) const { return values[std::size_t(y) * width + x]; }
  // Between pixel centres; beyond the picture, its border.
  float Between(glm::dvec2 at) const;
};

// Four corners, clockwise as seen on the screen, whichever first; pixel i covers [i, i + 1).
using Quad = std::array<glm::dvec2, 4>;

// Patches of connected pixels that are darker than 0.9 of the mean of the window of (2 · `radius` + 1)² around them,
// and whose outer outline is a convex quadrilateral, sides at least `least_side` long. A patch may have holes: a window
// that is smaller than a mark leaves its black border as a ring.
std::vector<Quad> FindDarkSquares(const GreyPlane& plane, int radius, double least_side);

}  // namespace scumble
