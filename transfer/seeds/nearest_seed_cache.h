// Which seed each pixel is nearest to, kept from frame to frame. It depends on the picture's size and on SeedRules alone, so
// a sequence whose jitter is frozen finds it once.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "transfer/seeds/seeds.h"

namespace scumble::internal {

// Tiles that the fast match works by (styleblit_tiles.h); the first begins at the picture's corner. Wide enough that seeds
// of coarse levels are shared by many pixels, small enough that threads have enough to share.
inline constexpr int kTileWidth = 512, kTileHeight = 128;
inline constexpr int kBlock = 16;  // pixels of a row that are matched at once
// Up to this level, where a row has many seeds, nearest ones are found pixel by pixel.
inline constexpr int kMaxSpreadLevel = 6;

// Of one tile on one level, what was found so far, by rows of blocks.
struct TileMap {
  struct Block {
    // Bit i: pixel i + 1 is near to another seed than pixel i, or there is none.
    std::uint16_t ends;
    // By pixel, which of the 3 × 3 cells around its own the nearest seed is in: 3 · row + column.
    std::array<std::uint8_t, kBlock> cell;
  };
  std::array<std::uint32_t, kTileHeight> known{};  // bits: blocks of the row
  std::array<std::array<Block, kTileWidth / kBlock>, kTileHeight> blocks;
};

// Memory is taken tile by tile and level by level as they are needed: 1.13 bytes a pixel and level. Different rows may be
// used by different threads, those of one tile too.
class SeedMap {
 public:
  SeedMap(int width, int height);
  ~SeedMap();
  SeedMap(const SeedMap&) = delete;
  SeedMap& operator=(const SeedMap&) = delete;

  // Levels 1 … kMaxSpreadLevel.
  TileMap& Of(int tile_x, int tile_y, int level);

 private:
  int columns_;
  std::vector<std::atomic<TileMap*>> tiles_;  // owned
};

// The maps of a sequence. One is made when the same seeds are asked for in a second frame: where jitter is renewed with
// every frame, and for single pictures, there is nothing to keep.
class SeedMaps {
 public:
  void BeginFrame();
  // Null: not yet, or not worth while. Holds until the next frame begins.
  SeedMap* For(const SeedRules& rules, int width, int height);

 private:
  struct Entry {
    SeedRules rules;
    int width, height;
    std::int64_t first_frame, last_frame;  // that asked for it
    std::unique_ptr<SeedMap> map;
  };
  static constexpr std::size_t kMost = 4;
  std::int64_t frame_ = 0;
  std::vector<Entry> entries_;
};

}  // namespace scumble::internal
