#include "finish/outline/piece_rows.h"

#include <algorithm>
#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "finish/outline/piece_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/filter/vector_lane-inl.h"

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

// `count` is a multiple of kCoverBlock. Pieces of a wide stroke lie over each other for the most part: where pixels are
// full, nothing is computed.
void CoverBlocksHere(const PieceAtRow& at, std::size_t count, float* shares, std::uint32_t* owners) {
  const Floats d;
  const Words du;
  const Lane along_x = at.along.x, along_y = at.along.y, down = at.down;
  const auto within = [](Lane x) HWY_ATTR { return Min(Max(x, 0.0f), 1.0f); };
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Lane had = hn::LoadU(d, shares + i);
    if (hn::AllFalse(d, Less(had, 1.0f))) continue;
    const Lane right = Lane(hn::Iota(d, static_cast<float>(i))) + at.right;
    const Lane place = within((right * along_x + down * along_y) * at.per_squared);
    const Lane off_x = right - along_x * place, off_y = down - along_y * place;
    const Lane thick = at.from_width + at.wider * place;
    const Lane edge = Max(thick, 1.0f) * 0.5f + 0.5f - Sqrt(off_x * off_x + off_y * off_y);
    const Lane share = within(edge) * Min(thick, 1.0f);
    const Choice more = Less(had, share);
    hn::StoreU(Select(more, share, had).v, d, shares + i);
    if (!owners) continue;
    const auto owner = hn::IfThenElse(hn::RebindMask(du, more), hn::Set(du, at.owner), hn::LoadU(du, owners + i));
    hn::StoreU(owner, du, owners + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(CoverBlocksHere);

void CoverRow(const PieceAtRow& at, std::size_t count, float* shares, std::uint32_t* owners) {
  const std::size_t whole = count / kCoverBlock * kCoverBlock, left = count - whole;
  const auto cover = HWY_DYNAMIC_DISPATCH(CoverBlocksHere);
  cover(at, whole, shares, owners);
  if (left == 0) return;
  std::array<float, kCoverBlock> last_shares;
  std::array<std::uint32_t, kCoverBlock> last_owners{};
  last_shares.fill(1.0f);
  std::copy_n(shares + whole, left, last_shares.data());
  if (owners) std::copy_n(owners + whole, left, last_owners.data());
  PieceAtRow rest = at;
  rest.right += static_cast<float>(whole);
  cover(rest, kCoverBlock, last_shares.data(), owners ? last_owners.data() : nullptr);
  std::copy_n(last_shares.data(), left, shares + whole);
  if (owners) std::copy_n(last_owners.data(), left, owners + whole);
}

}  // namespace scumble::internal
#endif
