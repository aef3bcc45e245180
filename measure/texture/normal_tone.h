// The tone of an exemplar under each normal: what is left of a painting without its strokes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "scumble/picture.h"

namespace scumble::internal {

// x, y and z by pixel.
using NormalPlanes = std::array<std::span<const float>, 3>;

// Oklab of a texel's straight colour.
glm::vec3 OklabOf(const std::uint16_t* texel);

// Means over a grid of the normals' x and y, under a Gaussian as narrow as it can be and still find pixels. Colours are
// straight Oklab; alpha does not matter.
class NormalTone {
 public:
  // Takes the pixels that are `usable`, not 0. All arrays have a value for each of the picture's pixels. O(pixels).
  NormalTone(const Picture& picture, const NormalPlanes& normal, std::span<const std::uint8_t> usable);

  // Between the grid's four nearest means. Any finite x and y.
  glm::vec3 At(float x, float y) const;

 private:
  static constexpr int kSide = 64;
  static std::size_t BinOf(float x, float y);

  std::array<std::vector<float>, 3> mean_;  // kSide rows of kSide
};

}  // namespace scumble::internal
