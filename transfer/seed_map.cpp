#include "transfer/seed_map.h"

#include <algorithm>

namespace scumble::internal {

static_assert(kTileWidth % kBlock == 0 && kTileWidth / kBlock <= 32);

SeedMap::SeedMap(int width, int height) : columns_((width + kTileWidth - 1) / kTileWidth) {
  const int rows = (height + kTileHeight - 1) / kTileHeight;
  tiles_.resize(std::size_t(columns_) * rows * kMaxSpreadLevel);
}

TileMap& SeedMap::Of(int tile_x, int tile_y, int level) {
  std::unique_ptr<TileMap>& map = tiles_[(std::size_t(tile_y) * columns_ + tile_x) * kMaxSpreadLevel + level - 1];
  if (!map) map = std::make_unique_for_overwrite<TileMap>();
  return *map;
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
