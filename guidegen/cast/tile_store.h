// Writes the values of a tile into their plane.
#pragma once

#include <cstddef>
#include <span>

#include "guidegen/cast/tile_hits.h"

namespace scumble {

// Tiles stand side by side from left to right, with equal numbers of rows; the `values` of each are by TilePixel.
// `plane` has rows of `stride` floats; every pixel of the tiles is written. `past_caches`: planes are too large to stay
// in the caches. Whole lines then go to memory without being read first, and they are not ordered with later writes of
// the thread: other threads may read them after PublishTiles().
void StoreTiles(std::span<const Tile> tiles, std::span<const float* const> values, float* plane, std::size_t stride,
                bool past_caches);
// Call it after a thread has stored its tiles and before any other thread reads them. Waits until they have left the
// core, which takes longer than storing a plane of a tile: call it once for many tiles.
void PublishTiles();
void FillTile(const Tile& tile, float value, float* plane, std::size_t stride);

}  // namespace scumble
