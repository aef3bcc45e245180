#include "transfer/vote/wide/wide_arms.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "transfer/vote/chunk_masks.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/vote/wide/wide_arms.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "transfer/vote/mask_lanes-inl.h"

#ifndef SCUMBLE_WIDE_ARMS_ONCE
#define SCUMBLE_WIDE_ARMS_ONCE
namespace scumble::internal {

struct NormalPlanes {
  const float* normal[3];
  const std::uint8_t* active;
  std::size_t size;  // values of each that may be read
  std::size_t width;
};

}  // namespace scumble::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace scumble::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Bounds over `rows` rows of 16 columns, from pixel p on. Where the picture ends within the columns, the beginning of
// the next row counts as well. A NaN normal is on no arm, so it does not count.
void BoundCell(const NormalPlanes& planes, std::size_t p, int rows, NormalBounds& bounds) {
  constexpr float kMost = std::numeric_limits<float>::infinity();
  bounds = {{kMost, kMost, kMost}, {-kMost, -kMost, -kMost}, kMost};
  const std::size_t lanes = hn::Lanes(kFloat);
  const hn::Rebind<std::uint8_t, decltype(kFloat)> byte;
  const hn::RebindToUnsigned<decltype(kFloat)> word;
  const F most = hn::Set(kFloat, kMost), least = hn::Neg(most);
  F low[3] = {most, most, most}, high[3] = {least, least, least}, squared = most;
  for (; rows > 0; --rows, p += planes.width) {
    if (p + 16 > planes.size) {
      for (std::size_t q = p; q < planes.size; ++q) {
        const float n[3] = {planes.normal[0][q], planes.normal[1][q], planes.normal[2][q]};
        const float length = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        if (!planes.active[q] || length != length) continue;
        for (int c = 0; c < 3; ++c) {
          bounds.low[c] = std::min(bounds.low[c], n[c]), bounds.high[c] = std::max(bounds.high[c], n[c]);
        }
        bounds.least_squared = std::min(bounds.least_squared, length);
      }
      continue;
    }
    for (std::size_t q = p; q < p + 16; q += lanes) {
      const F n[3] = {hn::LoadU(kFloat, planes.normal[0] + q), hn::LoadU(kFloat, planes.normal[1] + q),
                      hn::LoadU(kFloat, planes.normal[2] + q)};
      const F length = hn::Add(hn::Add(hn::Mul(n[0], n[0]), hn::Mul(n[1], n[1])), hn::Mul(n[2], n[2]));
      const auto active = hn::Ne(hn::PromoteTo(word, hn::LoadU(byte, planes.active + q)), hn::Zero(word));
      const auto counts = hn::And(hn::RebindMask(kFloat, active), hn::Eq(length, length));
      for (int c = 0; c < 3; ++c) {
        low[c] = hn::Min(low[c], hn::IfThenElse(counts, n[c], most));
        high[c] = hn::Max(high[c], hn::IfThenElse(counts, n[c], least));
      }
      squared = hn::Min(squared, hn::IfThenElse(counts, length, most));
    }
  }
  for (int c = 0; c < 3; ++c) {
    bounds.low[c] = std::min(bounds.low[c], hn::GetLane(hn::MinOfLanes(kFloat, low[c])));
    bounds.high[c] = std::max(bounds.high[c], hn::GetLane(hn::MaxOfLanes(kFloat, high[c])));
  }
  bounds.least_squared = std::min(bounds.least_squared, hn::GetLane(hn::MinOfLanes(kFloat, squared)));
}

// The marked pixels, bit 0 at `first`, whose normal is less than the crease from the one `step` values farther on.
std::uint64_t AlikeBits(const NormalPlanes& planes, std::ptrdiff_t first, std::ptrdiff_t step, float crease_cosine,
                        std::uint64_t marked) {
  const int lanes = static_cast<int>(hn::Lanes(kFloat));
  const F crease = hn::Set(kFloat, crease_cosine);
  std::uint64_t alike = 0;
  for (std::uint64_t left = marked; left;) {
    const int i = std::countr_zero(left);  // vectors begin where they are wanted
    const std::size_t p = static_cast<std::size_t>(first + i), q = p + static_cast<std::size_t>(step);
    const auto& n = planes.normal;
    if (q + std::size_t(lanes) > planes.size) {
      const float cosine = n[0][p] * n[0][q] + n[1][p] * n[1][q] + n[2][p] * n[2][q];
      alike |= std::uint64_t{cosine > crease_cosine} << i;
      left &= left - 1;
      continue;
    }
    const auto product = [&](int c)
                             HWY_ATTR { return hn::Mul(hn::LoadU(kFloat, n[c] + p), hn::LoadU(kFloat, n[c] + q)); };
    const F cosine = hn::Add(hn::Add(product(0), product(1)), product(2));
    alike |= BitsOf(hn::Gt(cosine, crease)) << i;
    left &= BitMaskRows::kAll << 1 << std::min(63, i + lanes - 1);
  }
  return alike & marked;
}

}  // namespace scumble::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(BoundCell);
HWY_EXPORT(AlikeBits);

namespace {

void Widen(NormalBounds& bounds, const NormalBounds& more) {
  for (int c = 0; c < 3; ++c) {
    bounds.low[c] = std::min(bounds.low[c], more.low[c]), bounds.high[c] = std::max(bounds.high[c], more.high[c]);
  }
  bounds.least_squared = std::min(bounds.least_squared, more.least_squared);
}

// Whether two normals within the bounds may be the crease or more apart: 2 a·b = |a|² + |b|² - |a - b|². Components
// below 4 have products that are rounded by less than the margin.
bool MayTurn(const NormalBounds& bounds, float crease_cosine) {
  float ranges = 0.0f;
  for (int c = 0; c < 3; ++c) {
    if (!(bounds.low[c] > -4.0f && bounds.high[c] < 4.0f)) return true;
    const float range = bounds.high[c] - bounds.low[c];
    ranges += range * range;
  }
  return !(bounds.least_squared - 0.5f * ranges > crease_cosine + 1e-4f);
}

NormalPlanes PlanesOf(const VoteInput& input) {
  const GuideSet& guides = input.edges->guides;
  const auto plane = [&](int c) { return guides.Plane(Layer::kNormal, c).data(); };
  // Only some rows of `active` may be in memory.
  const std::size_t before = std::size_t(input.field.first_row) * std::size_t(guides.width());
  return {{plane(0), plane(1), plane(2)},
          input.active.data() - before,
          std::min(guides.pixel_count(), before + input.active.size()),
          std::size_t(guides.width())};
}

// Calls visit(i) for each set bit.
template <class Visit>
void ForEachBit(std::uint64_t bits, const Visit& visit) {
  for (; bits; bits &= bits - 1) visit(std::countr_zero(bits));
}

}  // namespace

void WideArms::SetWhole(int radius) {
  radius_ = radius;
  ends_.resize(2 * kStride);
  for (int x = 0; x < kStride; ++x) {
    ends_[std::size_t(x)] = static_cast<std::int16_t>(x - radius);
    ends_[std::size_t(kStride + x)] = static_cast<std::int16_t>(x + radius + 1);
  }
  ends_of_row_.assign(std::size_t(kTileSide + 2 * radius), 0);
  std::fill_n(short_, kTileSide, 0);
}

void WideArms::Read(const VoteInput& input, const Region& area) {
  SetWhole(input.radius);
  MarkActiveAndSteps(input, area);
  MarkTurns(input);
  for (int y = seen_.y0; y < seen_.y1; ++y) ReadRow(input, area, y);
  ReadColumns(input, area);
}

void WideArms::MarkActiveAndSteps(const VoteInput& input, const Region& area) {
  const int width = input.field.width, height = input.field.height, r = radius_;
  seen_ = area.GrownBy(r, width, height);
  marked_.first_row = area.y0 - r, marked_.rows = area.y1 - area.y0 + 2 * r;
  marked_.first_word = (area.x0 - r) >> 6;
  marked_.words = ((area.x0 + kTileSide - 1 + r) >> 6) - marked_.first_word + 1;
  MaskActive(input.field, input.active, marked_, active_);
  wanted_.Reset(marked_, 0);
  for (int y = seen_.y0; y < seen_.y1; ++y) {
    for (int w = 0; w < marked_.words; ++w) {
      const int column = 64 * (marked_.first_word + w);
      wanted_.Row(y)[w] = active_.Row(y)[w] & BitRange(seen_.x0 - column, seen_.x1 - column);
    }
  }
  MarkOpenSteps(*input.edges, marked_, active_, wanted_, steps_);
  // Steps out of the reachable part end no arm.
  for (int y = marked_.first_row; y < marked_.first_row + marked_.rows; ++y) {
    for (int w = -1; w <= marked_.words; ++w) {
      const int column = 64 * (marked_.first_word + w);
      steps_.right.Row(y)[w] |= ~BitRange(seen_.x0 - column, seen_.x1 - 1 - column);
      steps_.down.Row(y)[w] |= y >= seen_.y0 && y < seen_.y1 - 1 ? 0 : BitMaskRows::kAll;
    }
  }
}

// Sets bits by cell, from bounds of the cells that an arm from there reaches.
void WideArms::MarkTurns(const VoteInput& input) {
  const int first = seen_.x0 / kCellColumns, across = (seen_.x1 - 1) / kCellColumns + 1 - first;
  const int down = (seen_.y1 - seen_.y0 + kCellRows - 1) / kCellRows;
  const NormalPlanes planes = PlanesOf(input);
  bounds_.resize(std::size_t(across) * std::size_t(down));
  const auto bounds = [&](int column, int row) -> NormalBounds& {
    return bounds_[std::size_t(row) * std::size_t(across) + std::size_t(column)];
  };
  for (int row = 0; row < down; ++row) {
    const int y = seen_.y0 + kCellRows * row, rows = std::min(kCellRows, seen_.y1 - y);
    for (int column = 0; column < across; ++column) {
      HWY_DYNAMIC_DISPATCH(BoundCell)
      (planes, input.edges->guides.Index(kCellColumns * (first + column), y), rows, bounds(column, row));
    }
  }
  const float crease_cosine = input.edges->CreaseCosine();
  const MaskedTile cells{0, down, marked_.first_word, marked_.words};
  turns_right_.Reset(cells, 0), turns_down_.Reset(cells, 0);
  for (int row = 0; row < down; ++row) {
    for (int column = 0; column < across; ++column) {
      NormalBounds right = bounds(column, row), below = right;
      const int last_column = std::min(across - 1, column + (kCellColumns - 1 + radius_) / kCellColumns);
      const int last_row = std::min(down - 1, row + (kCellRows - 1 + radius_) / kCellRows);
      for (int k = column + 1; k <= last_column; ++k) Widen(right, bounds(k, row));
      for (int k = row + 1; k <= last_row; ++k) Widen(below, bounds(column, k));
      const int x = kCellColumns * (first + column);
      const std::uint64_t bits = std::uint64_t{0xffff} << (x & 63);
      if (MayTurn(right, crease_cosine)) turns_right_.At(row, x >> 6) |= bits;
      if (MayTurn(below, crease_cosine)) turns_down_.At(row, x >> 6) |= bits;
    }
  }
}

// Longer arms from shorter ones: two pixels k apart are on one arm if both pairs k - 1 apart between them are, and
// their own normals are less than the crease apart.
void WideArms::ReadRow(const VoteInput& input, const Region& area, int y) {
  const int words = marked_.words, cells = (y - seen_.y0) / kCellRows;
  std::uint64_t* const arm = steps_.right.Row(y);  // bit x: it is on one arm with the pixel k farther right
  std::uint64_t open = BitMaskRows::kAll, turns = 0;
  for (int w = 0; w < words; ++w) open &= arm[w], turns |= turns_right_.Row(cells)[w] & wanted_.Row(y)[w];
  if (open == BitMaskRows::kAll && !turns) return;
  ends_of_row_[std::size_t(y - area.y0 + radius_)] = ends_.size();
  const std::size_t at = ends_.size();
  ends_.resize(at + 2 * kStride);
  std::copy_n(ends_.begin(), 2 * kStride, ends_.begin() + std::ptrdiff_t(at));
  std::int16_t *const low = ends_.data() + at, *const high = low + kStride;
  const NormalPlanes planes = PlanesOf(input);
  const float crease_cosine = input.edges->CreaseCosine();
  const auto row_start = static_cast<std::ptrdiff_t>(input.edges->guides.Index(0, y));
  std::uint64_t left = wanted_.From(y, area.x0), right = left;  // pixels whose arms have not ended
  for (int k = 1; k <= radius_ && (left | right); ++k) {
    for (int w = 0; k > 1 && w < words; ++w) arm[w] &= arm[w] >> 1 | arm[w + 1] << 63;
    for (int w = 0; k > 1 && turns && w < words; ++w) {
      const int word = marked_.first_word + w, further = 64 * word + k;
      const std::uint64_t may = arm[w] & turns_right_.Row(cells)[w] & wanted_.Row(y)[w];
      if (!may || further >= 64 * (marked_.first_word + words)) continue;
      const std::uint64_t both = may & wanted_.From(y, further);
      if (!both) continue;
      const std::uint64_t alike =
          HWY_DYNAMIC_DISPATCH(AlikeBits)(planes, row_start + 64 * word, k, crease_cosine, both);
      arm[w] &= ~both | alike;
    }
    const std::uint64_t to_right = steps_.right.From(y, area.x0), to_left = steps_.right.From(y, area.x0 - k);
    ForEachBit(right & ~to_right, [&](int x) { high[x] = static_cast<std::int16_t>(x + k); });
    ForEachBit(left & ~to_left, [&](int x) { low[x] = static_cast<std::int16_t>(x - k + 1); });
    right &= to_right, left &= to_left;
  }
}

void WideArms::ReadColumns(const VoteInput& input, const Region& area) {
  const int r = radius_, rows = marked_.rows, height = area.y1 - area.y0;
  columns_.resize(std::size_t(rows) * std::size_t(r));
  const auto plane = [&](int k) { return columns_.data() + std::size_t(k - 1) * std::size_t(rows); };
  std::uint64_t open = BitMaskRows::kAll, turns = 0;
  const std::uint64_t beyond = ~BitRange(0, area.x1 - area.x0);
  for (int y = 0; y < rows; ++y) open &= plane(1)[y] = steps_.down.From(marked_.first_row + y, area.x0) | beyond;
  const auto turns_of = [&](int y) {
    if (y < seen_.y0 || y >= seen_.y1) return std::uint64_t{0};
    return turns_down_.From((y - seen_.y0) / kCellRows, area.x0) & active_.From(y, area.x0) & ~beyond;
  };
  for (int y = seen_.y0; y < seen_.y1; ++y) turns |= turns_of(y);
  if (open == BitMaskRows::kAll && !turns) return;
  const NormalPlanes planes = PlanesOf(input);
  const float crease_cosine = input.edges->CreaseCosine();
  for (int k = 2; k <= r; ++k) {
    for (int y = 0; y < rows - k; ++y) {
      std::uint64_t bits = plane(k - 1)[y] & plane(k - 1)[y + 1];
      const int at = marked_.first_row + y;
      if (turns && bits && at + k < seen_.y1) {
        const std::uint64_t both = bits & turns_of(at) & active_.From(at + k, area.x0);
        if (both) {
          const auto first = static_cast<std::ptrdiff_t>(input.edges->guides.Index(area.x0, at));
          const std::ptrdiff_t step = std::ptrdiff_t(k) * std::ptrdiff_t(planes.width);
          bits &= ~both | HWY_DYNAMIC_DISPATCH(AlikeBits)(planes, first, step, crease_cosine, both);
        }
      }
      plane(k)[y] = bits;
    }
  }
  for (int y = 0; y < height; ++y) {
    const std::uint64_t active = active_.From(area.y0 + y, area.x0) & ~beyond;
    std::uint64_t up = active, down = active;
    std::fill_n(up_[y], kTileSide, static_cast<std::uint8_t>(r));
    std::fill_n(down_[y], kTileSide, static_cast<std::uint8_t>(r));
    for (int k = 1; k <= r && (up | down); ++k) {
      const std::uint64_t to_down = plane(k)[y + r], to_up = plane(k)[y + r - k];
      ForEachBit(down & ~to_down, [&](int x) { down_[y][x] = static_cast<std::uint8_t>(k - 1); });
      ForEachBit(up & ~to_up, [&](int x) { up_[y][x] = static_cast<std::uint8_t>(k - 1); });
      down &= to_down, up &= to_up;
    }
    short_[y] = active & ~(up & down);
  }
}

}  // namespace scumble::internal
#endif
