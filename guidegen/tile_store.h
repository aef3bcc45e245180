// Values of a tile into their plane.
#pragma once

#include <array>
#include <cstddef>

#include "guidegen/tile_hits.h"

namespace scumble {

// `values` are by TilePixel; `plane` has rows of `stride` floats, and all of the tile in it is written. `past_caches`:
// whether planes are too large to be found in the caches afterwards; whole lines then go to memory without being read
// first, and are not ordered with what the thread writes next: other threads may look at them after PublishTiles().
void StoreTile(const Tile& tile, const std::array<float, kTilePixels>& values, float* plane, std::size_t stride,
               bool past_caches);
// After the tiles that a thread stores and before it tells any other that they are there. Waits until they have left the
// core, which takes longer than storing a plane of a tile: for once in many tiles.
void PublishTiles();
void FillTile(const Tile& tile, float value, float* plane, std::size_t stride);

}  // namespace scumble
