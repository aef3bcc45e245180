#include "transfer/vote/wide/edge_culling.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/vote/wide/edge_culling.cpp"
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
    const auto give = hn::Add(hn::Set(d, limits.give.fixed), hn::Mul(hn::Set(d, limits.give.share), hn::Min(near, far)));
    const auto tolerance = hn::Add(leeway, give);
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
      rows.doubtful + ((dy >> 2) + rows.reach) * (2 * rows.reach + 1) + (dx >> 2) + rows.reach;
  if (!(doubtful[0] | doubtful[1] | doubtful[2 * rows.reach + 1] | doubtful[2 * rows.reach + 2])) return any != 0;
  // Pixels of a cell see the cell that is a whole number of cells further, or the next.
  const std::size_t side = 2 * std::size_t(rows.reach) + 1;
  const std::uint64_t near = 0x1111111111111111u * (0xfu >> (dx & 3));
  const std::uint64_t* unsure =
      rows.unsure + 2 * (std::size_t((dy >> 2) + rows.reach) * side + std::size_t((dx >> 2) + rows.reach));
  for (int half = 0; half < 2; ++half, unsure += 2 * side * side) {
    // Rows of a cell see the cells of two rows.
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
constexpr int kBand = WideSurface::kBand, kSide = WideCells::kSide, kAcross = WideCells::kAcross;

// The side of a way after n - 1 of its n steps: the row or column nearest to the line, halves away from the middle.
int OneBefore(int side, int n) {
  const int length = (2 * std::abs(side) * (n - 1) + n) / (2 * n);
  return side < 0 ? -length : length;
}

// Each of 16 bits four times.
std::uint64_t PixelsOf(std::uint32_t cells) {
  std::uint64_t bits = cells;
  bits = (bits | bits << 24) & 0x000000ff000000ff;
  bits = (bits | bits << 12) & 0x000f000f000f000f;
  bits = (bits | bits << 6) & 0x0303030303030303;
  bits = (bits | bits << 3) & 0x1111111111111111;
  return bits * 0xf;
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

// Whether there are any. A step's two pixels are of one cell, or of cells side by side.
bool WideJoined::MarkStepDoubts(const WideSurface& surface, const EdgeLimits& limits) {
  const int margin = surface.margin() / kSide, across = kAcross + 2 * margin;
  const int words = (across + kAcross - 1) / kAcross;
  constexpr struct { int dx, dy; } kPairs[] = {{0, 0}, {-1, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}};
  step_doubts_.assign(std::size_t(words) * across, 0);
  std::uint64_t any = 0;
  for (int row = 0; row < across; ++row) {
    for (int word = 0; word < words; ++word) {
      std::uint32_t doubts = 0;
      for (const auto& pair : kPairs) {
        const WideCells::Bits bits = cells_.Doubts(limits, kAcross * word - margin, row - margin, pair.dx, pair.dy);
        doubts |= bits.depth | bits.facing;
      }
      any |= step_doubts_[std::size_t(row) * words + word] = PixelsOf(doubts);
    }
  }
  return any != 0;
}

// For eight rows: whether any pixel of the window may fail.
bool WideJoined::MarkUnsure(int radius, const EdgeLimits& limits, int first_row, std::uint64_t active) {
  const int reach = (radius + kSide - 1) / kSide, side = 2 * reach + 1;
  unsure_.assign(std::size_t(4) * side * side + 2 * side + 4, 0);
  doubtful_.assign(std::size_t(side) * (side + 1) + 1, 0);
  bool any = false;
  std::uint64_t* unsure = unsure_.data();
  for (int half = 0; half < 2; ++half) {
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx, unsure += 2) {
        const WideCells::Bits bits = cells_.Doubts(limits, 0, first_row / kSide + half, dx, dy);
        if (!(bits.depth | bits.facing)) continue;
        unsure[0] = PixelsOf(bits.depth) & active, unsure[1] = PixelsOf(bits.facing) & active;
        if (!(unsure[0] | unsure[1])) continue;
        any = true;
        doubtful_[std::size_t((dy + reach) * side + dx + reach)] = 1;
      }
    }
  }
  return any;
}

// Forward steps of every pixel of the tile and around it; columns and rows beyond the radius do not matter.
void WideJoined::MarkSteps(const WideSurface& surface, const EdgeLimits& limits) {
  const int margin = surface.margin(), radius = surface.radius();
  const int words = (kTileSide + 2 * margin + 63) / 64;
  for (BitPlane& plane : steps_) plane.Reset(margin);
  blocked_.assign(std::size_t(kTileSide + 2 * margin), 0);
  for (int y = -radius; y < kTileSide + radius; ++y) {
    const std::uint64_t* doubts = step_doubts_.data() + std::size_t((y + margin) / kSide) * words;
    for (int x = -margin; x < kTileSide + margin; x += 64) {
      const std::uint64_t doubtful = doubts[(x + margin) / 64];
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

void WideJoined::Withdraw(const VoteInput& input, const WideWays& ways, const WideTile& tile,
                          const WideSurface& surface, const EdgeLimits& limits, WideSums& sums) {
  cells_.Read(surface, limits);
  if (MarkStepDoubts(surface, limits) || !surface.all_covered())
    MarkSteps(surface, limits);
  else
    blocked_.assign(std::size_t(kTileSide + 2 * surface.margin()), 0);
  MarkPixels(tile, surface.margin());
  for (int row = 0; row < tile.area().y1 - tile.area().y0; row += kBand) {
    WithdrawRows(input, ways, tile, surface, limits, row, sums);
  }
}

void WideJoined::WithdrawRows(const VoteInput& input, const WideWays& ways, const WideTile& tile,
                              const WideSurface& surface, const EdgeLimits& limits, int first_row, WideSums& sums) {
  const int radius = surface.radius(), margin = surface.margin(), side = 2 * radius + 1;
  JoinedRows rows{surface, limits, votes_, first_row, {}, nullptr, nullptr, nullptr, (radius + kSide - 1) / kSide};
  std::uint64_t any = 0;
  for (int k = 0; k < std::min(kBand, tile.area().y1 - tile.area().y0 - first_row); ++k) {
    any |= rows.active[k] = tile.ActiveWord(first_row + k);
  }
  if (!any) return;
  const auto* blocked = blocked_.data() + (first_row + margin);
  const bool open = std::none_of(blocked - radius, blocked + kBand + radius, [](std::uint8_t row) { return row != 0; });
  if (MarkUnsure(radius, limits, first_row, any)) {
    rows.unsure = unsure_.data(), rows.doubtful = doubtful_.data();
  }
  if (open && !rows.unsure) return;
  if (!open) {
    reached_.resize(8 * std::size_t(side) * side);
    HWY_DYNAMIC_DISPATCH(ReachWindow)(ways, steps_, first_row, reached_.data());
    rows.reached = reached_.data();
  }

  const auto find = HWY_DYNAMIC_DISPATCH(FindLacking);
  for (int dy = -radius; dy <= radius; ++dy) {
    // By row: pixels that lack the vote that was looked at last, and the first of those that are taken back with it.
    std::uint64_t before[8] = {};
    std::int16_t since[8][kTileSide + 1];
    bool lacked = false;
    for (int dx = -radius; dx <= radius + 1; ++dx) {
      std::uint64_t lacking[8] = {};
      const bool lacks = dx <= radius && (dx != 0 || dy != 0) && find(rows, dx, dy, lacking);
      if (!lacks && !lacked) continue;
      lacked = lacks;
      for (int k = 0; k < 8; ++k) {
        if (!(before[k] | lacking[k])) continue;
        const std::uint64_t on = before[k] & lacking[k] & ~changes_.Read(first_row + k + dy, dx);
        withdrawals_.End(before[k] & ~on,
                         {static_cast<std::int16_t>(first_row + k), static_cast<std::int16_t>(dx - 1),
                          static_cast<std::int16_t>(dy)},
                         since[k]);
        ForEachBit(lacking[k] & ~on, [&](int x) { since[k][x] = static_cast<std::int16_t>(dx); });
        before[k] = lacking[k];
      }
    }
  }
  withdrawals_.Apply(input, tile, sums);
}

}  // namespace scumble::internal
#endif
