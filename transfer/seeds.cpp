#include "transfer/seeds.h"

#include <cmath>
#include <limits>

#include "image/hash.h"

namespace scumble {

PixelPosition SeedOfCell(const SeedRules& rules, int level, int cell_x, int cell_y) {
  const std::uint64_t hash = Hash(rules.seed, rules.time_step, level + rules.level_offset, cell_x, cell_y);
  const float h = static_cast<float>(1 << level);
  const float jitter_x = UnitFloat(hash) * rules.jitter;
  const float jitter_y = UnitFloat(Mix64(hash)) * rules.jitter;
  return {cell_x * (1 << level) + static_cast<int>(std::floor(h * jitter_x)),
          cell_y * (1 << level) + static_cast<int>(std::floor(h * jitter_y))};
}

SeedGrid::SeedGrid(const SeedRules& rules, int level, int width, int height) : level_(level) {
  const int last_cell_x = (width - 1) >> level, last_cell_y = (height - 1) >> level;
  columns_ = last_cell_x + 3;
  seeds_.reserve(static_cast<std::size_t>(columns_) * (last_cell_y + 3));
  for (int cell_y = -1; cell_y <= last_cell_y + 1; ++cell_y) {
    for (int cell_x = -1; cell_x <= last_cell_x + 1; ++cell_x) {
      seeds_.push_back(SeedOfCell(rules, level, cell_x, cell_y));
    }
  }
}

std::size_t SeedGrid::Nearest(int x, int y) const {
  const int cell_x = x >> level_, cell_y = y >> level_;
  std::size_t best = 0;
  std::int64_t best_distance = std::numeric_limits<std::int64_t>::max();
  for (int dy = 0; dy < 3; ++dy) {
    const std::size_t row = static_cast<std::size_t>(cell_y + dy) * columns_ + cell_x;
    for (int dx = 0; dx < 3; ++dx) {
      const PixelPosition seed = seeds_[row + dx];
      const std::int64_t ex = seed.x - x, ey = seed.y - y;
      const std::int64_t distance = ex * ex + ey * ey;
      if (distance < best_distance) best_distance = distance, best = row + dx;
    }
  }
  return best;
}

}  // namespace scumble
