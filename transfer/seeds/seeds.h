// Jittered seeds: the centres that the parallel StyleBlit grows its chunks from (Sýkora et al. 2019, section 3.2).
#pragma once

#include <cstdint>
#include <vector>

#include "core/filter/region.h"
#include "core/image/hash.h"

namespace scumble {

struct SeedRules {
  std::uint64_t seed = 0;
  std::int64_t time_step = 0;
  float jitter = 1.0f;
  int level_offset = 0;  // added to the level that is hashed: a preview of half the size, which has one level less,
                         // then places its seeds as the final picture does

  bool operator==(const SeedRules&) const = default;
};

struct PixelPosition {
  int x = 0;
  int y = 0;
};

// The seed of cell (cell_x, cell_y) on the grid of 2^level pixels: floor(h · (cell + j)), j in [0, 1)² hashed from
// (seed, time step, level, cell) and scaled by the jitter. Cells outside the picture have seeds too.
PixelPosition SeedOfCell(const SeedRules& rules, int level, int cell_x, int cell_y);

// SeedOfCell in steps, for loops along rows or columns of cells. SeedLevel hashes (seed, time step, level); HashOn with
// the cell's column makes `column` of it. From that follows the seed's offset from its cell's corner, in [0, 2^level)
// each way.
inline std::uint64_t SeedLevel(const SeedRules& rules, int level) {
  return Hash(rules.seed, rules.time_step, level + rules.level_offset);
}
inline PixelPosition SeedInCell(const SeedRules& rules, int level, std::uint64_t column, int cell_y) {
  const std::uint64_t hash = HashOn(column, cell_y);
  const float h = static_cast<float>(1 << level);
  const float jitter_x = UnitFloat(hash) * rules.jitter;
  const float jitter_y = UnitFloat(Mix64(hash)) * rules.jitter;
  return {static_cast<int>(h * jitter_x), static_cast<int>(h * jitter_y)};  // rounded down, as neither is negative
}

// All seeds near pixels of a region, on one level.
class SeedGrid {
 public:
  SeedGrid(const SeedRules& rules, int level, const Region& region);

  int level() const { return level_; }
  std::size_t size() const { return seeds_.size(); }
  PixelPosition Position(std::size_t index) const { return seeds_[index]; }
  // Column and row of a seed's cell: equal in a preview of half the size, on the level below.
  PixelPosition Cell(std::size_t index) const {
    return {first_column_ + static_cast<int>(index % columns_), first_row_ + static_cast<int>(index / columns_)};
  }

  // Index of the nearest seed among the 3 × 3 cells around the own one of a pixel of the region, by squared integer
  // distance; ties to the first in row order.
  std::size_t Nearest(int x, int y) const;

  // The nearest seed and the second nearest among those cells, by the same rule.
  struct Two {
    std::size_t nearest;
    std::size_t second;
    std::int64_t excess;  // how much larger the squared distance of the second is
  };
  Two NearestTwo(int x, int y) const;

 private:
  int level_;
  int first_column_, first_row_;  // cells; one more on each side than the region needs
  int columns_;
  std::vector<PixelPosition> seeds_;
};

}  // namespace scumble
