#include "transfer/seeds/nearest_seed_cache.h"

#include <algorithm>

namespace scumble::internal {

static_assert(kTileWidth % kBlock == 0 && kTileWidth / kBlock <= 32);

SeedMap::SeedMap(int width, int height)
    : columns_((width + kTileWidth - 1) / kTileWidth),
      tiles_(std::size_t(columns_) * ((height + kTileHeight - 1) / kTileHeight) * kMaxSpreadLevel) {}

SeedMap::~SeedMap() {
  for (const std::atomic<TileMap*>& tile : tiles_) delete tile.load();
}

TileMap& SeedMap::Of(int tile_x, int tile_y, int level) {
  std::atomic<TileMap*>& tile = tiles_[(std::size_t(tile_y) * columns_ + tile_x) * kMaxSpreadLevel + level - 1];
  TileMap* map = tile.load(std::memory_order_acquire);
  if (map) return *map;
  auto made = std::make_unique_for_overwrite<TileMap>();
  return tile.compare_exchange_strong(map, made.get()) ? *made.release() : *map;
}

void SeedMaps::BeginFrame() {
  ++frame_;
  std::erase_if(entries_, [&](const Entry& entry) { return entry.last_frame < frame_ - 1; });
}

SeedMap* SeedMaps::For(const SeedRules& rules, int width, int height) {
  const auto same = [&](const Entry& entry) {
    return entry.rules == rules && entry.width == width && entry.height == height;
  };
  const auto found = std::find_if(entries_.begin(), entries_.end(), same);
  if (found == entries_.end()) {
    if (entries_.size() < kMost) entries_.push_back({rules, width, height, frame_, frame_, nullptr});
    return nullptr;
  }
  found->last_frame = frame_;
  if (!found->map && found->first_frame < frame_) found->map = std::make_unique<SeedMap>(width, height);
  return found->map.get();
}

}  // namespace scumble::internal
