#include "transfer/vote/wide/chunk_runs.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <bit>

#include "core/image/hash.h"
#include "transfer/vote/wide/run_masks.h"

namespace scumble::internal {

bool WideTile::Read(const VoteInput& input, const Region& area) {
  const SourceField& field = input.field;
  bool any = false;
  for (int y = area.y0; y < area.y1 && !any; ++y) {
    const std::uint8_t* row = input.active.data() + field.Index(area.x0, y);
    any = std::any_of(row, row + (area.x1 - area.x0), [](std::uint8_t active) { return active != 0; });
  }
  if (!any) return false;
  area_ = area, radius_ = input.radius;
  surround_ = area.GrownBy(input.radius, field.width, field.height);
  const int columns = surround_.x1 - surround_.x0, rows = surround_.y1 - surround_.y0;
  words_ = (columns + 63) / 64 + 2;
  votes_.assign(std::size_t(words_) * rows, 0), changes_.assign(std::size_t(words_) * rows, 0);
  chunks_.clear(), found_.clear();
  if (table_.empty()) table_.resize(1024);
  if (++stamp_ == 0) {
    std::fill(table_.begin(), table_.end(), Entry{});
    stamp_ = 1;
  }
  std::int8_t full_level = 0;
  while (VoteReach(full_level, radius_) < radius_) ++full_level;
  for (int row = 0; row < rows; ++row) {
    const std::size_t i = field.Index(surround_.x0, surround_.y0 + row);
    // Prefetches the next tile to the right: its rows are too short for the hardware prefetcher.
    if (surround_.x1 + kTileSide <= field.width) {
      const std::size_t next = i + std::size_t(columns);
      for (int x = 0; x < kTileSide; x += 32) {
        hwy::Prefetch(field.x.data() + next + x), hwy::Prefetch(field.y.data() + next + x);
      }
      hwy::Prefetch(field.exemplar.data() + next), hwy::Prefetch(input.active.data() + next);
    }
    const FieldRow source{field.x.data() + i,
                          field.y.data() + i,
                          field.exemplar.data() + i,
                          field.level.data() + i,
                          input.active.data() + i,
                          full_level,
                          columns};
    MarkRuns(source, votes_.data() + std::size_t(row) * words_, changes_.data() + std::size_t(row) * words_);
    ReadRow(field, row);
  }
  // Sorts the runs by chunk, in the order in which they were found.
  std::uint32_t next = 0;
  for (Chunk& chunk : chunks_) {
    chunk.first = next;
    next += chunk.count;
    chunk.count = 0;
  }
  runs_.resize(found_.size());
  for (const FoundRun& found : found_) {
    Chunk& chunk = chunks_[found.chunk];
    runs_[chunk.first + chunk.count++] = found.run;
  }
  return true;
}

void WideTile::ReadRow(const SourceField& field, int row) {
  const std::uint64_t *changes = Changes(row), *votes = Votes(row);
  const int columns = surround_.x1 - surround_.x0;
  int begin = -1;
  for (int word = 0; 64 * word < columns; ++word) {
    for (std::uint64_t bits = changes[word]; bits; bits &= bits - 1) {
      const int at = 64 * word + std::countr_zero(bits);
      if (begin >= 0) AddRun(field, row, begin, at);
      begin = votes[word] >> (at & 63) & 1 ? at : -1;
    }
  }
  if (begin >= 0) AddRun(field, row, begin, columns);
}

void WideTile::AddRun(const SourceField& field, int row, int begin, int end) {
  const int left = surround_.x0 - area_.x0, y = row + surround_.y0 - area_.y0;
  const std::size_t i = field.Index(surround_.x0 + begin, surround_.y0 + row);
  const std::uint32_t chunk =
      FindChunk(field.x[i] - (left + begin), field.y[i] - y, field.exemplar[i], VoteReach(field.level[i], radius_));
  ++chunks_[chunk].count;
  found_.push_back(
      {{static_cast<std::int16_t>(y), static_cast<std::int16_t>(left + begin), static_cast<std::int16_t>(left + end)},
       chunk});
}

std::uint32_t WideTile::FindChunk(int shift_x, int shift_y, int exemplar, int reach) {
  // Shifts are 17 bits and a sign, a reach 7 bits.
  const std::uint64_t x = static_cast<std::uint32_t>(shift_x) & 0xfffff,
                      y = static_cast<std::uint32_t>(shift_y) & 0xfffff;
  const std::uint64_t key =
      static_cast<std::uint64_t>(reach) << 48 | x << 28 | y << 8 | static_cast<std::uint64_t>(exemplar);
  const std::size_t mask = table_.size() - 1;
  std::size_t slot = Mix64(key) & mask;
  while (table_[slot].stamp == stamp_) {
    if (table_[slot].key == key) return table_[slot].chunk;
    slot = (slot + 1) & mask;
  }
  const auto chunk = static_cast<std::uint32_t>(chunks_.size());
  table_[slot] = {key, chunk, stamp_};
  chunks_.push_back({shift_x, shift_y, exemplar, reach, 0, 0});
  if (2 * chunks_.size() > table_.size()) GrowTable();
  return chunk;
}

void WideTile::GrowTable() {
  std::vector<Entry> old(2 * table_.size());
  old.swap(table_);
  const std::size_t mask = table_.size() - 1;
  for (const Entry& entry : old) {
    if (entry.stamp != stamp_) continue;
    std::size_t slot = Mix64(entry.key) & mask;
    while (table_[slot].stamp == stamp_) slot = (slot + 1) & mask;
    table_[slot] = entry;
  }
}

}  // namespace scumble::internal
