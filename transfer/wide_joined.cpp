#include "transfer/wide_joined.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/wide_joined.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace scumble::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Wanted pixels are few and scattered: short vectors waste less.
using DF = HWY_CAPPED(float, 8);
using D64 = HWY_CAPPED(std::uint64_t, 8);

// EdgeTest::SameSurface between 64 pixels of a row from column x on and those (dx, dy) further, where `wanted` has
// bits: the bits of those that pass; without kFacing only by depth. What is not covered does not pass.
template <bool kFacing>
HWY_ATTR HWY_INLINE std::uint64_t PassBits(const WideSurface& surface, const EdgeLimits& limits, int x, int y, int dx,
                                           int dy, std::uint64_t wanted) {
  const DF d;
  constexpr int kPlanes = WideSurface::kObject + 1;
  const float *p[kPlanes], *q[kPlanes];
  for (int k = 0; k < (kFacing ? kPlanes : 3); ++k) {
    p[k] = surface.Row(WideSurface::Plane(k), y) + x;
    q[k] = surface.Row(WideSurface::Plane(k), y + dy) + x + dx;
  }
  const auto right = hn::Set(d, static_cast<float>(dx)), down = hn::Set(d, static_cast<float>(dy));
  const auto wide = hn::Abs(right), high = hn::Abs(down);
  std::uint64_t pass = 0;
  constexpr std::uint64_t kAll = ~std::uint64_t{0};
  for (std::uint64_t left = wanted; left;) {
    const int i = std::countr_zero(left);  // vectors begin where they are wanted
    left &= kAll << 1 << (std::min(63, i + static_cast<int>(hn::Lanes(d)) - 1));
    const auto of_p = [&](int k) HWY_ATTR { return hn::LoadU(d, p[k] + i); };
    const auto of_q = [&](int k) HWY_ATTR { return hn::LoadU(d, q[k] + i); };
    const auto px = of_p(WideSurface::kSlopeX), qx = of_q(WideSurface::kSlopeX);
    const auto py = of_p(WideSurface::kSlopeY), qy = of_q(WideSurface::kSlopeY);
    const auto near = of_p(WideSurface::kDepth), far = of_q(WideSurface::kDepth);
    const auto along = hn::Add(hn::Mul(hn::Add(px, qx), right), hn::Mul(hn::Add(py, qy), down));
    const auto expected = hn::Mul(hn::Set(d, 0.5f), along);
    const auto leeway =
        hn::Add(hn::Mul(hn::Min(hn::Abs(px), hn::Abs(qx)), wide), hn::Mul(hn::Min(hn::Abs(py), hn::Abs(qy)), high));
    const auto tolerance = hn::Add(leeway, hn::Mul(hn::Set(d, limits.depth_tolerance), hn::Min(near, far)));
    auto same = hn::Le(hn::Abs(hn::Sub(hn::Sub(far, near), expected)), tolerance);
    if constexpr (kFacing) {
      auto cosine = hn::Mul(of_p(WideSurface::kNormalX), of_q(WideSurface::kNormalX));
      cosine = hn::Add(cosine, hn::Mul(of_p(WideSurface::kNormalY), of_q(WideSurface::kNormalY)));
      cosine = hn::Add(cosine, hn::Mul(of_p(WideSurface::kNormalZ), of_q(WideSurface::kNormalZ)));
      same = hn::And(same, hn::Gt(cosine, hn::Set(d, limits.crease_cosine)));
      same = hn::And(same, hn::Eq(of_p(WideSurface::kObject), of_q(WideSurface::kObject)));
    }
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, same, bytes);
    pass |= std::uint64_t{bytes[0]} << i;
  }
  return pass;
}

HWY_ATTR std::uint64_t PassWord(const WideSurface& surface, const EdgeLimits& limits, int x, int y, int dx, int dy,
                                std::uint64_t wanted) {
  return PassBits<true>(surface, limits, x, y, dx, dy, wanted);
}

// Which active pixels of eight rows lack the vote of the active pixel (dx, dy) further. Returns whether any does.
HWY_ATTR bool FindLacking(const JoinedRows& rows, int dx, int dy, std::uint64_t* lacking) {
  const D64 d;
  HWY_ALIGN std::uint64_t seen[8];
  const int radius = rows.surface.radius();
  const std::uint64_t* reached =
      rows.reached ? rows.reached + 8 * std::size_t((dy + radius) * (2 * radius + 1) + dx + radius) : nullptr;
  rows.votes.Read8(rows.first + dy, dx, seen);
  std::uint64_t any = 0, all = 0;
  if (reached) {
    auto lost = hn::Zero(d), left = hn::Zero(d);
    for (std::size_t k = 0; k < 8; k += hn::Lanes(d)) {
      const auto votes = hn::And(hn::Load(d, seen + k), hn::LoadU(d, rows.active + k)), way = hn::LoadU(d, reached + k);
      const auto lack = hn::AndNot(way, votes), see = hn::And(way, votes);
      hn::StoreU(lack, d, lacking + k), hn::Store(see, d, seen + k);
      lost = hn::Or(lost, lack), left = hn::Or(left, see);
    }
    any = !hn::AllFalse(d, hn::Ne(lost, hn::Zero(d))), all = !hn::AllFalse(d, hn::Ne(left, hn::Zero(d)));
  } else {
    for (int k = 0; k < 8; ++k) lacking[k] = 0, all |= seen[k] &= rows.active[k];
  }
  if (!rows.unsure || !all) return any != 0;
  const std::uint8_t* doubtful =
      rows.doubtful + ((dy >> 2) + rows.quarters) * (2 * rows.quarters + 1) + (dx >> 2) + rows.quarters;
  if (!(doubtful[0] | doubtful[1] | doubtful[2 * rows.quarters + 1] | doubtful[2 * rows.quarters + 2])) return any != 0;
  // Pixels of a quarter see the quarter that is a whole number of quarters further, or the next.
  const std::size_t side = 2 * std::size_t(rows.quarters) + 1;
  const std::uint64_t near = 0x1111111111111111u * (0xfu >> (dx & 3));
  const std::uint64_t* unsure =
      rows.unsure + 2 * ((std::size_t((dy >> 2) + rows.quarters)) * side + std::size_t((dx >> 2) + rows.quarters));
  for (int half = 0; half < 2; ++half, unsure += 2 * side * side) {
    // Rows of a quarter see the quarters of two rows.
    const auto words = [&](const std::uint64_t* of, int cause) { return (of[cause] & near) | (of[2 + cause] & ~near); };
    const std::uint64_t* lower = unsure + 2 * side;
    const std::uint64_t depths[] = {words(unsure, 0), words(lower, 0)}, facings[] = {words(unsure, 1), words(lower, 1)};
    if (!(depths[0] | depths[1] | facings[0] | facings[1])) continue;
    for (int k = 4 * half; k < 4 * half + 4; ++k) {
      const int next = ((k & 3) + (dy & 3)) >> 2;
      const std::uint64_t facing = seen[k] & facings[next], wanted = (seen[k] & depths[next]) | facing;
      if (!wanted) continue;
      const int y = rows.first + k;
      const std::uint64_t pass = facing ? PassBits<true>(rows.surface, rows.limits, 0, y, dx, dy, wanted)
                                        : PassBits<false>(rows.surface, rows.limits, 0, y, dx, dy, wanted);
      any |= lacking[k] |= wanted & ~pass;
    }
  }
  return any != 0;
}

// For eight rows from `row` on: reached[8 · pixel of the window] becomes the bits of the pixels to which every step on
// the way from that pixel passes.
HWY_ATTR void ReachWindow(const WideWays& ways, const BitPlane* steps, int row, std::uint64_t* reached) {
  const std::uint32_t middle = 2u * ways.radius() * (ways.radius() + 1);
  std::fill_n(reached + 8 * std::size_t(middle), 8, ~std::uint64_t{0});
  for (const WideWays::Way& way : ways.ways()) {
    std::uint64_t step[8];
    steps[way.step].Read8(row + way.holder_dy, way.holder_dx, step);
    const std::uint64_t* before = reached + 8 * std::size_t(way.before);
    std::uint64_t* here = reached + 8 * std::size_t(way.self);
    for (int k = 0; k < 8; ++k) here[k] = before[k] & step[k];
  }
}

}  // namespace scumble::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(PassWord);
HWY_EXPORT(FindLacking);
HWY_EXPORT(ReachWindow);

namespace {

constexpr int kStepX[] = {1, -1, 0, 1}, kStepY[] = {0, 1, 1, 1};
constexpr int kCell = WideSurface::kCell, kCells = WideSurface::kCells;

// The side of a way after n - 1 of its n steps: the row or column nearest to the line, halves away from the middle.
int OneBefore(int side, int n) {
  const int length = (2 * std::abs(side) * (n - 1) + n) / (2 * n);
  return side < 0 ? -length : length;
}

int StepOf(int dx, int dy) {
  int k = 0;
  while (kStepX[k] != dx || kStepY[k] != dy) ++k;
  return k;
}

}  // namespace

WideWays::WideWays(int radius) : radius_(radius) {
  const int side = 2 * radius + 1;
  const auto place = [&](int dx, int dy) { return static_cast<std::uint32_t>((dy + radius) * side + dx + radius); };
  for (int n = 1; n <= radius; ++n) {
    for (int dy = -n; dy <= n; ++dy) {
      const int stride = std::abs(dy) == n ? 1 : 2 * n;
      for (int dx = -n; dx <= n; dx += stride) {
        const int x = OneBefore(dx, n), y = OneBefore(dy, n);
        // A step back is kept where it ends.
        const bool back = dy < y || (dy == y && dx < x);
        const int step = back ? StepOf(x - dx, y - dy) : StepOf(dx - x, dy - y);
        ways_.push_back({static_cast<std::int16_t>(dx), static_cast<std::int16_t>(dy), place(dx, dy), place(x, y),
                         static_cast<std::int16_t>(back ? dx : x), static_cast<std::int16_t>(back ? dy : y),
                         static_cast<std::uint8_t>(step)});
      }
    }
  }
}

bool WideJoined::MarkDoubts(const WideSurface& surface, const EdgeLimits& limits) {
  unsigned all = 0;
  const int reach = surface.reach(), cells = kCells + 2 * reach;
  doubts_.assign(std::size_t(cells) * cells, 0);
  for (int row = 0; row < cells; ++row) {
    for (int column = 0; column < cells; ++column) {
      unsigned bits = surface.Doubts(limits, column - reach, row - reach, 0, 0);
      for (int k = 0; k < 4; ++k) {
        const int x = column + kStepX[k], y = row + kStepY[k];
        if (x < 0 || x >= cells || y >= cells) continue;
        bits |= surface.Doubts(limits, column - reach, row - reach, kStepX[k], kStepY[k]) << 2 * (k + 1);
      }
      doubts_[std::size_t(row) * cells + column] = static_cast<std::uint16_t>(bits);
      all |= bits;
    }
  }
  return all != 0;
}

// As the surface says it; for neighbours it is known.
unsigned WideJoined::Doubts(const WideSurface& surface, const EdgeLimits& limits, int column, int row, int dx,
                            int dy) const {
  if (std::abs(dx) > 1 || std::abs(dy) > 1) return surface.Doubts(limits, column, row, dx, dy);
  const int reach = surface.reach(), cells = kCells + 2 * reach;
  const bool back = dy < 0 || (dy == 0 && dx < 0);
  const int x = back ? column + dx : column, y = back ? row + dy : row;
  const int which = dx == 0 && dy == 0 ? 0 : 1 + (back ? StepOf(-dx, -dy) : StepOf(dx, dy));
  return doubts_[std::size_t(y + reach) * cells + (x + reach)] >> 2 * which & 3;
}

// For a row of cells: whether any pixel of the window may fail. Where a cell leaves doubts its quarters are asked.
bool WideJoined::MarkUnsure(WideSurface& surface, const EdgeLimits& limits, int cell_row, std::uint64_t active) {
  const int reach = surface.reach(), quarters = 2 * reach + 1, side = 2 * quarters + 1;
  unsure_.assign(std::size_t(4) * side * side + 2 * side + 4, 0);
  doubtful_.assign(std::size_t(side) * (side + 1) + 1, 0);
  bool any = false;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      for (int column = 0; column < kCells; ++column) {
        if (!(active >> (kCell * column) & 0xff) || !Doubts(surface, limits, column, cell_row, dx, dy)) continue;
        for (int k = 0; k < 16; ++k) {
          const int px = k & 1, py = k >> 1 & 1, x = 2 * dx + (k >> 2 & 1) - px, y = 2 * dy + (k >> 3) - py;
          const unsigned doubts = surface.QuarterDoubts(limits, 2 * column + px, 2 * cell_row + py, x, y);
          if (!doubts) continue;
          any = true;
          doubtful_[std::size_t((y + quarters) * side + x + quarters)] = 1;
          const std::uint64_t bits = std::uint64_t{0xf} << (kCell * column + WideSurface::kQuarter * px);
          std::uint64_t* unsure =
              unsure_.data() + 2 * (std::size_t(py * side + y + quarters) * side + std::size_t(x + quarters));
          if (doubts & WideSurface::kDepthDoubt) unsure[0] |= bits;
          if (doubts & WideSurface::kFacingDoubt) unsure[1] |= bits;
        }
      }
    }
  }
  return any;
}

// Forward steps of every pixel of the tile and around it; columns and rows beyond the radius do not matter.
void WideJoined::MarkSteps(const WideSurface& surface, const EdgeLimits& limits) {
  const int margin = surface.margin(), radius = surface.radius(), cells = kCells + 2 * surface.reach();
  for (BitPlane& plane : steps_) plane.Reset(margin);
  blocked_.assign(std::size_t(kTileSide + 2 * margin), 0);
  for (int y = -radius; y < kTileSide + radius; ++y) {
    const std::uint16_t* doubts = doubts_.data() + std::size_t((y + margin) / kCell) * cells;
    for (int x = -margin; x < kTileSide + margin; x += 64) {
      std::uint64_t doubtful = 0;
      for (int k = 0; k < kCells && (x + margin) / kCell + k < cells; ++k) {
        const int cell = (x + margin) / kCell + k;
        // A step down left may end in the cell to the left, whose pair with this one is kept there.
        const bool left = cell > 0 && (doubts[cell - 1] >> 2 & 3) != 0;
        if (doubts[cell] || left) doubtful |= std::uint64_t{0xff} << (kCell * k);
      }
      const std::uint64_t here = surface.covered().Read(y, x);
      for (int k = 0; k < 4; ++k) {
        // Steps out of the surroundings are refused, but nobody takes them.
        const int begin = std::max(-radius, -radius - kStepX[k]), end = kTileSide + radius - std::max(0, kStepX[k]);
        const std::uint64_t inner = BitsBetween(begin - x, end - x);
        if (inner == 0 || y + kStepY[k] >= kTileSide + radius) continue;
        std::uint64_t bits = here & surface.covered().Read(y + kStepY[k], x + kStepX[k]) & inner;
        if (const std::uint64_t wanted = bits & doubtful) {
          bits &= ~wanted | HWY_DYNAMIC_DISPATCH(PassWord)(surface, limits, x, y, kStepX[k], kStepY[k], wanted);
        }
        if (bits != inner) blocked_[std::size_t(y + margin)] = 1;
        steps_[k].Put(y, x, bits);
      }
    }
  }
}

void WideJoined::MarkPixels(const WideTile& tile, int margin) {
  votes_.Reset(margin), changes_.Reset(margin);
  const Region &area = tile.area(), &surround = tile.surround();
  const int left = surround.x0 - area.x0, width = surround.x1 - surround.x0;
  for (int y = surround.y0; y < surround.y1; ++y) {
    for (int word = 0; 64 * word < width; ++word) {
      votes_.Put(y - area.y0, left + 64 * word, tile.Votes(y - surround.y0)[word]);
      changes_.Put(y - area.y0, left + 64 * word, tile.Changes(y - surround.y0)[word]);
    }
  }
}

void WideJoined::Withdraw(const VoteInput& input, const WideWays& ways, const WideTile& tile, WideSurface& surface,
                          const EdgeLimits& limits, WideSums& sums) {
  const bool sure = !MarkDoubts(surface, limits);
  if (sure && surface.all_covered()) {
    if (surface.reach() == 1) return;
    blocked_.assign(std::size_t(kTileSide + 2 * surface.margin()), 0);
  } else {
    MarkSteps(surface, limits);
  }
  MarkPixels(tile, surface.margin());
  for (int row = 0; row < tile.area().y1 - tile.area().y0; row += kCell) {
    WithdrawRows(input, ways, tile, surface, limits, row, sums);
  }
}

namespace {

// Votes of one row of pixels that are taken back together: those of one chunk, side by side, for the same pixel.
struct Missing {
  std::uint64_t bits = 0;                 // of pixels that lack the vote that was looked at last
  std::int16_t since[kTileSide];          // by pixel, the first of those that are taken back with it
  const std::uint16_t* texel[kTileSide];  // what they are for; null where it is not usable
};

}  // namespace

void WideJoined::WithdrawRows(const VoteInput& input, const WideWays& ways, const WideTile& tile, WideSurface& surface,
                              const EdgeLimits& limits, int first_row, WideSums& sums) {
  const int radius = surface.radius(), margin = surface.margin(), side = 2 * radius + 1;
  JoinedRows rows{surface, limits, votes_, first_row, {}, nullptr, nullptr, nullptr, 2 * surface.reach() + 1};
  std::uint64_t any = 0;
  for (int k = 0; k < std::min(kCell, tile.area().y1 - tile.area().y0 - first_row); ++k) {
    any |= rows.active[k] = tile.ActiveWord(first_row + k);
  }
  if (!any) return;
  const auto* blocked = blocked_.data() + (first_row + margin);
  const bool open = std::none_of(blocked - radius, blocked + kCell + radius, [](std::uint8_t row) { return row != 0; });
  if (MarkUnsure(surface, limits, first_row / kCell, any)) {
    rows.unsure = unsure_.data(), rows.doubtful = doubtful_.data();
  }
  if (open && !rows.unsure) return;
  if (!open) {
    reached_.resize(8 * std::size_t(side) * side);
    HWY_DYNAMIC_DISPATCH(ReachWindow)(ways, steps_, first_row, reached_.data());
    rows.reached = reached_.data();
  }

  const SourceField& field = input.field;
  Missing missing[8];
  // All votes of a chunk for a pixel are for one texel.
  const auto begin = [&](int k, std::uint64_t bits, int dx, int dy) {
    for (; bits; bits &= bits - 1) {
      const int x = std::countr_zero(bits);
      const std::size_t q = field.Index(tile.area().x0 + x + dx, tile.area().y0 + first_row + k + dy);
      const Source source{field.x[q] - dx, field.y[q] - dy};
      missing[k].since[x] = static_cast<std::int16_t>(dx), missing[k].texel[x] = nullptr;
      if (!input.exemplar.Usable(source.x, source.y)) continue;
      missing[k].texel[x] = input.exemplar.picture(field.exemplar[q]).At(source.x, source.y);
      hwy::Prefetch(missing[k].texel[x]);
    }
  };
  const auto take_back = [&](int k, std::uint64_t bits, int dx) {
    for (; bits; bits &= bits - 1) {
      const int x = std::countr_zero(bits);
      const std::uint16_t* texel = missing[k].texel[x];
      if (texel) sums.Withdraw(x, first_row + k, texel, static_cast<std::uint32_t>(dx - missing[k].since[x]));
    }
  };
  const auto find = HWY_DYNAMIC_DISPATCH(FindLacking);
  for (int dy = -radius; dy <= radius; ++dy) {
    bool lacked = false;
    for (int dx = -radius; dx <= radius + 1; ++dx) {
      std::uint64_t lacking[8] = {};
      const bool lacks = dx <= radius && (dx != 0 || dy != 0) && find(rows, dx, dy, lacking);
      if (!lacks && !lacked) continue;
      lacked = lacks;
      for (int k = 0; k < 8; ++k) {
        const std::uint64_t before = missing[k].bits;
        if (!(before | lacking[k])) continue;
        const std::uint64_t on = before & lacking[k] & ~changes_.Read(first_row + k + dy, dx);
        take_back(k, before & ~on, dx);
        begin(k, lacking[k] & ~on, dx, dy);
        missing[k].bits = lacking[k];
      }
    }
  }
}

}  // namespace scumble::internal
#endif
