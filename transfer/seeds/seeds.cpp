#include "transfer/seeds/seeds.h"

#include <limits>

#include "core/image/hash.h"

namespace scumble {

PixelPosition SeedOfCell(const SeedRules& rules, int level, int cell_x, int cell_y) {
  const PixelPosition in_cell = SeedInCell(rules, level, HashOn(SeedLevel(rules, level), cell_x), cell_y);
  return {cell_x * (1 << level) + in_cell.x, cell_y * (1 << level) + in_cell.y};
}

SeedGrid::SeedGrid(const SeedRules& rules, int level, const Region& region)
    : level_(level), first_column_((region.x0 >> level) - 1), first_row_((region.y0 >> level) - 1) {
  if (region.empty()) {
    columns_ = 0;
    return;
  }
  const int last_column = ((region.x1 - 1) >> level) + 1, last_row = ((region.y1 - 1) >> level) + 1;
  columns_ = last_column - first_column_ + 1;
  seeds_.reserve(static_cast<std::size_t>(columns_) * (last_row - first_row_ + 1));
  for (int row = first_row_; row <= last_row; ++row) {
    for (int column = first_column_; column <= last_column; ++column) {
      seeds_.push_back(SeedOfCell(rules, level, column, row));
    }
  }
}

std::size_t SeedGrid::Nearest(int x, int y) const {
  const int column = (x >> level_) - first_column_ - 1, first_row = (y >> level_) - first_row_ - 1;
  std::size_t best = 0;
  std::int64_t best_distance = std::numeric_limits<std::int64_t>::max();
  for (int dy = 0; dy < 3; ++dy) {
    const std::size_t row = static_cast<std::size_t>(first_row + dy) * columns_ + column;
    for (int dx = 0; dx < 3; ++dx) {
      const PixelPosition seed = seeds_[row + dx];
      const std::int64_t ex = seed.x - x, ey = seed.y - y;
      const std::int64_t distance = ex * ex + ey * ey;
      if (distance < best_distance) best_distance = distance, best = row + dx;
    }
  }
  return best;
}

SeedGrid::Two SeedGrid::NearestTwo(int x, int y) const {
  constexpr std::int64_t kFar = std::numeric_limits<std::int64_t>::max();
  const int column = (x >> level_) - first_column_ - 1, first_row = (y >> level_) - first_row_ - 1;
  std::size_t best = 0, second = 0;
  std::int64_t best_distance = kFar, second_distance = kFar;
  for (int dy = 0; dy < 3; ++dy) {
    const std::size_t row = static_cast<std::size_t>(first_row + dy) * columns_ + column;
    for (int dx = 0; dx < 3; ++dx) {
      const PixelPosition seed = seeds_[row + dx];
      const std::int64_t ex = seed.x - x, ey = seed.y - y;
      const std::int64_t distance = ex * ex + ey * ey;
      if (distance < best_distance) {
        second_distance = best_distance, second = best;
        best_distance = distance, best = row + dx;
      } else if (distance < second_distance) {
        second_distance = distance, second = row + dx;
      }
    }
  }
  return {best, second, second_distance - best_distance};
}

}  // namespace scumble
