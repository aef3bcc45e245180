// Values of a tile into their plane.
#pragma once

#include <cstddef>
#include <span>

#include "guidegen/cast/tile_hits.h"

namespace scumble {

// Tiles that stand side by side from the left to the right, with as many rows each; `values` of each are by TilePixel.
// `plane` has rows of `stride` floats, and all of the tiles in it is written. `past_caches`: whether planes are too
// large to be found in the caches afterwards; whole lines then go to memory without being read first, and are not
// ordered with what the thread writes next: other threads may look at them after PublishTiles().
void StoreTiles(std::span<const Tile> tiles, std::span<const float* const> values, float* plane, std::size_t stride,
                bool past_caches);
// Call it after the tiles that a thread stores and before any other thread reads them. Waits until they have left
// the core, which takes longer than storing a plane of a tile: for once in many tiles.
void PublishTiles();
void FillTile(const Tile& tile, float value, float* plane, std::size_t stride);

}  // namespace scumble
