// Connected regions of pixels: holes, bare places.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace scumble {

struct Patches {
  std::size_t count = 0;
  std::size_t pixels = 0;   // of all of them
  std::size_t largest = 0;  // pixels of the largest; of equal ones the first in row order
  int x = 0, y = 0;         // its pixel nearest to its middle
};

// The 4-connected regions of pixels that are not 0, of at least `least` pixels. `mask` holds width × height values in
// row order. O(pixels).
Patches FindPatches(const std::vector<std::uint8_t>& mask, int width, int height, std::size_t least = 1);

// 1 where at least `share` (0 … 1) of the pixels in the square of side 2 · reach + 1 around a pixel are not 0. Pixels
// outside the picture count as 0. O(pixels).
std::vector<std::uint8_t> MostlySet(const std::vector<std::uint8_t>& mask, int width, int height, int reach,
                                    double share);

}  // namespace scumble
