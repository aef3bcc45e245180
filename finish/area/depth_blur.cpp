#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "finish/area/area_effects.h"
#include "finish/area/oklab_blocks.h"
#include "finish/tone/depth_scale.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "finish/area/depth_blur.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/filter/vector_lane-inl.h"

#ifndef SCUMBLE_FINISH_DEPTH_BLUR_ONCE_
#define SCUMBLE_FINISH_DEPTH_BLUR_ONCE_
namespace scumble::internal {

constexpr std::size_t kBlurSpare = 32;  // values that vectors may reach beyond a row

// Level k holds sums of 2^k × 2^k pixels, and is read by doubling it k times, each place becoming two of
// (1/4, 3/4) of it and its neighbour. A mean of two places s apart has a variance of s² / 4, that doubling one of
// 3 s² / 4, wherever the pixel lies: together (4^k - 1) / 3.
struct BlurLevel {
  int width = 0, height = 0;
  float least = 0.0f;                // sigma of the pixels that it holds, at least
  std::array<FloatPlane, 4> planes;  // colours times alpha, and alpha
};

// One side of the focus. Its level 0 is the picture itself.
struct BlurSide {
  float side = 1.0f;              // 1: beyond the focus, -1: before it
  std::vector<BlurLevel> levels;  // from level 1 on
  std::vector<float> variances;   // of level 0, and of the levels
};

// Two rows of the picture, columns of even and of odd number apart: lightness, a, b, alpha, sigma.
struct BlurQuads {
  std::array<std::array<std::vector<float>, 5>, 4> parts;
};

// What the weights 1/4 and 3/4 make of a level's row and those above and below it, for each of the pixels' rows.
struct RowShares {
  float above, own, below;
};

}  // namespace scumble::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

// Adds the sums of 2 × 2 pixels that the level holds.
void AddQuadsHere(const BlurQuads& quads, float side, float least, std::size_t count,
                  std::array<std::vector<float>, 4>& sums) {
  const Floats d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    Lane sum[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    for (const auto& part : quads.parts) {
      const Lane sigma = Lane(hn::LoadU(d, part[4].data() + i)) * side;
      const Lane alpha = hn::IfThenElseZero(hn::Ge(sigma.v, hn::Set(d, least)), hn::LoadU(d, part[3].data() + i));
      for (std::size_t c = 0; c < 3; ++c) sum[c] = sum[c] + alpha * Lane(hn::LoadU(d, part[c].data() + i));
      sum[3] = sum[3] + alpha;
    }
    for (std::size_t c = 0; c < 4; ++c) {
      float* const to = sums[c].data() + i;
      hn::StoreU((Lane(hn::LoadU(d, to)) + sum[c]).v, d, to);
    }
  }
}

// Makes `count` sums of neighbours, in place.
void HalveHere(float* row, std::size_t count) {
  const Floats d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    hn::Vec<Floats> even, odd;
    hn::LoadInterleaved2(d, row + 2 * i, even, odd);
    hn::StoreU(hn::Add(even, odd), d, row + i);
  }
}

// A row between rows of a level.
void BetweenHere(const RowShares& shares, const float* above, const float* own, const float* below, std::size_t count,
                 float* out) {
  const Floats d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Lane sum = Lane(hn::LoadU(d, own + i)) * shares.own +
                     (Lane(hn::LoadU(d, above + i)) * shares.above + Lane(hn::LoadU(d, below + i)) * shares.below);
    hn::StoreU(sum.v, d, out + i);
  }
}

// Twice as many places; there must be one before the first and one behind the last.
void DoubleHere(const float* row, std::size_t count, float* out) {
  const Floats d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Lane own = Lane(hn::LoadU(d, row + i)) * 0.75f;
    const Lane even = own + Lane(hn::LoadU(d, row + i - 1)) * 0.25f,
               odd = own + Lane(hn::LoadU(d, row + i + 1)) * 0.25f;
    hn::StoreInterleaved2(even.v, odd.v, d, out + 2 * i);
  }
}

// Blurs the block's pixels on that side of the focus, `sigmas` being theirs and `rows` the levels' four values at the
// first. Between two levels their shares go by variance, so that the mean of both has the pixel's own.
void MixHere(const BlurSide& side, const std::vector<std::array<const float*, 4>>& rows, const float* sigmas,
             std::size_t count, OklabBlock& block) {
  const Floats d;
  const int levels = static_cast<int>(side.levels.size());
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Lane sigma = Lane(hn::LoadU(d, sigmas + i)) * side.side;
    Choice changes =
        hn::And(Less(0.0f, sigma), hn::Lt(hn::Iota(d, static_cast<float>(i)), hn::Set(d, static_cast<float>(count))));
    if (hn::AllFalse(d, changes)) continue;
    const Lane variance = sigma * sigma;
    Lane upper = 1.0f, from = 0.0f, to = side.variances[1];  // the level above, and the variances around
    for (int k = 1; k < levels; ++k) {
      const Choice is_more = Less(side.variances[std::size_t(k)], variance);
      upper = Select(is_more, static_cast<float>(k + 1), upper);
      from = Select(is_more, side.variances[std::size_t(k)], from);
      to = Select(is_more, side.variances[std::size_t(k) + 1], to);
    }
    const Lane share = Min((variance - from) / (to - from), 1.0f);
    const int least = static_cast<int>(
                  hn::GetLane(hn::MinOfLanes(d, Select(changes, upper, static_cast<float>(levels)).v))),
              most = static_cast<int>(hn::GetLane(hn::MaxOfLanes(d, Select(changes, upper, 1.0f).v)));
    float* const out[3] = {block.lightness.data() + i, block.a.data() + i, block.b.data() + i};
    Lane given[3], less[3], more[3];
    for (std::size_t c = 0; c < 3; ++c) given[c] = less[c] = more[c] = hn::Load(d, out[c]);
    for (int k = std::max(least - 1, 1); k <= most; ++k) {
      const Choice is_upper = hn::And(changes, hn::Eq(upper.v, hn::Set(d, static_cast<float>(k)))),
                   is_lower = hn::And(changes, hn::Eq(upper.v, hn::Set(d, static_cast<float>(k + 1))));
      const auto& row = rows[std::size_t(k) - 1];
      const Lane alpha = hn::LoadU(d, row[3] + i);
      const Choice counts = Less(1e-6f, alpha);
      changes = hn::And(changes, hn::Or(counts, hn::Not(hn::Or(is_upper, is_lower))));
      const Lane per_alpha = Lane(1.0f) / Select(counts, alpha, 1.0f);
      for (std::size_t c = 0; c < 3; ++c) {
        const Lane color = Lane(hn::LoadU(d, row[c] + i)) * per_alpha;
        more[c] = Select(is_upper, color, more[c]);
        less[c] = Select(is_lower, color, less[c]);
      }
    }
    for (std::size_t c = 0; c < 3; ++c)
      hn::Store(Select(changes, less[c] + share * (more[c] - less[c]), given[c]).v, d, out[c]);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {
namespace {

HWY_EXPORT(AddQuadsHere);
HWY_EXPORT(HalveHere);
HWY_EXPORT(BetweenHere);
HWY_EXPORT(DoubleHere);
HWY_EXPORT(MixHere);

constexpr int kStrip = 32;  // rows that one thread sums at a time

// By pixel the sigma of the blur, below 0 before the focus; and the largest on each side.
struct BlurSigmas {
  FloatPlane plane;
  float beyond = 0.0f, before = 0.0f;
};

BlurSigmas SigmasOf(const DepthPass& pass, double most, const FinishFrame& frame) {
  const DepthScale scale(pass, frame.measures);
  const auto depth = frame.guides->Plane(Layer::kDepth);
  BlurSigmas sigmas;
  sigmas.plane.resize(depth.size() + kBlurSpare);
  std::fill(sigmas.plane.end() - kBlurSpare, sigmas.plane.end(), 0.0f);
  using Most = std::array<float, 2>;
  const Most largest = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, depth.size(), 1 << 14), Most{0.0f, 0.0f},
      [&](const auto& part, Most so_far) {
        float* const out = sigmas.plane.data();
        scale.Shares(depth.data() + part.begin(), part.size(), out + part.begin());
        auto& [beyond, before] = so_far;
        const auto factor = static_cast<float>(most);
        for (std::size_t i = part.begin(); i != part.end(); ++i) {
          const float sigma = factor * out[i];
          out[i] = scale.IsBeforeFocus(depth[i]) ? -sigma : sigma;
          beyond = std::max(beyond, out[i]), before = std::max(before, -out[i]);
        }
        return so_far;
      },
      [](const Most& one, const Most& other) {
        return Most{std::max(one[0], other[0]), std::max(one[1], other[1])};
      });
  sigmas.beyond = largest[0], sigmas.before = largest[1];
  return sigmas;
}

int Ceiled(int size, int by) { return (size + by - 1) / by; }

// The side's levels, up to the first of that sigma. Their planes have a row for each strip at least.
BlurSide SideOf(float side, float most, int width, int height) {
  BlurSide made{side, {}, {0.0f}};
  if (!(most > 0.0f)) return made;
  for (int k = 1; made.variances.back() < most * most; ++k) {
    const int factor = 1 << k;
    BlurLevel level;
    level.width = Ceiled(width, factor), level.height = Ceiled(height, std::min(factor, kStrip));
    // What is blurred by the sigma of the level below, and a little less, whatever the rounding.
    level.least = k == 1 ? 0.499f : 0.999f * std::sqrt(made.variances.back());
    for (auto& plane : level.planes) plane.resize(std::size_t(level.width) * std::size_t(level.height) + kBlurSpare);
    made.levels.push_back(std::move(level));
    made.variances.push_back(static_cast<float>((double(factor) * factor - 1.0) / 3.0));
  }
  return made;
}

// Sums of one level over rows so far, by pairs of columns.
using LevelSums = std::array<std::vector<float>, 4>;

// Puts the sums into row v of the level of 2^halvings pairs of columns, and clears them.
void PutSums(int halvings, std::size_t pairs, int v, LevelSums& sums, BlurLevel& level) {
  for (std::size_t c = 0; c < 4; ++c) {
    std::vector<float>& row = sums[c];
    std::size_t count = pairs;
    for (int i = 0; i < halvings; ++i) {
      row[count] = 0.0f;  // where it is odd
      count = (count + 1) / 2;
      HWY_DYNAMIC_DISPATCH(HalveHere)(row.data(), count);
    }
    std::copy_n(row.begin(), level.width, level.planes[c].begin() + std::ptrdiff_t(v) * level.width);
    std::fill(row.begin(), row.end(), 0.0f);
  }
}

// Rows y and y + 1; one that the picture does not have is transparent.
void LoadQuads(const Picture& picture, const FloatPlane& sigmas, int y, OklabBlock& block, BlurQuads& quads) {
  const auto width = static_cast<std::size_t>(picture.width);
  for (int r = 0; r < 2; ++r) {
    auto &even = quads.parts[std::size_t(2 * r)], &odd = quads.parts[std::size_t(2 * r + 1)];
    if (y + r >= picture.height) {
      for (auto* part : {&even, &odd}) std::fill((*part)[3].begin(), (*part)[3].end(), 0.0f);
      continue;
    }
    const std::size_t row = std::size_t(y + r) * width;
    for (std::size_t x = 0; x < width; x += kOklabBlock) {
      const std::size_t count = std::min(kOklabBlock, width - x), pairs = (count + 1) / 2;
      const std::uint16_t* const texels = picture.rgba.data() + 4 * (row + x);
      OklabFromTexels(texels, count, block);
      const auto split = [&](std::size_t c, const float* from) {
        float *const to_even = even[c].data() + x / 2, *const to_odd = odd[c].data() + x / 2;
        for (std::size_t i = 0; i < pairs; ++i) to_even[i] = from[2 * i], to_odd[i] = from[2 * i + 1];
      };
      split(0, block.lightness.data()), split(1, block.a.data()), split(2, block.b.data());
      split(4, sigmas.data() + row + x);
      const auto alpha = [&](std::size_t i) { return static_cast<float>(texels[4 * i + 3]) * (1.0f / 65535.0f); };
      for (std::size_t i = 0; i < count / 2; ++i) {
        even[3][x / 2 + i] = alpha(2 * i), odd[3][x / 2 + i] = alpha(2 * i + 1);
      }
      if (count % 2 == 1) even[3][x / 2 + pairs - 1] = alpha(count - 1), odd[3][x / 2 + pairs - 1] = 0.0f;
    }
  }
}

// Fills the levels of both sides, a strip of rows at a time: all of it stays in the cache.
void SumLevels(const Picture& picture, const FloatPlane& sigmas, std::array<BlurSide, 2>& sides) {
  const std::size_t pairs = (std::size_t(picture.width) + 1) / 2;
  tbb::parallel_for(0, Ceiled(picture.height, kStrip), [&](int strip) {
    BlurQuads quads;
    for (auto& part : quads.parts) {
      for (auto& plane : part) plane.resize(pairs + kBlurSpare);
    }
    std::array<std::vector<LevelSums>, 2> sums;
    for (std::size_t s = 0; s < 2; ++s) {
      sums[s].resize(sides[s].levels.size());
      for (LevelSums& level : sums[s]) {
        for (auto& row : level) row.resize(pairs + kBlurSpare);
      }
    }
    OklabBlock block{};
    const int end = std::min(picture.height, (strip + 1) * kStrip);
    for (int y = strip * kStrip; y < end; y += 2) {
      LoadQuads(picture, sigmas, y, block, quads);
      for (std::size_t s = 0; s < 2; ++s) {
        BlurSide& side = sides[s];
        for (std::size_t k = 0; k < side.levels.size(); ++k) {
          BlurLevel& level = side.levels[k];
          HWY_DYNAMIC_DISPATCH(AddQuadsHere)(quads, side.side, level.least, pairs, sums[s][k]);
          const int rows = std::min(2 << k, kStrip);
          if ((y + 2) % rows == 0 || y + 2 >= end) PutSums(static_cast<int>(k), pairs, y / rows, sums[s][k], level);
        }
      }
    }
  });
  // Places higher than a strip.
  for (BlurSide& side : sides) {
    for (std::size_t k = 0; k < side.levels.size(); ++k) {
      BlurLevel& level = side.levels[k];
      const int together = std::max(1, (2 << k) / kStrip), height = Ceiled(level.height, together);
      const auto width = static_cast<std::size_t>(level.width);
      for (auto& plane : level.planes) {
        for (int v = 0; v < level.height; ++v) {
          const auto from = plane.begin() + std::ptrdiff_t(v) * level.width,
                     to = plane.begin() + std::ptrdiff_t(v / together) * level.width;
          if (from == to) continue;
          for (std::size_t u = 0; u < width; ++u)
            to[std::ptrdiff_t(u)] = from[std::ptrdiff_t(u)] + (v % together == 0 ? 0.0f : to[std::ptrdiff_t(u)]);
        }
      }
      level.height = height;
    }
  }
}

// By row of pixels within one of level k's places.
std::vector<RowShares> SharesOfLevel(int k) {
  std::vector<RowShares> shares{{0.0f, 1.0f, 0.0f}};
  for (int i = 0; i < k; ++i) {
    const auto count = static_cast<int>(shares.size());
    // Beyond its ends a place's rows are its neighbours', whose shares are the same but one place on.
    const auto at = [&](int row) -> RowShares {
      if (row < 0) return {shares.back().own, shares.back().below, 0.0f};
      if (row == count) return {0.0f, shares.front().above, shares.front().own};
      return shares[std::size_t(row)];
    };
    std::vector<RowShares> doubled;
    for (int row = 0; row < 2 * count; ++row) {
      const RowShares near = at(row / 2), next = at(row % 2 == 0 ? row / 2 - 1 : row / 2 + 1);
      doubled.push_back({0.75f * near.above + 0.25f * next.above, 0.75f * near.own + 0.25f * next.own,
                         0.75f * near.below + 0.25f * next.below});
    }
    shares = std::move(doubled);
  }
  return shares;
}

// Rows of a side's levels in the picture's pixels. Of one thread.
class LevelRows {
 public:
  LevelRows(const BlurSide& side, int width) : side_(side) {
    for (std::size_t k = 0; k < side.levels.size(); ++k) {
      shares_.push_back(SharesOfLevel(static_cast<int>(k) + 1));
      made_.emplace_back();
      for (auto& row : made_.back()) row.resize((std::size_t(side.levels[k].width) << (k + 1)) + 2 * kBlurSpare);
    }
    for (auto& row : halves_) row.resize(std::size_t(width) + (std::size_t(1) << side.levels.size()) + 2 * kBlurSpare);
  }

  // Level k, from 0 on, at row y.
  void Make(std::size_t k, int y) {
    const BlurLevel& level = side_.levels[k];
    const int v = y >> (k + 1);
    const RowShares& shares = shares_[k][std::size_t(y) & ((std::size_t(2) << k) - 1)];
    for (std::size_t c = 0; c < 4; ++c) {
      const auto row = [&](int at) {
        return level.planes[c].data() + std::ptrdiff_t(std::clamp(at, 0, level.height - 1)) * level.width;
      };
      auto count = static_cast<std::size_t>(level.width);
      float* from = halves_[0].data() + kBlurSpare;
      HWY_DYNAMIC_DISPATCH(BetweenHere)(shares, row(v - 1), row(v), row(v + 1), count, from);
      for (std::size_t i = 0; i <= k; ++i) {
        from[-1] = from[0], from[count] = from[count - 1];
        float* const to = (i == k ? made_[k][c] : halves_[1 - i % 2]).data() + kBlurSpare;
        HWY_DYNAMIC_DISPATCH(DoubleHere)(from, count, to);
        from = to, count *= 2;
      }
    }
  }
  // What Make has made of level k, from pixel x on.
  std::array<const float*, 4> At(std::size_t k, std::size_t x) const {
    std::array<const float*, 4> rows;
    for (std::size_t c = 0; c < 4; ++c) rows[c] = made_[k][c].data() + kBlurSpare + x;
    return rows;
  }

 private:
  const BlurSide& side_;
  std::vector<std::vector<RowShares>> shares_;
  std::vector<std::array<std::vector<float>, 4>> made_;
  std::array<std::vector<float>, 2> halves_;
};

// The levels that pixels of those sigmas look at: from the first to before the last, counted from 0.
struct LevelRange {
  std::size_t first = 0, last = 0;
};

LevelRange LevelsFor(const BlurSide& side, const float* sigmas, std::size_t count) {
  float least = 1e9f, most = 0.0f;
  for (std::size_t i = 0; i < count; ++i) {
    const float sigma = sigmas[i] * side.side;
    most = std::max(most, sigma), least = std::min(least, sigma > 0.0f ? sigma : 1e9f);
  }
  LevelRange range;
  if (!(most > 0.0f)) return range;
  while (range.last < side.levels.size() && side.variances[range.last] < most * most) ++range.last;
  while (range.first + 1 < side.levels.size() && side.variances[range.first + 2] < least * least) ++range.first;
  return range;
}

}  // namespace

void BlurByDepth(const DepthPass& pass, double strength, std::span<const std::uint8_t> only, const FinishFrame& frame,
                 Picture& picture) {
  const BlurSigmas sigmas = SigmasOf(pass, pass.blur * frame.scale, frame);
  std::array<BlurSide, 2> sides{SideOf(1.0f, sigmas.beyond, picture.width, picture.height),
                                SideOf(-1.0f, sigmas.before, picture.width, picture.height)};
  SumLevels(picture, sigmas.plane, sides);
  const auto width = static_cast<std::size_t>(picture.width);
  tbb::parallel_for(tbb::blocked_range<int>(0, picture.height, kStrip), [&](const auto& strip) {
    std::array<LevelRows, 2> rows{LevelRows(sides[0], picture.width), LevelRows(sides[1], picture.width)};
    std::vector<std::array<const float*, 4>> at;
    for (int y = strip.begin(); y != strip.end(); ++y) {
      const float* const row = sigmas.plane.data() + std::size_t(y) * width;
      std::array<LevelRange, 2> used;
      for (std::size_t s = 0; s < 2; ++s) {
        used[s] = LevelsFor(sides[s], row, width);
        for (std::size_t k = used[s].first; k < used[s].last; ++k) rows[s].Make(k, y);
      }
      if (used[0].last + used[1].last == 0) continue;
      for (std::size_t x = 0; x < width; x += kOklabBlock) {
        const std::size_t count = std::min(kOklabBlock, width - x);
        std::uint16_t* const texels = picture.At(static_cast<int>(x), y);
        OklabBlock given, made;
        OklabFromTexels(texels, count, given);
        made = given;
        for (std::size_t s = 0; s < 2; ++s) {
          if (used[s].last == 0) continue;
          at.resize(sides[s].levels.size());
          for (std::size_t k = 0; k < at.size(); ++k) at[k] = rows[s].At(k, x);
          HWY_DYNAMIC_DISPATCH(MixHere)(sides[s], at, row + x, count, made);
        }
        PutBlock(given, static_cast<float>(strength), only.empty() ? nullptr : only.data() + std::size_t(y) * width + x,
                 count, made, texels);
      }
    }
  });
}

}  // namespace scumble::internal
#endif
