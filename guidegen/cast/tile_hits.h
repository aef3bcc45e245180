// The hits of one tile's primary rays, and the place of its pixels in arrays.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

namespace scumble {

inline constexpr int kTileSide = 16;
inline constexpr int kTilePixels = kTileSide * kTileSide;

// A rectangle of at most kTileSide × kTileSide pixels.
struct Tile {
  int x0 = 0;
  int y0 = 0;
  int width = 0;
  int height = 0;
};

// Tiles that are cast together, side by side: their rows of a plane are written at once.
inline constexpr int kStripTiles = 4;

// Squares of 4 × 4 pixels one after the other, row by row inside and out. A square is a packet of rays, and its halves
// fill vectors without a shuffle.
inline constexpr int kSquareSide = 4;
inline constexpr int kSquarePixels = kSquareSide * kSquareSide;
inline constexpr int kTileSquares = kTileSide / kSquareSide;  // in a row of them

constexpr int TilePixel(int column, int row) {
  return ((row / kSquareSide) * kTileSquares + column / kSquareSide) * kSquarePixels +
         (row % kSquareSide) * kSquareSide + column % kSquareSide;
}
constexpr int TileColumn(int pixel) {
  return (pixel / kSquarePixels % kTileSquares) * kSquareSide + pixel % kSquareSide;
}
constexpr int TileRow(int pixel) {
  return (pixel / (kSquarePixels * kTileSquares)) * kSquareSide + pixel % kSquarePixels / kSquareSide;
}

// By TilePixel. Pixels beyond the tile's edge have no hit.
struct TileHits {
  static constexpr std::uint32_t kNothing = ~0u;  // as Embree has it
  alignas(64) std::array<std::uint32_t, kTilePixels> object;
  alignas(64) std::array<std::uint32_t, kTilePixels> primitive;

  // The distance, in lengths of the ray's direction, from which the ray is clear for rays of light too, up to its hit.
  // Only set for hits, and only on request.
  alignas(64) std::array<float, kTilePixels> clear_from;

  bool Met(int pixel) const { return object[std::size_t(pixel)] != kNothing; }
};

// The rays through the pixels' centres: their horizontal and vertical parts, of the origin where the picture is
// orthographic and of the direction otherwise. The other parts are 0, and −1 for direction.z.
struct TileRays {
  bool orthographic = false;
  std::array<double, kTileSide> across{};  // by column
  std::array<double, kTileSide> up{};      // by row
};

}  // namespace scumble
