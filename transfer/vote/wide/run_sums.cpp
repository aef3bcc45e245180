#include "transfer/vote/wide/run_sums.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "transfer/vote/vote_sum.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/vote/wide/run_sums.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace scumble::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D16 = HWY_CAPPED(std::uint16_t, 32);
using I16 = HWY_CAPPED(std::int16_t, 32);
using D32 = HWY_CAPPED(std::uint32_t, 16);

// Runs of one chunk that are counted together.
struct Group {
  const ChunkRun *first, *last;
  int x0, x1, y0, y1;  // the part of the tile that they reach
};

// Adds to counts[x] how many pixels of the run are on the horizontal arm of column x and reach it, for columns [x0, x1)
// and up to a vector more. Counts are kept modulo 65536, sums of all runs fit.
HWY_ATTR HWY_INLINE void CountRun(const ChunkRun& run, const WideArms& arms, int reach, int x0, int x1,
                                  std::uint16_t* counts) {
  const I16 d;
  const D16 u;
  const auto zero = hn::Zero(d), begin = hn::Set(d, run.begin), end = hn::Set(d, run.end);
  const std::int16_t *low = arms.Low(run.row), *high = arms.High(run.row);
  for (int x = x0; x < x1; x += static_cast<int>(hn::Lanes(d))) {
    const auto at = hn::Add(hn::Set(d, static_cast<std::int16_t>(x)), hn::Iota(d, std::int16_t{0}));
    const auto nearest = hn::Max(hn::LoadU(d, low + x), hn::Sub(at, hn::Set(d, static_cast<std::int16_t>(reach))));
    const auto furthest =
        hn::Min(hn::LoadU(d, high + x), hn::Add(at, hn::Set(d, static_cast<std::int16_t>(reach + 1))));
    const auto first = hn::Max(begin, nearest), last = hn::Min(end, furthest);
    const auto met = hn::BitCast(u, hn::Max(zero, hn::Sub(last, first)));
    hn::StoreU(hn::Add(hn::LoadU(u, counts + x), met), u, counts + x);
  }
}

// Counts of a group's runs, from its first row down to each row: the count between two rows is the difference of
// theirs. Rows without a run share the counts of the row above.
class PrefixRows {
 public:
  // For columns [x0, x1) of the tile and its rows [y0, y1); `storage` holds WideSums::CountedSize(radius).
  HWY_ATTR PrefixRows(const Group& group, const WideArms& arms, int reach, std::uint16_t* storage)
      : first_(group.y0 - reach - 1) {
    const int rows = group.y1 - group.y0 + 2 * reach + 1;
    std::uint16_t* counts = storage;
    std::fill(counts + group.x0, counts + group.x1, std::uint16_t{0});
    const ChunkRun* run = group.first;
    while (run != group.last && run->row <= first_) ++run;  // too far above for every row
    for (int k = 0; k < rows; ++k) {
      if (run != group.last && run->row == first_ + k) {
        std::copy(counts + group.x0, counts + group.x1, counts + WideSums::kCountedStride + group.x0);
        counts += WideSums::kCountedStride;
      }
      for (; run != group.last && run->row == first_ + k; ++run) {
        const int x0 = std::max(group.x0, run->begin - reach), x1 = std::min(group.x1, run->end + reach);
        CountRun(*run, arms, reach, x0, x1, counts);
      }
      rows_[k] = counts;
    }
  }
  // Down to a row of the tile, or of what is at most the radius above or below.
  const std::uint16_t* At(int row) const { return rows_[row - first_]; }

 private:
  int first_;
  const std::uint16_t* rows_[kTileSide + 2 * kWidestRadius + 2];
};

// Adds `n` texels times their counts to sums; up to four more may be read, before `end`, and have no weight. Clears the
// bits of `all`, by 32-bit lane of four pixels, that a texel lacks.
#if HWY_TARGET == HWY_SCALAR

void AddTexels(const std::uint16_t* counts, const std::uint16_t* texels, const std::uint16_t*, int n,
               std::uint32_t* sums, std::uint32_t* all) {
  for (int i = 0; i < 4 * n; ++i) {
    sums[i] += std::uint32_t{counts[i / 4]} * texels[i];
    all[i % 4] &= texels[i];
  }
}

#else

// Which bytes of four 16-bit counts go to the channels' 32-bit lanes; the upper halves are 0.
struct Spread {
  HWY_ALIGN std::uint32_t index[16];
  constexpr Spread() : index() {
    for (std::uint32_t k = 0; k < 16; ++k) index[k] = 0x80800000u | (2 * (k / 4) + 1) << 8 | (2 * (k / 4));
  }
};

HWY_ATTR HWY_INLINE void AddTexels(const std::uint16_t* counts, const std::uint16_t* texels, const std::uint16_t* end,
                                   int n, std::uint32_t* sums, std::uint32_t* all) {
  static constexpr Spread kSpread;
  const D32 d;
  const hn::Rebind<std::uint16_t, D32> half;
  const hn::Repartition<std::uint64_t, D32> d64;
  const hn::Repartition<std::uint8_t, D32> d8;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t k = 0; k < 16; k += lanes) {
    const auto index = hn::BitCast(d8, hn::Load(d, kSpread.index + k));
    auto common = hn::Load(d, all + k);
    const std::uint16_t *count = counts, *texel = texels + k;
    std::uint32_t* sum = sums + k;
    int left = n;
    for (; left >= 4; left -= 4, count += 4, texel += 16, sum += 16) {
      std::uint64_t four;
      std::memcpy(&four, count, 8);
      if (four == 0) continue;  // the texel need not be read
      const auto weight = hn::BitCast(d, hn::TableLookupBytesOr0(hn::BitCast(d8, hn::Set(d64, four)), index));
      const auto color = hn::PromoteTo(d, hn::LoadU(half, texel));
      common = hn::And(common, color);
      hn::StoreU(hn::Add(hn::LoadU(d, sum), hn::Mul(color, weight)), d, sum);
    }
    if (left > 0) {
      std::uint64_t four;
      std::memcpy(&four, count, 8);
      four &= ~std::uint64_t{0} >> (16 * (4 - left));
      std::uint16_t last[16] = {};
      const std::uint16_t* from = texel;
      if (end - (texel - k) < 16) {
        std::memcpy(last, texel - k, std::size_t(8) * std::size_t(left));
        from = last + k;
      }
      const auto weight = hn::BitCast(d, hn::TableLookupBytesOr0(hn::BitCast(d8, hn::Set(d64, four)), index));
      const auto color = hn::PromoteTo(d, hn::LoadU(half, from));
      common = hn::And(common, hn::Or(color, hn::VecFromMask(d, hn::Eq(weight, hn::Zero(d)))));
      hn::StoreU(hn::Add(hn::LoadU(d, sum), hn::Mul(color, weight)), d, sum);
    }
    hn::Store(common, d, all + k);
  }
}

#endif

constexpr int kAhead = 4;  // rows: texels lie far apart in memory, so they are prefetched

void AskFor(const Picture& picture, const Chunk& chunk, int x0, int x1, int y) {
  const int row = y + chunk.shift_y, from = std::max(0, x0 + chunk.shift_x),
            to = std::min(picture.width, x1 + chunk.shift_x);
  if (row < 0 || row >= picture.height) return;
  for (int x = from; x < to; x += 8) hwy::Prefetch(picture.At(x, row));
}

// Add with texels weighted by their alpha: sums of count · alpha · colour and of count · alpha, and of votes.
HWY_ATTR void AddWeighted(const std::uint16_t* counts, const std::uint16_t* texels, int n, std::uint64_t* weighted,
                          std::uint32_t* votes, std::uint32_t* all) {
  std::uint32_t common = 65535;
  for (int i = 0; i < n; ++i) {
    const std::uint32_t alpha = texels[4 * i + 3];
    for (int c = 0; c < 3; ++c) weighted[4 * i + c] += std::uint64_t{counts[i]} * (alpha * texels[4 * i + c]);
    weighted[4 * i + 3] += std::uint64_t{counts[i]} * alpha;
    votes[i] += counts[i];
    common &= alpha;
  }
  all[3] &= common;
}

template <bool kOpaque>
HWY_ATTR void SumGroup(const Work& work, const Chunk& chunk, const Group& group, std::uint32_t* all) {
  HWY_ALIGN std::uint16_t counts[WideSums::kCountedStride];
  const int reach = chunk.reach;
  const Picture& picture = work.exemplar.picture(chunk.exemplar);
  const std::uint16_t* texels_end = picture.rgba.data() + picture.rgba.size();
  const bool inside = work.usable.AllOf(
      {group.x0 + chunk.shift_x, group.y0 + chunk.shift_y, group.x1 + chunk.shift_x, group.y1 + chunk.shift_y});
  const auto add = [&](int y, int x0, int x1) HWY_ATTR {
    const std::uint16_t* texels = picture.At(x0 + chunk.shift_x, y + chunk.shift_y);
    const std::size_t at = std::size_t(y) * WideSums::kStride + x0;
    if constexpr (kOpaque) {
      AddTexels(counts + x0, texels, texels_end, x1 - x0, work.sums + 4 * at, all);
    } else {
      AddWeighted(counts + x0, texels, x1 - x0, work.weighted + 4 * at, work.votes + at, all);
    }
  };
  const PrefixRows prefix(group, work.arms, reach, work.counted);
  const std::uint64_t columns = BitRange(group.x0, group.x1);
  const D16 d;
  for (int y = group.y0; y < group.y1; ++y) {
    const std::uint16_t *above = prefix.At(y - reach - 1), *below = prefix.At(y + reach);
    if (above == below) continue;
    std::uint64_t met = 0;  // columns whose window holds pixels of the chunk
    for (int x = group.x0; x < group.x1; x += static_cast<int>(hn::Lanes(d))) {
      const auto count = hn::Sub(hn::LoadU(d, below + x), hn::LoadU(d, above + x));
      hn::StoreU(count, d, counts + x);
      std::uint8_t bytes[8] = {};
      hn::StoreMaskBits(d, hn::Ne(count, hn::Zero(d)), bytes);
      std::uint64_t bits;
      std::memcpy(&bits, bytes, 8);
      met |= bits << x;
    }
    for (std::uint64_t cut = work.arms.Short(y) & columns & met; cut; cut &= cut - 1) {
      const int x = std::countr_zero(cut);
      counts[x] = static_cast<std::uint16_t>(prefix.At(y + std::min(reach, work.arms.Down(x, y)))[x] -
                                             prefix.At(y - std::min(reach, work.arms.Up(x, y)) - 1)[x]);
    }
    if (y + kAhead < group.y1) AskFor(picture, chunk, group.x0, group.x1, y + kAhead);
    if (inside) {
      add(y, group.x0, group.x1);
      continue;
    }
    for (const UsableRows::Span& span : work.usable.Row(y + chunk.shift_y)) {
      const int x0 = std::max(group.x0, span.begin - chunk.shift_x), x1 = std::min(group.x1, span.end - chunk.shift_x);
      if (x0 < x1) add(y, x0, x1);
    }
  }
}

Group GroupOf(const WideTile& tile, int reach, const ChunkRun* first, const ChunkRun* last) {
  const int width = tile.area().x1 - tile.area().x0, height = tile.area().y1 - tile.area().y0;
  int begin = first->begin, end = first->end;
  for (const ChunkRun* run = first; run != last; ++run) {
    begin = std::min<int>(begin, run->begin), end = std::max<int>(end, run->end);
  }
  // From whole vectors of four pixels to whole ones: then sums are aligned, and a row has no partial vector at its end.
  return {first,
          last,
          std::max(0, begin - reach) & ~3,
          (std::min(width, end + reach) + 3) & ~3,
          std::max(0, first->row - reach),
          std::min(height, (last - 1)->row + reach + 1)};
}

// The cost of a group's sums in pixels, with a constant for each row.
std::int64_t Price(const Group& group) {
  constexpr int kRow = 16;
  return group.x0 < group.x1 && group.y0 < group.y1 ? std::int64_t(group.x1 - group.x0 + kRow) * (group.y1 - group.y0)
                                                    : 0;
}

template <bool kOpaque>
HWY_ATTR void SumChunk(const Work& work, const Chunk& chunk, std::uint32_t* all) {
  const ChunkRun* first = work.tile.runs().data() + chunk.first;
  const ChunkRun* last = first + chunk.count;
  const Group whole = GroupOf(work.tile, chunk.reach, first, last);
  const std::int64_t price = Price(whole);
  if (price == 0) return;
  // In noise, pixels far from each other share an offset by chance: then single runs are less work.
  std::int64_t apart = 0;
  const int window = 2 * chunk.reach + 1;
  if (std::int64_t(chunk.count) * window * window >= 2 * price) apart = price;
  for (const ChunkRun* run = first; run != last && apart < price; ++run)
    apart += Price(GroupOf(work.tile, chunk.reach, run, run + 1));
  if (apart >= price) {
    SumGroup<kOpaque>(work, chunk, whole, all);
    return;
  }
  for (const ChunkRun* run = first; run != last; ++run) {
    const Group alone = GroupOf(work.tile, chunk.reach, run, run + 1);
    if (Price(alone) > 0) SumGroup<kOpaque>(work, chunk, alone, all);
  }
}

template <bool kOpaque>
HWY_ATTR bool SumTile(const Work& work) {
  HWY_ALIGN std::uint32_t all[16];
  std::fill_n(all, 16, 65535u);
  const std::vector<Chunk>& chunks = work.tile.chunks();
  for (std::size_t k = 0; k < chunks.size(); ++k) {
    if (k + 1 < chunks.size()) {
      const Chunk& chunk = chunks[k + 1];
      const ChunkRun* first = work.tile.runs().data() + chunk.first;
      const Group next = GroupOf(work.tile, chunk.reach, first, first + chunk.count);
      for (int y = next.y0; y < std::min(next.y0 + kAhead, next.y1); ++y) {
        AskFor(work.exemplar.picture(chunk.exemplar), chunk, next.x0, next.x1, y);
      }
    }
    SumChunk<kOpaque>(work, chunks[k], all);
  }
  std::uint32_t alpha = 65535;
  for (int k = 3; k < 16; k += 4) alpha &= all[k];
  return alpha == 65535;
}

HWY_ATTR bool SumOpaque(const Work& work) { return SumTile<true>(work); }
HWY_ATTR bool SumWeighted(const Work& work) { return SumTile<false>(work); }

// The mean (2 · sum + votes) / (2 · votes), rounded down, of the pixels whose bit is set; also of alpha, which is 65535
// times the votes. The added half makes the quotient never an integer, and at least 1 / (4 · votes) from the next: far
// more than a double's rounding.
HWY_ATTR void WriteRow(std::uint64_t active, const std::uint32_t* sums, const double* inverses, std::uint16_t* out) {
  const HWY_CAPPED(double, 4) d;
  const hn::Rebind<std::uint32_t, decltype(d)> u32;
  const hn::Rebind<std::int32_t, decltype(d)> i32;
  const hn::Rebind<std::uint16_t, decltype(d)> u16;
  // The conversion to doubles takes signed integers.
  constexpr std::uint32_t kSign = 0x80000000u;
  for (; active; active &= active - 1) {
    const int x = std::countr_zero(active);
    const std::uint32_t* sum = sums + 4 * x;
    const std::uint32_t votes = (sum[3] >> 16) + 1;
    const auto inverse = hn::Set(d, inverses[votes]);
    const auto half = hn::Set(d, 2.0 * kSign + votes + 0.5);
    std::uint16_t pixel[4];
    for (std::size_t c = 0; c < 4; c += hn::Lanes(d)) {
      const auto lowered = hn::BitCast(i32, hn::Xor(hn::LoadU(u32, sum + c), hn::Set(u32, kSign)));
      const auto twice = hn::Mul(hn::PromoteTo(d, lowered), hn::Set(d, 2.0));
      const auto mean = hn::DemoteTo(i32, hn::Mul(hn::Add(twice, half), inverse));
      hn::StoreU(hn::DemoteTo(u16, mean), u16, pixel + c);
    }
    std::memcpy(out + 4 * x, pixel, 8);
  }
}

}  // namespace scumble::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(SumOpaque);
HWY_EXPORT(SumWeighted);
HWY_EXPORT(WriteRow);

void WideSums::Sum(const WideTile& tile, const WideArms& arms, const PreparedExemplar& exemplar,
                   const UsableRows& usable) {
  constexpr std::size_t kPixels = std::size_t(kStride) * kTileSide;
  counted_.resize(CountedSize(tile.radius()));
  if (opaque_) {
    if (!sums_) sums_ = hwy::AllocateAligned<std::uint32_t>(4 * kPixels);
    std::fill_n(sums_.get(), 4 * kPixels, 0u);
    opaque_ =
        HWY_DYNAMIC_DISPATCH(SumOpaque)({tile, arms, exemplar, usable, counted_.data(), sums_.get(), nullptr, nullptr});
    weights_count_ = !opaque_;
    if (opaque_) return;
  }
  // The next tile starts with the form that this one needed.
  weights_count_ = true;
  weighted_.assign(4 * kPixels, 0), votes_.assign(kPixels, 0);
  opaque_ = HWY_DYNAMIC_DISPATCH(SumWeighted)(
      {tile, arms, exemplar, usable, counted_.data(), nullptr, weighted_.data(), votes_.data()});
}

void WideSums::Write(const WideTile& tile, Picture& out) {
  const Region& area = tile.area();
  if (inverses_.size() <= std::size_t(tile.Window())) {
    inverses_.assign(std::size_t(tile.Window()) + 1, 0.0);
    for (std::size_t n = 1; n < inverses_.size(); ++n) inverses_[n] = 1.0 / (2.0 * static_cast<double>(n));
  }
  for (int y = area.y0; y < area.y1; ++y) {
    const std::size_t first = std::size_t(y - area.y0) * kStride;
    const std::uint64_t active = tile.ActiveWord(y - area.y0);
    if (weights_count_)
      WriteWeighted(active, first, out.At(area.x0, y));
    else
      HWY_DYNAMIC_DISPATCH(WriteRow)(active, sums_.get() + 4 * first, inverses_.data(), out.At(area.x0, y));
  }
}

void WideSums::WriteWeighted(std::uint64_t active, std::size_t first, std::uint16_t* out) const {
  for (; active; active &= active - 1) {
    const std::size_t x = std::size_t(std::countr_zero(active));
    const std::uint64_t* sum = weighted_.data() + 4 * (first + x);
    VoteSum{{sum[0], sum[1], sum[2]}, sum[3], votes_[first + x]}.Count(out + 4 * x);
  }
}

}  // namespace scumble::internal
#endif
