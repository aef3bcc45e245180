#include "transfer/vote/wide/run_masks.h"

#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/vote/wide/run_masks.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace scumble::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D, class M>
HWY_INLINE std::uint64_t Bits(D d, M mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  std::uint64_t word;
  std::memcpy(&word, bytes, 8);
  return word;
}

// The 64 pixels from `at`, which is not the row's first.
HWY_ATTR void MarkBlock(const FieldRow& row, int at, std::uint64_t& votes, std::uint64_t& changes) {
  const HWY_CAPPED(std::int16_t, 32) d16;
  const HWY_CAPPED(std::uint8_t, 64) d8;
  const hn::RebindToSigned<decltype(d8)> s8;
  const auto one = hn::Set(d16, std::int16_t{1});
  const auto full = hn::Set(s8, row.full_level);
  const auto none = hn::Zero(d8);
  std::uint64_t active = 0, before = 0, same = 0, follows = 0;
  for (std::size_t i = 0; i < 64; i += hn::Lanes(d8)) {
    const std::size_t k = std::size_t(at) + i;
    active |= Bits(d8, hn::Ne(hn::LoadU(d8, row.active + k), none)) << i;
    before |= Bits(d8, hn::Ne(hn::LoadU(d8, row.active + k - 1), none)) << i;
    const auto here = hn::Min(hn::LoadU(s8, row.level + k), full),
               last = hn::Min(hn::LoadU(s8, row.level + k - 1), full);
    same |= Bits(d8, hn::And(hn::Eq(hn::LoadU(d8, row.exemplar + k), hn::LoadU(d8, row.exemplar + k - 1)),
                             hn::RebindMask(d8, hn::Eq(here, last))))
            << i;
  }
  for (std::size_t i = 0; i < 64; i += hn::Lanes(d16)) {
    const std::size_t k = std::size_t(at) + i;
    const auto right = hn::Eq(hn::Sub(hn::LoadU(d16, row.x + k), hn::LoadU(d16, row.x + k - 1)), one);
    const auto level = hn::Eq(hn::LoadU(d16, row.y + k), hn::LoadU(d16, row.y + k - 1));
    follows |= Bits(d16, hn::And(right, level)) << i;
  }
  votes = active;
  changes = (active | before) & ~(active & before & same & follows);
}

HWY_ATTR void MarkRunsTarget(const FieldRow& row, std::uint64_t* votes, std::uint64_t* changes) {
  const auto put = [](std::uint64_t* bits, int at, std::uint64_t word) {
    bits[at >> 6] |= word << (at & 63);
    if (at & 63) bits[(at >> 6) + 1] |= word >> (64 - (at & 63));
  };
  if (row.count == 0) return;
  votes[0] |= row.active[0] != 0, changes[0] |= row.active[0] != 0;
  int at = 1;
  if (row.count > 64) {
    // The last block may overlap the one before: its bits are equal there.
    for (; at < row.count; at += 64) {
      const int from = at + 64 <= row.count ? at : row.count - 64;
      std::uint64_t active, change;
      MarkBlock(row, from, active, change);
      put(votes, from, active), put(changes, from, change);
    }
    return;
  }
  for (; at < row.count; ++at) {
    const bool active = row.active[at] != 0, before = row.active[at - 1] != 0;
    const bool same = row.exemplar[at] == row.exemplar[at - 1] &&
                      std::min(row.level[at], row.full_level) == std::min(row.level[at - 1], row.full_level) &&
                      row.y[at] == row.y[at - 1] && static_cast<std::int16_t>(row.x[at] - row.x[at - 1]) == 1;
    if (active) put(votes, at, 1);
    if ((active || before) && !(active && before && same)) put(changes, at, 1);
  }
}

}  // namespace scumble::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(MarkRunsTarget);
void MarkRuns(const FieldRow& row, std::uint64_t* votes, std::uint64_t* changes) {
  HWY_DYNAMIC_DISPATCH(MarkRunsTarget)(row, votes, changes);
}

}  // namespace scumble::internal
#endif
