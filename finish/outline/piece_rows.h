// What a straight piece of a stroke covers of a row of pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

namespace scumble::internal {

// A piece beside a row of pixels. Lengths in pixels.
struct PieceAtRow {
  glm::vec2 along;          // from its beginning to its end
  float per_squared;        // 1 / its length squared; 0 if it has none
  float right, down;        // from its beginning to the centre of the row's first pixel
  float from_width, wider;  // its width at the beginning, and how much more it has at the end
  std::uint32_t owner;
};

// A multiple of the floats in any machine's vector: counts that are multiples of it are quickest.
inline constexpr std::size_t kCoverBlock = 16;

// Raises the shares of `count` pixels, 0 … 1, to what the piece covers of them. The piece is antialiased and round at
// both ends. If it is thinner than a pixel, it is as faint as it is thin. `owners`: becomes the piece's where it does
// so; or null. The same bits on every machine.
void CoverRow(const PieceAtRow& at, std::size_t count, float* shares, std::uint32_t* owners);

}  // namespace scumble::internal
