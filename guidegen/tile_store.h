// Values of a tile into their plane.
#pragma once

#include <array>
#include <cstddef>

#include "guidegen/tile_hits.h"

namespace scumble {

// `values` are by TilePixel; `plane` has rows of `stride` floats, and all of the tile in it is written. `past_caches`:
// whether planes are too large to be found in the caches afterwards; whole lines then go to memory without being read
// first. What is written is seen by other threads as what any plain code writes.
void StoreTile(const Tile& tile, const std::array<float, kTilePixels>& values, float* plane, std::size_t stride,
               bool past_caches);
void FillTile(const Tile& tile, float value, float* plane, std::size_t stride);

}  // namespace scumble
