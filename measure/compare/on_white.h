// Pictures with transparent paint, for measures that need every pixel to have a colour.
#pragma once

#include <array>
#include <cstddef>

#include "scumble/picture.h"

namespace scumble {

// R, G and B of a pixel laid on white, sRGB-encoded, 0 … 1; mixed in the encoding.
inline std::array<double, 3> OnWhite(const Picture& picture, int x, int y) {
  const std::uint16_t* texel = picture.At(x, y);
  const double alpha = texel[3] / 65535.0;
  std::array<double, 3> color;
  for (std::size_t c = 0; c < 3; ++c) color[c] = texel[c] / 65535.0 * alpha + 1.0 - alpha;
  return color;
}

}  // namespace scumble
