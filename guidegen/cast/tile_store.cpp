#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "guidegen/cast/tile_store.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstdint>

#include "guidegen/cast/tile_store.h"

HWY_BEFORE_NAMESPACE();
namespace scumble {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A whole row of a tile is one cache line, if it is aligned. Consecutive lines are cheaper than scattered ones.
void StreamTiles(int rows, std::span<const float* const> values, float* to, std::size_t stride) {
  const hn::CappedTag<float, kSquareSide> d;
  for (int row = 0; row < rows; ++row, to += stride) {
    float* line = to;
    for (const float* tile : values) {
      for (int column = 0; column < kTileSide; column += int(hn::Lanes(d))) {
        hn::Stream(hn::Load(d, tile + TilePixel(column, row)), d, line + column);
      }
      line += kTileSide;
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble {

HWY_EXPORT(StreamTiles);

void StoreTiles(std::span<const Tile> tiles, std::span<const float* const> values, float* plane, std::size_t stride,
                bool past_caches) {
  constexpr std::size_t kLine = 64;
  static_assert(kTileSide * sizeof(float) == kLine);
  const auto place = [&](const Tile& tile) { return plane + std::size_t(tile.y0) * stride + std::size_t(tile.x0); };
  const bool on_lines =
      stride * sizeof(float) % kLine == 0 && reinterpret_cast<std::uintptr_t>(place(tiles[0])) % kLine == 0;
  std::size_t done = 0;
  if (past_caches && on_lines) {
    while (done < tiles.size() && tiles[done].width == kTileSide) ++done;
    if (done > 0) HWY_DYNAMIC_DISPATCH(StreamTiles)(tiles[0].height, values.first(done), place(tiles[0]), stride);
  }
  for (; done < tiles.size(); ++done) {
    const Tile& tile = tiles[done];
    float* to = place(tile);
    for (int row = 0; row < tile.height; ++row, to += stride) {
      for (int column = 0; column < tile.width; column += kSquareSide) {
        const float* square = values[done] + TilePixel(column, row);
        // A size known at compile time becomes one move.
        if (column + kSquareSide <= tile.width) {
          std::copy_n(square, kSquareSide, to + column);
        } else {
          std::copy_n(square, tile.width - column, to + column);
        }
      }
    }
  }
}

void PublishTiles() { hwy::FlushStream(); }

void FillTile(const Tile& tile, float value, float* plane, std::size_t stride) {
  for (int row = 0; row < tile.height; ++row) {
    std::fill_n(plane + std::size_t(tile.y0 + row) * stride + std::size_t(tile.x0), tile.width, value);
  }
}

}  // namespace scumble
#endif
