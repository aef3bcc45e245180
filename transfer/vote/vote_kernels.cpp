#include "transfer/vote/vote_kernels.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <vector>

#include "core/image/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/vote/vote_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef SCUMBLE_VOTE_ROWS_ONCE
#define SCUMBLE_VOTE_ROWS_ONCE
namespace scumble::internal {

// For n votes, floor(2^32 / 2n) + 1: for MeanTexel.
constexpr std::array<std::uint32_t, 10> kMeanReciprocals = [] {
  std::array<std::uint32_t, 10> reciprocals{};
  for (std::uint32_t n = 1; n < 10; ++n) {
    reciprocals[n] = static_cast<std::uint32_t>((std::uint64_t{1} << 32) / (2 * n) + 1);
  }
  return reciprocals;
}();

}  // namespace scumble::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace scumble::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

HWY_INLINE void CopyTexel(const std::uint16_t* from, std::uint16_t* to) {
  if (from[3] != 0)
    std::memcpy(to, from, 8);
  else
    std::memset(to, 0, 8);
}

HWY_INLINE void CopyRun(const std::uint16_t* from, int count, std::uint16_t* to) {
#if HWY_TARGET == HWY_SCALAR
  for (int i = 0; i < count; ++i) CopyTexel(from + 4 * i, to + 4 * i);
#else
  const hn::CappedTag<std::uint64_t, 4> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  if (count < lanes) {
    for (int i = 0; i < count; ++i) CopyTexel(from + 4 * i, to + 4 * i);
    return;
  }
  const hn::Repartition<std::uint16_t, decltype(d)> shorts;
  const auto copy = [&](int i) HWY_ATTR {
    const auto texels = hn::BitCast(d, hn::LoadU(shorts, from + 4 * i));
    const auto shown = hn::IfThenZeroElse(hn::Eq(hn::ShiftRight<48>(texels), hn::Zero(d)), texels);
    hn::StoreU(hn::BitCast(shorts, shown), shorts, to + 4 * i);
  };
  int i = 0;
  for (; i + lanes <= count; i += lanes) copy(i);
  if (i < count) copy(count - lanes);
#endif
}

void CopyRow(const VoteRow& row, const std::uint64_t* marked, const std::uint64_t* linked) {
  const std::size_t begin = row.field.Index(0, row.y);
  const std::int16_t *x = row.field.x.data() + begin, *y = row.field.y.data() + begin;
  const std::uint8_t* exemplar = row.field.exemplar.data() + begin;
  const bool one = row.texels.count == 1;
  for (int w = 0; w < row.words; ++w) {
    std::uint64_t left = marked[w];
    const std::uint64_t goes_on = linked[w] & left >> 1;
    const int first = 64 * (row.first_word + w);
    while (left) {
      const int i = std::countr_zero(left);
      const int count = std::countr_one(goes_on >> i) + 1;
      const int p = first + i;
      const std::uint16_t* picture = row.texels.picture[one ? 0 : exemplar[p]];
      const std::uint16_t* from = picture + 4 * (std::size_t(y[p]) * row.texels.width + x[p]);
      CopyRun(from, count, row.out + 4 * std::size_t(p));
      left &= i + count < 64 ? ~std::uint64_t{0} << (i + count) : 0;
    }
  }
}

void PlaceRow(const std::int16_t* x, const std::int16_t* y, int width, int count, std::int32_t* places) {
  const hn::ScalableTag<std::int32_t> d;
  const hn::Rebind<std::int16_t, decltype(d)> narrow;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto stride = hn::Set(d, width);
  int i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto row = hn::Mul(hn::PromoteTo(d, hn::LoadU(narrow, y + i)), stride);
    hn::StoreU(hn::Add(row, hn::PromoteTo(d, hn::LoadU(narrow, x + i))), d, places + i);
  }
  for (; i < count; ++i) places[i] = y[i] * width + x[i];
}

// The sum of the texels that the window around pixel p votes for. texels[dy] is the first picture moved up by dy rows,
// places[dy] the sources of the row dy farther down, from p on.
template <bool kOne, class D>
HWY_INLINE hn::Vec<D> SumOfWindow(D d, const VoteRow& row, const std::uint16_t* const* texels,
                                  const std::int32_t* const* places, std::size_t p) {
  const hn::Rebind<std::uint16_t, D> narrow;
  auto sum = hn::Zero(d);
#pragma GCC unroll 3
  for (int dy = -1; dy <= 1; ++dy) {
#pragma GCC unroll 3
    for (int dx = -1; dx <= 1; ++dx) {
      const std::ptrdiff_t place = std::ptrdiff_t(places[dy][dx]) - dx;
      if constexpr (kOne) {
        sum = hn::Add(sum, hn::PromoteTo(d, hn::LoadU(narrow, texels[dy] + 4 * place)));
      } else {
        const std::ptrdiff_t q = std::ptrdiff_t(p) + dy * std::ptrdiff_t(row.field.width) + dx;
        const std::uint16_t* picture = row.texels.picture[row.field.exemplar[std::size_t(q)]];
        const std::ptrdiff_t above = dy * std::ptrdiff_t(row.texels.width);
        sum = hn::Add(sum, hn::PromoteTo(d, hn::LoadU(narrow, picture + 4 * (place - above))));
      }
    }
  }
  return sum;
}

#if HWY_TARGET != HWY_SCALAR
// The mean of n votes, n at most 9, by a reciprocal (docs/numerics.md, "Derivations"). `rounding` is n in all lanes,
// `reciprocal` is floor(2^32 / 2n) + 1.
template <class V>
HWY_INLINE void MeanTexel(V sum, V rounding, V reciprocal, std::uint16_t* out) {
  const hn::FixedTag<std::uint32_t, 4> d;
  const hn::RepartitionToWide<decltype(d)> twice;
  const hn::Rebind<std::uint16_t, decltype(d)> narrow;
  const auto doubled = hn::Add(hn::Add(sum, sum), rounding);
  const auto even = hn::ShiftRight<32>(hn::MulEven(doubled, reciprocal));
  const auto odd = hn::MulEven(hn::BitCast(d, hn::ShiftRight<32>(hn::BitCast(twice, doubled))), reciprocal);
  const auto mean = hn::OddEven(hn::BitCast(d, odd), hn::BitCast(d, even));
  hn::StoreU(hn::DemoteTo(narrow, hn::BitCast(hn::RebindToSigned<decltype(d)>(), mean)), narrow, out);
}
#endif

template <bool kOne>
void MeanRowOf(const VoteRow& row, const SourceRows& sources, std::uint64_t* marked) {
#if HWY_TARGET != HWY_SCALAR
  constexpr std::uint32_t kVotes = 9;
  const hn::FixedTag<std::uint32_t, 4> d;
  const auto reciprocal = hn::Set(d, kMeanReciprocals[kVotes]);
  const auto rounding = hn::Set(d, kVotes);
  const std::int32_t* rows[3];
  const std::uint16_t* texels[3];
  for (int dy = -1; dy <= 1; ++dy) {
    rows[dy + 1] = sources.Row(row.y + dy);
    texels[dy + 1] = row.texels.picture[0] - 4 * dy * std::ptrdiff_t(row.texels.width);
  }
  for (int w = 0; w < row.words; ++w) {
    std::uint64_t left = marked[w], refused = 0;
    const int first = 64 * (row.first_word + w);
    for (; left; left &= left - 1) {
      const int p = first + std::countr_zero(left);
      const std::int32_t* places[3];
      for (int k = 0; k < 3; ++k) places[k] = rows[k] + (p - sources.begin());
      const auto sum = SumOfWindow<kOne>(d, row, texels + 1, places + 1, row.field.Index(p, row.y));
      MeanTexel(sum, rounding, reciprocal, row.out + 4 * std::size_t(p));
      // All are opaque only if the mean of the alphas is, and no rounding was lost.
      refused |= hn::ExtractLane(sum, 3) == kVotes * 65535 ? 0 : left & (0 - left);
    }
    marked[w] = refused;
  }
#else
  (void)row, (void)sources, (void)marked;
#endif
}

void MeanRow(const VoteRow& row, const SourceRows& sources, std::uint64_t* marked) {
  row.texels.count == 1 ? MeanRowOf<true>(row, sources, marked) : MeanRowOf<false>(row, sources, marked);
}

void PartRow(const VoteRow& row, const SourceRows& sources, const std::uint64_t* votes, std::uint64_t* marked) {
#if HWY_TARGET != HWY_SCALAR
  const hn::FixedTag<std::uint32_t, 4> d;
  const hn::Rebind<std::uint16_t, decltype(d)> narrow;
  const std::int32_t* places[kNeighbourCount];  // of each neighbour, from the pixel at column `begin` on
  std::ptrdiff_t steps[kNeighbourCount];        // of each neighbour, in the exemplar
  for (int k = 0; k < kNeighbourCount; ++k) {
    places[k] = sources.Row(row.y + kNeighbours[k].dy) + kNeighbours[k].dx;
    steps[k] = kNeighbours[k].dy * std::ptrdiff_t(row.texels.width) + kNeighbours[k].dx;
  }
  const std::int32_t* own = sources.Row(row.y);
  const bool one = row.texels.count == 1;
  for (int w = 0; w < row.words; ++w, votes += kNeighbourCount) {
    std::uint64_t refused = 0;
    for (std::uint64_t left = marked[w]; left; left &= left - 1) {
      const int i = std::countr_zero(left), p = 64 * (row.first_word + w) + i, column = p - sources.begin();
      const std::size_t q = row.field.Index(p, row.y);
      std::uint64_t voting = 0;
      for (int k = 0; k < kNeighbourCount; ++k) voting |= (votes[k] >> i & 1) << k;
      const auto texel = [&](std::size_t from, std::ptrdiff_t place) HWY_ATTR {
        const std::uint16_t* picture = one ? row.texels.picture[0] : row.texels.picture[row.field.exemplar[from]];
        return hn::PromoteTo(d, hn::LoadU(narrow, picture + 4 * place));
      };
      const std::uint32_t count = 1 + static_cast<std::uint32_t>(std::popcount(voting));
      auto sum = texel(q, own[column]);
      for (; voting; voting &= voting - 1) {
        const int k = std::countr_zero(voting);
        const auto [dx, dy] = kNeighbours[k];
        const std::ptrdiff_t from = std::ptrdiff_t(q) + dy * std::ptrdiff_t(row.field.width) + dx;
        sum = hn::Add(sum, texel(std::size_t(from), places[k][column] - steps[k]));
      }
      MeanTexel(sum, hn::Set(d, count), hn::Set(d, kMeanReciprocals[count]), row.out + 4 * std::size_t(p));
      refused |= hn::ExtractLane(sum, 3) == count * 65535 ? 0 : left & (0 - left);
    }
    marked[w] = refused;
  }
#else
  (void)row, (void)sources, (void)votes, (void)marked;
#endif
}

}  // namespace scumble::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(CopyRow);
HWY_EXPORT(MeanRow);
HWY_EXPORT(PartRow);
HWY_EXPORT(PlaceRow);

TexelPlanes::TexelPlanes(const PreparedExemplar& exemplar)
    : count(exemplar.count()), width(exemplar.width()), height(exemplar.height()) {
  SCUMBLE_CHECK(count <= kMax);
  for (int k = 0; k < count; ++k) picture[k] = exemplar.picture(k).rgba.data();
}

void CopyMarked(const VoteRow& row, std::span<const std::uint64_t> marked, std::span<const std::uint64_t> linked) {
  HWY_DYNAMIC_DISPATCH(CopyRow)(row, marked.data(), linked.data());
}

void SourceRows::Add(const SourceField& field, const TexelPlanes& texels, int y) {
  if (y < 0 || y >= field.height || radius_ == 0) return;
  const std::size_t begin = field.Index(begin_, y);
  HWY_DYNAMIC_DISPATCH(PlaceRow)
  (field.x.data() + begin, field.y.data() + begin, texels.width, end_ - begin_, places_.data() + Offset(y));
}

void MeanOfMarked(const VoteRow& row, const SourceRows& sources, std::span<std::uint64_t> marked) {
  SCUMBLE_DCHECK(sources.radius() == 1);
  HWY_DYNAMIC_DISPATCH(MeanRow)(row, sources, marked.data());
}

void MeanOfParts(const VoteRow& row, const SourceRows& sources, std::span<const std::uint64_t> votes,
                 std::span<std::uint64_t> marked) {
  SCUMBLE_DCHECK(sources.radius() == 1);
  HWY_DYNAMIC_DISPATCH(PartRow)(row, sources, votes.data(), marked.data());
}

}  // namespace scumble::internal
#endif
