#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "guidegen/tile_store.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h must come first.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstdint>

#include "guidegen/tile_store.h"

HWY_BEFORE_NAMESPACE();
namespace scumble {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A whole row of a tile is one line of the cache, where it begins with one.
void StreamTile(int rows, const float* values, float* to, std::size_t stride) {
  const hn::CappedTag<float, kSquareSide> d;
  for (int row = 0; row < rows; ++row, to += stride) {
    for (int column = 0; column < kTileSide; column += int(hn::Lanes(d))) {
      hn::Stream(hn::Load(d, values + TilePixel(column, row)), d, to + column);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble {

HWY_EXPORT(StreamTile);

void StoreTile(const Tile& tile, const std::array<float, kTilePixels>& values, float* plane, std::size_t stride,
               bool past_caches) {
  constexpr std::size_t kLine = 64;
  static_assert(kTileSide * sizeof(float) == kLine);
  float* to = plane + std::size_t(tile.y0) * stride + std::size_t(tile.x0);
  const bool whole_lines = stride * sizeof(float) % kLine == 0 && reinterpret_cast<std::uintptr_t>(to) % kLine == 0;
  if (past_caches && whole_lines && tile.width == kTileSide) {
    HWY_DYNAMIC_DISPATCH(StreamTile)(tile.height, values.data(), to, stride);
    return;
  }
  for (int row = 0; row < tile.height; ++row, to += stride) {
    for (int column = 0; column < tile.width; column += kSquareSide) {
      const float* square = values.data() + TilePixel(column, row);
      // A number known at compile time makes one move of it.
      if (column + kSquareSide <= tile.width) {
        std::copy_n(square, kSquareSide, to + column);
      } else {
        std::copy_n(square, tile.width - column, to + column);
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
