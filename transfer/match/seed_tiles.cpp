#include "transfer/match/seed_tiles.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include "core/image/check.h"
#include "core/image/hash.h"
#include "transfer/match/variety.h"

namespace scumble::internal {
namespace {

constexpr int kNoSeedRow = std::numeric_limits<int>::min();

// Writes `value` to the 2^level places from `out` on, level 1 or more.
void Spread(std::uint16_t* out, int level, std::uint16_t value) {
  const std::uint64_t four = value * 0x0001000100010001ull;
  if (level == 1) {
    std::memcpy(out, &four, 2 * sizeof value);
    return;
  }
  for (int i = 0; i < 1 << level; i += 4) std::memcpy(out + i, &four, sizeof four);
}

// Quotient rounded down; b > 0.
std::int64_t FloorDivide(std::int64_t a, std::int64_t b) {
  const std::int64_t quotient = a / b;
  return quotient - (a - quotient * b < 0);
}

}  // namespace

void TileSeeds::Reset(const MatchInput& input, int level, int x0) {
  input_ = &input;
  for (int c = 0; c < 3; ++c) normal_[c] = input.guides.Plane(Layer::kNormal, c).data();
  level_ = level;
  first_column_ = (x0 >> level) - 1;
  left_ = first_column_ * (1 << level);
  columns_ = ((x0 + kTileWidth - 1) >> level) + 1 - first_column_ + 1;
  part_ = std::max(0, 6 - level);
  SCUMBLE_DCHECK(columns_ >> part_ < 64);
  for (Made* made : {&filled_, &placed_}) {
    std::fill(std::begin(made->row), std::end(made->row), kNoSeedRow);
    made->last_row = kNoSeedRow;
  }
  column_hashes_.resize(std::size_t(columns_));
  const std::uint64_t level_hash = SeedLevel(input.seeds, level);
  for (int c = 0; c < columns_; ++c) column_hashes_[std::size_t(c)] = HashOn(level_hash, first_column_ + c);
  const std::size_t seeds = std::size_t(kSlots) * columns_;
  in_cell_.resize(seeds);
  candidates_.resize(seeds);
  variations_.resize(input.variety_degrees > 0.0 ? seeds : 0);
  spread_ = level <= kMaxSpreadLevel ? std::size_t(columns_) << level : 0;
  spread_x_.resize(kSlots * spread_);
  spread_y_.resize(kSlots * spread_);
}

template <class Visit>
void TileSeeds::ForEachColumn(std::uint64_t parts, const Visit& visit) const {
  for (; parts != 0; parts &= parts - 1) {
    const int begin = std::countr_zero(parts) << part_, end = std::min(columns_, begin + (1 << part_));
    for (int c = begin; c < end; ++c) visit(c);
  }
}

void TileSeeds::MakeCandidates(int cell_row, std::uint64_t parts) {
  TileCandidate* const candidates = candidates_.data() + std::size_t(Slot(cell_row)) * columns_;
  ForEachColumn(parts, [&](int c) { candidates[c].state = TileCandidate::kUnknown; });
}

void TileSeeds::MakePlaces(int cell_row, std::uint64_t parts) {
  const int slot = Slot(cell_row);
  PixelPosition* const in_cell = in_cell_.data() + std::size_t(slot) * columns_;
  std::uint16_t *const x = spread_x_.data() + slot * spread_, *const y = spread_y_.data() + slot * spread_;
  ForEachColumn(parts, [&](int c) {
    in_cell[c] = SeedInCell(input_->seeds, level_, column_hashes_[std::size_t(c)], cell_row);
    if (spread_ == 0) return;
    Spread(x + (std::size_t(c) << level_), level_, static_cast<std::uint16_t>((c << level_) + in_cell[c].x));
    Spread(y + (std::size_t(c) << level_), level_, static_cast<std::uint16_t>(in_cell[c].y));
  });
}

void TileSeeds::Fill(int index, TileCandidate& candidate) {
  candidate.state = TileCandidate::kNone;
  const PixelPosition q = Position(index);
  if (q.x < 0 || q.y < 0 || q.x >= input_->guides.width() || q.y >= input_->guides.height()) return;
  const std::size_t i = input_->guides.Index(q.x, q.y);
  if (!input_->Paints(i)) return;
  PixelGuide guide;
  guide.normal = input_->exemplar.WithinRim({normal_[0][i], normal_[1][i], normal_[2][i]});
  guide.light = input_->LuminanceAt(i);
  internal::Candidate own = OwnCandidate(*input_, guide);
  candidate.can_vary = false;
  if (!variations_.empty()) {
    const int column = index % columns_;
    const std::uint64_t hash = Hash(input_->seeds.seed, input_->seeds.time_step, level_ + input_->seeds.level_offset,
                                    first_column_ + column, filled_.row[index / columns_], 0x7a);
    SeedCandidate made = SeedOf(*input_, guide, own);
    if (VarySource(*input_, level_, q, hash, made)) {
      candidate.can_vary = true;
      variations_[static_cast<std::size_t>(index)] = {made.guide_offset, WantedTone(*input_, own, level_)};
      own = made.candidate;
    }
  }
  candidate.offset_x = own.source.x - q.x, candidate.offset_y = own.source.y - q.y;
  candidate.exemplar = static_cast<std::uint8_t>(own.exemplar);
  candidate.state = TileCandidate::kCandidates;
}

TileSeeds::Two TileSeeds::NearestTwo(int x, int y) const {
  constexpr std::int64_t kFar = std::numeric_limits<std::int64_t>::max();
  const int column = (x - left_) >> level_, row = y >> level_;
  Two found{0, 0, 0};
  std::int64_t nearest = kFar, second = kFar;
  for (int dr = -1; dr <= 1; ++dr) {
    const std::int64_t top = std::int64_t(row + dr) << level_;
    for (int dc = -1; dc <= 1; ++dc) {
      const int index = FirstOf(row + dr) + column + dc;
      const PixelPosition in_cell = in_cell_[static_cast<std::size_t>(index)];
      const std::int64_t ex = left_ + ((column + dc) << level_) + in_cell.x - x, ey = top + in_cell.y - y;
      const std::int64_t distance = ex * ex + ey * ey;
      if (distance < nearest) {
        second = nearest, found.second = found.nearest;
        nearest = distance, found.nearest = index;
      } else if (distance < second) {
        second = distance, found.second = index;
      }
    }
  }
  found.excess = second - nearest;
  return found;
}

TileSeeds::Run TileSeeds::RunFrom(int x, int y) const {
  const int column = (x - left_) >> level_, row = y >> level_;
  const int cell_x = left_ + (column << level_);
  const std::int64_t at = x - cell_x;
  // By candidate in row order: x from the cell's left, and its squared distance without the part x².
  std::int64_t place[9], constant[9];
  int best = 0;
  std::int64_t best_distance = std::numeric_limits<std::int64_t>::max();
  for (int k = 0; k < 9; ++k) {
    const int dr = k / 3 - 1, dc = k % 3 - 1;
    const PixelPosition in_cell = in_cell_[static_cast<std::size_t>(FirstOf(row + dr) + column + dc)];
    const std::int64_t ey = (std::int64_t(row + dr) << level_) + in_cell.y - y;
    place[k] = (std::int64_t(dc) << level_) + in_cell.x;
    constant[k] = place[k] * place[k] + ey * ey;
    const std::int64_t distance = constant[k] - 2 * place[k] * at;
    if (distance < best_distance) best_distance = distance, best = k;
  }
  std::int64_t end = std::int64_t(1) << level_;
  for (int k = 0; k < 9; ++k) {
    // Seed k wins where 2·x·step > rise, and at equality too if it comes first in row order.
    const std::int64_t step = place[k] - place[best], rise = constant[k] - constant[best];
    if (step <= 0 || rise >= 2 * step * end) continue;
    end = k < best ? -FloorDivide(-rise, 2 * step) : FloorDivide(rise, 2 * step) + 1;
  }
  const int seed = FirstOf(row + best / 3 - 1) + column + best % 3 - 1;
  return {seed, cell_x + static_cast<int>(end)};
}

}  // namespace scumble::internal
