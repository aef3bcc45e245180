// StyleBlit (Sýkora et al. 2019, section 3.2), sixteen pixels at a time. The decisions and the bytes equal those of
// styleblit.cpp. That file defines the decisions, this one makes them fast:
//
//   - The picture is cut into columns of tiles. A thread goes down its rows of one column, or of all of them
//     (band_pipeline.h), with its own seeds (seed_tiles.h).
//   - A block of sixteen pixels of one row goes through the levels from coarse to fine, until all of them are settled.
//     Its nearest seeds are found by vector code that compares the nine cells of each pixel (fine levels), or come from
//     the runs of pixels that share one (coarse levels).
//   - Each of these seeds, one or two on coarse levels, is tried on its pixels at once. Their sources stand side by
//     side in the exemplar, so both guides are read from sixteen places in a row.
//   - Pixels that accept none take their own nearest neighbour.
#include "transfer/match/styleblit_simd.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "transfer/match/variety.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/match/styleblit_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

const hn::CappedTag<float, kBlock> kFloats;
const hn::CappedTag<std::int16_t, kBlock> kShorts;
const hn::CappedTag<std::uint16_t, kBlock> kWords;
const hn::CappedTag<std::uint16_t, 2 * kBlock> kPairWords;
const hn::CappedTag<std::uint8_t, kBlock> kBytes;

// first, first + 1, … by lane. (Highway's Iota writes them to memory one by one.)
alignas(64) constexpr std::uint16_t kCount[2 * kBlock] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10,
                                                          11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21,
                                                          22, 23, 24, 25, 26, 27, 28, 29, 30, 31};
template <class Tag>
HWY_INLINE hn::Vec<Tag> CountFrom(Tag tag, int first) {
  const auto count = hn::BitCast(tag, hn::Load(hn::Rebind<std::uint16_t, Tag>(), kCount));
  return hn::Add(hn::Set(tag, static_cast<hn::TFromD<Tag>>(first)), count);
}

// One bit a lane, the first lane's lowest.
template <class Tag, class Mask>
HWY_INLINE std::uint32_t BitsOf(Tag tag, Mask mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(tag, mask, bytes);
  std::uint16_t bits;
  std::memcpy(&bits, bytes, sizeof bits);
  return bits;
}

template <class Tag>
HWY_INLINE hn::Mask<Tag> MaskFrom(Tag tag, std::uint32_t bits) {
  const std::uint64_t word = bits;
  std::uint8_t bytes[8];
  std::memcpy(bytes, &word, sizeof bytes);
  return hn::LoadMaskBits(tag, bytes);
}

// Writes the lanes of the mask. (Highway's BlendedStore of 16 bits goes lane by lane before AVX-512; here the other
// lanes may be rewritten with their own values.)
template <class Tag>
HWY_INLINE void StoreSome(Tag tag, hn::Mask<Tag> mask, hn::Vec<Tag> value, hn::TFromD<Tag>* to) {
  hn::StoreU(hn::IfThenElse(mask, value, hn::LoadU(tag, to)), tag, to);
}

// Lanes from `first` to `last`, which may lie outside of the block.
HWY_INLINE std::uint32_t LanesBetween(int first, int last) {
  if (last < 0 || first >= kBlock || first > last) return 0;
  return (0xffffu << std::max(first, 0)) & (0xffffu >> (kBlock - 1 - std::min(last, kBlock - 1)));
}

// One row of a tile: its pixels' input and results. Blocks count from the tile's left.
struct Row {
  static constexpr int kBlocks = kTileWidth / kBlock;

  int x, y;
  const float* normal[3];
  const float* light;  // null: light has no effect
  std::uint16_t wanted[kBlocks];
  std::uint16_t unsettled[kBlocks];
  std::int16_t source_x[kTileWidth], source_y[kTileWidth];
  std::uint16_t how[kTileWidth];          // level, and the exemplar times 256
  std::uint16_t nearest[kTileWidth + 1];  // seeds of the current level
  glm::vec3 guide_offset[kTileWidth];     // guide offsets; only where the field has them
  float copy[4][kTileWidth];              // of a row whose last block is not whole: no read beyond the picture
};

class TileMatcher {
 public:
  explicit TileMatcher(const TileJob& job)
      : input_(job.input),
        rows_(job.exemplar),
        wanted_(job.wanted.data()),
        tile_x_(job.tile_x),
        scratch_(job.scratch),
        levels_(job.scratch.levels),
        field_(job.field),
        squares_(input_.test.metric() == ThresholdMetric::kL2),
        light_counts_(!input_.luminance.empty() && input_.illumination.weight() > 0.0f) {
    const int x0 = tile_x_ * kTileWidth;
    tile_ = {x0, std::max(job.y0, input_.region.y0), std::min(field_.width, x0 + kTileWidth),
             std::min(job.y1, input_.region.y1)};
    blocks_ = (tile_.x1 - tile_.x0 + kBlock - 1) / kBlock;
    first_block_ = (std::max(job.x0, x0) - x0) / kBlock;
    end_block_ = std::min(blocks_, (job.x1 - x0 + kBlock - 1) / kBlock);
  }

  void Match() {
    for (int y = tile_.y0; y < tile_.y1; ++y) MatchRow(y);
  }

 private:
  // Pixels of one block that have a seed in common.
  struct Group {
    std::uint16_t block, lanes;
    int seed;
  };

  void MatchRow(int y) {
    Row& row = row_;
    const std::size_t i = field_.Index(tile_.x0, y);
    int open = ReadRow(y, i);
    if (open == 0) return;
    if (!scratch_.begun) Begin();
    for (TileSeeds& seeds : levels_) {
      if (open == 0) break;
      groups_ = 0;
      if (seeds.level() <= kMaxSpreadLevel)
        GroupBySpread(seeds, open);
      else
        GroupByRuns(seeds, open);
      for (int g = 0; g < groups_; ++g) CandidateFor(seeds, group_[g]);
      const int before = open;
      open = 0;
      for (int k = 0; k < before; ++k) {
        open_[open] = open_[k];
        open += row.unsettled[open_[k]] != 0;
      }
    }
    for (int k = 0; k < open; ++k) {
      for (std::uint32_t left = row.unsettled[open_[k]]; left != 0; left &= left - 1) {
        TakeOwn(open_[k] * kBlock + std::countr_zero(left));
      }
    }
    for (int block = first_block_; block < end_block_; ++block) Store(block, i + std::size_t(block) * kBlock);
  }

  // A tile without wanted pixels needs no preparation.
  void Begin() {
    scratch_.begun = true;
    levels_.resize(static_cast<std::size_t>(std::max(0, input_.levels - input_.least_level)));
    int level = input_.levels;
    for (TileSeeds& seeds : levels_) seeds.Reset(input_, --level, tile_.x0);
  }

  // Returns the number of blocks with wanted pixels; open_ lists them.
  int ReadRow(int y, std::size_t i) {
    Row& row = row_;
    row.x = tile_.x0, row.y = y;
    const int width = tile_.x1 - tile_.x0;
    const std::uint8_t* const wanted = wanted_ + i;
    int open = 0;
    for (int block = first_block_; block < end_block_; ++block) {
      const int lanes = std::min(kBlock, width - block * kBlock);
      const std::uint8_t* const bytes = wanted + block * kBlock;
      const int x = row.x + block * kBlock;
      const std::uint32_t bits = (lanes == kBlock ? Nonzero(bytes) : NonzeroOf(bytes, lanes)) &
                                 LanesBetween(input_.region.x0 - x, input_.region.x1 - 1 - x);
      row.wanted[block] = row.unsettled[block] = static_cast<std::uint16_t>(bits);
      open_[open] = block;
      open += bits != 0;
    }
    if (open == 0) return 0;
    const std::size_t pixel = input_.guides.Index(tile_.x0, y);
    for (int c = 0; c < 3; ++c) row.normal[c] = Values(input_.guides.Plane(Layer::kNormal, c).data() + pixel, c);
    KeepWithinRim(width);
    row.light = input_.luminance.empty() ? nullptr : Values(input_.luminance.data() + pixel, 3);
    if (!field_.guide_offset.empty()) std::fill_n(row.guide_offset, width, glm::vec3(0.0f));
    return open;
  }

  const float* Values(const float* plane, int copy) {
    const int width = tile_.x1 - tile_.x0;
    if (width % kBlock == 0) return plane;
    std::fill(std::copy_n(plane, width, row_.copy[copy]), row_.copy[copy] + blocks_ * kBlock, 0.0f);
    return row_.copy[copy];
  }

  // PreparedExemplar::WithinRim. Only rows that have a normal beyond the rim are copied.
  void KeepWithinRim(int width) {
    if (!rows_.is_sphere || !AnyBeyondRim()) return;
    for (int c = 0; c < 3; ++c) {
      if (row_.normal[c] == row_.copy[c]) continue;
      std::copy_n(row_.normal[c], width, row_.copy[c]);
      row_.normal[c] = row_.copy[c];
    }
    for (int i = 0; i < width; ++i) {
      const glm::vec3 normal = input_.exemplar.WithinRim({row_.copy[0][i], row_.copy[1][i], row_.copy[2][i]});
      for (int c = 0; c < 3; ++c) row_.copy[c][i] = normal[c];
    }
  }

  bool AnyBeyondRim() const {
    const auto rim = hn::Set(kFloats, input_.exemplar.squared_rim());
    const auto zero = hn::Zero(kFloats);
    auto beyond = hn::Lt(zero, zero);
    for (int i = 0; i < blocks_ * kBlock; i += static_cast<int>(hn::Lanes(kFloats))) {
      const auto x = hn::LoadU(kFloats, row_.normal[0] + i), y = hn::LoadU(kFloats, row_.normal[1] + i);
      const auto squared = hn::Add(hn::Mul(x, x), hn::Mul(y, y));
      beyond = hn::Or(beyond, hn::Or(hn::Gt(squared, rim), hn::Lt(hn::LoadU(kFloats, row_.normal[2] + i), zero)));
    }
    return !hn::AllFalse(kFloats, beyond);
  }

  static HWY_INLINE std::uint32_t Nonzero(const std::uint8_t* bytes) {
    std::uint32_t bits = 0;
    for (int i = 0; i < kBlock; i += static_cast<int>(hn::Lanes(kBytes))) {
      bits |= BitsOf(kBytes, hn::Ne(hn::LoadU(kBytes, bytes + i), hn::Zero(kBytes))) << i;
    }
    return bits;
  }
  static std::uint32_t NonzeroOf(const std::uint8_t* bytes, int count) {
    std::uint8_t copy[kBlock] = {};
    std::memcpy(copy, bytes, static_cast<std::size_t>(count));
    return Nonzero(copy);
  }

  // The nearest seeds of as many pixels as the vectors have lanes: by squared distance among the nine cells around each
  // pixel's own; ties to the first in row order. On levels up to kMaxSpreadLevel, squares stay below 2^15.
  template <class Tag>
  HWY_INLINE void FindNearest(Tag tag, const TileSeeds& seeds, int x, std::uint16_t* nearest) const {
    const int level = seeds.level(), h = 1 << level, row = row_.y >> level;
    const int from = x - seeds.left();
    const auto here = CountFrom(tag, from);
    const auto column = hn::ShiftRightSame(here, level);
    auto best = hn::Set(tag, std::uint16_t{0xffff});
    auto best_seed = hn::Zero(tag);
    for (int dr = -1; dr <= 1; ++dr) {
      const std::uint16_t* const spread_x = seeds.SpreadX(row + dr) + from;
      const std::uint16_t* const spread_y = seeds.SpreadY(row + dr) + from;
      const auto down = hn::Set(tag, static_cast<std::uint16_t>((row + dr) * h - row_.y));
      for (int dc = -1; dc <= 1; ++dc) {
        const auto dx = hn::Sub(hn::LoadU(tag, spread_x + dc * h), here);
        const auto dy = hn::Add(hn::LoadU(tag, spread_y + dc * h), down);
        const auto least = hn::Min(best, hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)));
        const auto seed = hn::Add(column, hn::Set(tag, static_cast<std::uint16_t>(seeds.FirstOf(row + dr) + dc)));
        best_seed = hn::IfThenElse(hn::Ne(least, best), seed, best_seed);
        best = least;
      }
    }
    hn::StoreU(best_seed, tag, nearest);
  }

  void GroupBySpread(TileSeeds& seeds, int open) {
    constexpr bool kPairs = hn::MaxLanes(kPairWords) == 2 * kBlock;
    for (int k = 0; k < open; ++k) {
      const int from = open_[k] * kBlock, x = row_.x + from;
      if (kPairs && k + 1 < open && open_[k + 1] == open_[k] + 1) {
        seeds.Need(row_.y >> seeds.level(), x, 2 * kBlock);
        FindNearest(kPairWords, seeds, x, row_.nearest + from);
        ++k;
      } else {
        seeds.Need(row_.y >> seeds.level(), x, kBlock);
        FindNearestOfBlock(seeds, open_[k]);
      }
    }
    for (int k = 0; k < open; ++k) {
      const std::uint16_t* const nearest = row_.nearest + open_[k] * kBlock;
      GroupBlock(open_[k], EndsOf(open_[k]), [&](int lane) { return int(nearest[lane]); });
    }
  }

  HWY_INLINE void FindNearestOfBlock(const TileSeeds& seeds, int block) {
    for (int i = block * kBlock; i < (block + 1) * kBlock; i += static_cast<int>(hn::Lanes(kWords))) {
      FindNearest(kWords, seeds, row_.x + i, row_.nearest + i);
    }
  }

  // Bit i: pixel i + 1 has another nearest seed than pixel i, or there is none.
  HWY_INLINE std::uint32_t EndsOf(int block) const {
    const std::uint16_t* const nearest = row_.nearest + block * kBlock;
    std::uint32_t ends = 0;
    for (int i = 0; i < kBlock; i += static_cast<int>(hn::Lanes(kWords))) {
      ends |= BitsOf(kWords, hn::Ne(hn::LoadU(kWords, nearest + i), hn::LoadU(kWords, nearest + i + 1))) << i;
    }
    return ends | 1u << (kBlock - 1);
  }

  template <class SeedOf>
  HWY_INLINE void GroupBlock(int block, std::uint32_t ends, const SeedOf& seed_of) {
    for (std::uint32_t left = row_.unsettled[block]; left != 0;) {
      const int first = std::countr_zero(left);
      const std::uint32_t end = ends & (~0u << first), same = end ^ (end - 1);  // up to the first end
      AddGroup(block, left & same, seed_of(first));
      left &= ~same;
    }
  }

  void GroupByRuns(TileSeeds& seeds, int open) {
    TileSeeds::Run run{0, row_.x};
    for (int k = 0; k < open; ++k) {
      const int block = open_[k], x = row_.x + block * kBlock;
      seeds.Need(row_.y >> seeds.level(), x, kBlock);
      for (std::uint32_t left = row_.unsettled[block]; left != 0;) {
        const int first = x + std::countr_zero(left);
        if (first >= run.end) run = seeds.RunFrom(first, row_.y);
        const std::uint32_t same = LanesBetween(0, run.end - 1 - x);
        AddGroup(block, left & same, run.seed);
        left &= ~same;
      }
    }
  }

  HWY_INLINE void AddGroup(int block, std::uint32_t lanes, int seed) {
    group_[groups_++] = {static_cast<std::uint16_t>(block), static_cast<std::uint16_t>(lanes), seed};
  }

  // Tries a seed on a group: the pixels that are like it take its candidate.
  HWY_INLINE void CandidateFor(TileSeeds& seeds, const Group& group) {
    const TileCandidate& candidate = seeds.Candidate(group.seed);
    if (candidate.state != TileCandidate::kCandidates) return;
    const glm::vec3* const guide_offset = candidate.can_vary ? &seeds.Variation(group.seed).guide_offset : nullptr;
    const int from = group.block * kBlock;
    const std::uint32_t taken = Alike(from, candidate, guide_offset, group.lanes);
    row_.unsettled[group.block] &= static_cast<std::uint16_t>(~taken);
    Take(from, taken, candidate, seeds.level());
    if (candidate.can_vary && taken != 0) TakeVaried(seeds, group.seed, from, taken);
  }

  HWY_INLINE void Take(int from, std::uint32_t lanes, const TileCandidate& candidate, int level) {
    const int x = row_.x + from + candidate.offset_x;
    const auto y = hn::Set(kShorts, static_cast<std::int16_t>(row_.y + candidate.offset_y));
    const auto how = hn::Set(kWords, static_cast<std::uint16_t>(level | candidate.exemplar << 8));
    for (int i = 0; i < kBlock; i += static_cast<int>(hn::Lanes(kShorts))) {
      const auto mask = MaskFrom(kShorts, lanes >> i);
      StoreSome(kShorts, mask, CountFrom(kShorts, x + i), row_.source_x + from + i);
      StoreSome(kShorts, mask, y, row_.source_y + from + i);
      StoreSome(kWords, MaskFrom(kWords, lanes >> i), how, row_.how + from + i);
    }
  }

  // The lanes whose source is usable and whose guide, after the offset, is like it: the rules of GuideTest and
  // Illumination. `from` is the first lane's place in the row.
  HWY_INLINE std::uint32_t Alike(int from, const TileCandidate& candidate, const glm::vec3* guide_offset,
                                 std::uint32_t lanes) const {
    const int x = row_.x + from + candidate.offset_x, y = row_.y + candidate.offset_y;
    if (static_cast<unsigned>(y) >= static_cast<unsigned>(rows_.height)) return 0;
    if (rows_.is_sphere) {
      const int first = rows_.first[y], last = rows_.last[y];
      if (x < first || x + kBlock - 1 > last) {
        lanes &= LanesBetween(first - x, last - x);
        if (lanes == 0) return 0;
      }
      const auto down = hn::Set(kFloats, -rows_.coordinate[y]);
      const auto down_squared = hn::Mul(down, down);
      return lanes & Compare(from, candidate.exemplar, guide_offset, [&](int i, auto& a, auto& b, auto& c) HWY_ATTR {
               a = hn::LoadU(kFloats, rows_.coordinate + x + i);
               b = down;
               const auto squared = hn::Sub(hn::Sub(hn::Set(kFloats, 1.0f), hn::Mul(a, a)), down_squared);
               c = hn::Sqrt(hn::Max(squared, hn::Zero(kFloats)));
             });
    }
    lanes &= LanesBetween(-x, rows_.width - 1 - x);
    if (lanes == 0) return 0;
    const std::ptrdiff_t at = std::ptrdiff_t(y) * rows_.width + x;
    lanes &= Nonzero(rows_.usable + at);
    if (lanes == 0) return 0;
    return lanes & Compare(from, candidate.exemplar, guide_offset, [&](int i, auto& a, auto& b, auto& c) HWY_ATTR {
             a = hn::LoadU(kFloats, rows_.normal[0] + at + i);
             b = hn::LoadU(kFloats, rows_.normal[1] + at + i);
             c = hn::LoadU(kFloats, rows_.normal[2] + at + i);
           });
  }

  // `read` loads the exemplar's normals from lane i on. `guide_offset`: null for no offset.
  template <class Read>
  HWY_INLINE std::uint32_t Compare(int from, int exemplar, const glm::vec3* guide_offset, const Read& read) const {
    const auto bound = hn::Set(kFloats, input_.test.bound());
    std::uint32_t bits = 0;
    for (int i = 0; i < kBlock; i += static_cast<int>(hn::Lanes(kFloats))) {
      auto a = hn::Zero(kFloats), b = a, c = a;
      read(i, a, b, c);
      auto x = hn::LoadU(kFloats, row_.normal[0] + from + i);
      auto y = hn::LoadU(kFloats, row_.normal[1] + from + i);
      auto z = hn::LoadU(kFloats, row_.normal[2] + from + i);
      if (guide_offset) {
        x = hn::Add(x, hn::Set(kFloats, guide_offset->x));
        y = hn::Add(y, hn::Set(kFloats, guide_offset->y));
        z = hn::Add(z, hn::Set(kFloats, guide_offset->z));
      }
      const auto dx = hn::Sub(x, a), dy = hn::Sub(y, b), dz = hn::Sub(z, c);
      const auto distance = squares_ ? hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz))
                                     : hn::Add(hn::Add(hn::Abs(dx), hn::Abs(dy)), hn::Abs(dz));
      auto alike = hn::Lt(distance, bound);
      if (light_counts_) {
        const auto extra = LightError(row_.light + from + i, exemplar);
        const auto left = hn::Sub(hn::Set(kFloats, input_.test.threshold()), extra);
        const auto less =
            hn::Lt(distance, squares_ ? hn::Max(hn::Mul(left, left), hn::Set(kFloats, GuideTest::kLeastSquare)) : left);
        const auto zero = hn::Zero(kFloats);
        const auto lit = hn::And(hn::Gt(left, zero), less);
        const auto counts = hn::Gt(extra, zero);
        alike = hn::Or(hn::And(counts, lit), hn::AndNot(counts, alike));
      }
      bits |= BitsOf(kFloats, alike) << i;
    }
    return bits;
  }

  // Illumination::Error, where the weight is above 0.
  HWY_INLINE hn::Vec<decltype(kFloats)> LightError(const float* light, int exemplar) const {
    const auto zero = hn::Zero(kFloats);
    auto luminance = hn::LoadU(kFloats, light);
    luminance = hn::IfThenElseZero(hn::Ge(luminance, zero), luminance);
    const auto luminances = input_.illumination.luminances();
    const auto of_exemplar = hn::Set(kFloats, luminances[static_cast<std::size_t>(exemplar)]);
    const auto weight = hn::Set(kFloats, input_.illumination.weight());
    if (input_.illumination.form() == LuminanceError::kPublished) {
      return hn::Mul(weight, hn::Abs(hn::Sub(luminance, of_exemplar)));
    }
    luminance = hn::Min(luminance, hn::Set(kFloats, input_.illumination.brightest()));
    const auto off = hn::Abs(hn::Sub(luminance, of_exemplar));
    auto least = hn::Abs(hn::Sub(luminance, hn::Set(kFloats, luminances[0])));
    for (std::size_t k = 1; k < luminances.size(); ++k) {
      const auto other = hn::Abs(hn::Sub(luminance, hn::Set(kFloats, luminances[k])));
      least = hn::IfThenElse(hn::Lt(other, least), other, least);
    }
    const auto excess = hn::Sub(off, least);
    return hn::IfThenElseZero(hn::Gt(excess, zero), hn::Mul(weight, excess));
  }

  PixelGuide GuideOf(int place) const {
    PixelGuide guide;
    guide.normal = {row_.normal[0][place], row_.normal[1][place], row_.normal[2][place]};
    guide.light = row_.light ? row_.light[place] : 0.0f;
    return guide;
  }

  // For lanes that accepted a seed on a flat surface: near its border they choose between two seeds.
  HWY_NOINLINE void TakeVaried(TileSeeds& seeds, int seed, int from, std::uint32_t lanes) {
    const TileCandidate& candidate = seeds.Candidate(seed);
    for (; lanes != 0; lanes &= lanes - 1) {
      const int place = from + std::countr_zero(lanes);
      const PixelPosition p{row_.x + place, row_.y};
      Candidate taken{
          {p.x + candidate.offset_x, p.y + candidate.offset_y}, candidate.exemplar, seeds.Variation(seed).guide_offset};
      ChooseAtBorder(input_, seeds, {p, GuideOf(place)}, taken);
      Put(place, taken, seeds.level());
    }
  }

  HWY_NOINLINE void TakeOwn(int place) { Put(place, OwnCandidate(input_, GuideOf(place)), 0); }

  void Put(int place, const Candidate& taken, int level) {
    row_.source_x[place] = static_cast<std::int16_t>(taken.source.x);
    row_.source_y[place] = static_cast<std::int16_t>(taken.source.y);
    row_.how[place] = static_cast<std::uint16_t>(level | taken.exemplar << 8);
    if (!field_.guide_offset.empty()) row_.guide_offset[place] = taken.guide_offset;
  }

  static HWY_INLINE void StoreHow(const std::uint16_t* how, std::int8_t* level, std::uint8_t* exemplar) {
    const hn::Rebind<std::uint8_t, decltype(kWords)> bytes;
    const hn::Rebind<std::int8_t, decltype(kWords)> signed_bytes;
    for (int i = 0; i < kBlock; i += static_cast<int>(hn::Lanes(kWords))) {
      const auto both = hn::LoadU(kWords, how + i);
      const auto low = hn::And(both, hn::Set(kWords, std::uint16_t{0xff})), high = hn::ShiftRight<8>(both);
      hn::StoreU(hn::DemoteTo(signed_bytes, hn::BitCast(kShorts, low)), signed_bytes, level + i);
      hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(kShorts, high)), bytes, exemplar + i);
    }
  }

  // Writes a block's pixels to the field, from its index i on.
  HWY_INLINE void Store(int block, std::size_t i) const {
    const std::uint32_t lanes = row_.wanted[block];
    const int from = block * kBlock;
    if (lanes == 0xffffu) {
      std::memcpy(field_.x.data() + i, row_.source_x + from, kBlock * sizeof row_.source_x[0]);
      std::memcpy(field_.y.data() + i, row_.source_y + from, kBlock * sizeof row_.source_y[0]);
      StoreHow(row_.how + from, field_.level.data() + i, field_.exemplar.data() + i);
    } else if (lanes != 0 && from + kBlock <= tile_.x1 - tile_.x0) {
      StoreLanes(from, lanes, i);
    } else {
      for (std::uint32_t left = lanes; left != 0; left &= left - 1) {
        const int lane = std::countr_zero(left), place = from + lane;
        field_.Set(i + lane, row_.source_x[place], row_.source_y[place], row_.how[place] >> 8, row_.how[place] & 0xff);
      }
    }
    if (field_.guide_offset.empty()) return;
    for (std::uint32_t left = lanes; left != 0; left &= left - 1) {
      field_.guide_offset[i + std::countr_zero(left)] = row_.guide_offset[from + std::countr_zero(left)];
    }
  }

  // Store for some lanes; the other lanes belong to this tile too.
  HWY_INLINE void StoreLanes(int from, std::uint32_t lanes, std::size_t i) const {
    std::int8_t level[kBlock];
    std::uint8_t exemplar[kBlock];
    StoreHow(row_.how + from, level, exemplar);
    for (int k = 0; k < kBlock; k += static_cast<int>(hn::Lanes(kShorts))) {
      const auto mask = MaskFrom(kShorts, lanes >> k);
      StoreSome(kShorts, mask, hn::LoadU(kShorts, row_.source_x + from + k), field_.x.data() + i + k);
      StoreSome(kShorts, mask, hn::LoadU(kShorts, row_.source_y + from + k), field_.y.data() + i + k);
    }
    for (int k = 0; k < kBlock; k += static_cast<int>(hn::Lanes(kBytes))) {
      const hn::RebindToSigned<decltype(kBytes)> levels;
      StoreSome(levels, MaskFrom(levels, lanes >> k), hn::LoadU(levels, level + k), field_.level.data() + i + k);
      StoreSome(kBytes, MaskFrom(kBytes, lanes >> k), hn::LoadU(kBytes, exemplar + k), field_.exemplar.data() + i + k);
    }
  }

  const MatchInput& input_;
  const ExemplarRows rows_;
  const std::uint8_t* const wanted_;
  const int tile_x_;
  Region tile_;  // the part of it that is matched
  TileScratch& scratch_;
  std::vector<TileSeeds>& levels_;
  SourceField& field_;
  const bool squares_, light_counts_;
  int blocks_, first_block_, end_block_;  // all of a row, and the processed ones
  Row row_;
  int open_[Row::kBlocks + 1];  // blocks with pixels that are not settled
  int groups_ = 0;
  Group group_[kTileWidth];
};

void MatchTileRows(const TileJob& job) { TileMatcher(job).Match(); }

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(MatchTileRows);

void MatchTile(const TileJob& job) { HWY_DYNAMIC_DISPATCH(MatchTileRows)(job); }

void ChooseAtBorder(const MatchInput& input, TileSeeds& seeds, const FreeChoice& choice, Candidate& taken) {
  const PixelPosition p = choice.p;
  seeds.Need(p.y >> seeds.level(), p.x, 1);  // if a map gave the nearest, places are not made yet
  const auto [s, t, excess] = seeds.NearestTwo(p.x, p.y);
  if (!InBorderBand(seeds.level(), excess)) return;
  const TileCandidate& second = seeds.Candidate(t);
  if (second.state != TileCandidate::kCandidates || !second.can_vary) return;
  const Candidate other{
      {p.x + second.offset_x, p.y + second.offset_y}, second.exemplar, seeds.Variation(t).guide_offset};
  if (!input.exemplar.Usable(other.source.x, other.source.y)) return;
  if (!input.Alike(choice.guide, other.guide_offset, other.source, other.exemplar)) return;
  const int nearest_off = ToneError(input, taken, seeds.Variation(s).tone);
  const int other_off = ToneError(input, other, seeds.Variation(t).tone);
  if (SecondWins(seeds.level(), excess, nearest_off - other_off)) taken = other;
}

bool MatchStyleBlitTiles(const MatchInput& input, SourceField& field, RowProgress& progress) {
  const Region& region = input.region;
  if (region.empty()) return !progress.cancelled();
  const int first_column = region.x0 / kTileWidth, columns = (region.x1 - 1) / kTileWidth + 1 - first_column;
  const int first_row = region.y0 / kTileHeight, rows = (region.y1 - 1) / kTileHeight + 1 - first_row;
  tbb::enumerable_thread_specific<TileScratch> scratches;
  const ExemplarRows exemplar = input.exemplar.Rows();
  const std::span<const std::uint8_t> wanted = input.wanted.empty() ? input.active : input.wanted;
  tbb::parallel_for(tbb::blocked_range<int>(0, rows * columns, 1), [&](const auto& range) {
    for (int t = range.begin(); t != range.end() && !progress.cancelled(); ++t) {
      const int row = first_row + t / columns;
      TileScratch& scratch = scratches.local();
      scratch.begun = false;
      const int column = first_column + t % columns;
      MatchTile({input, exemplar, column, column * kTileWidth, (column + 1) * kTileWidth, row * kTileHeight,
                 (row + 1) * kTileHeight, wanted, scratch, field});
      if (t % columns != 0) continue;
      progress.Finished(std::min(region.y1, (row + 1) * kTileHeight) - std::max(region.y0, row * kTileHeight));
    }
  });
  return !progress.cancelled();
}

}  // namespace scumble::internal
#endif  // HWY_ONCE
