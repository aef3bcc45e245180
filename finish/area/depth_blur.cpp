#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "core/filter/region.h"
#include "core/image/fragments.h"
#include "finish/area/area_effects.h"
#include "finish/area/gaussian_rows.h"
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

constexpr std::size_t kBlurSpare = 16;  // values that a vector may reach beyond a plane

// The picture, and how its pixels are blurred: sigma in pixels, below 0 before the focus.
struct BlurSource {
  int width = 0, height = 0;
  FloatPlane lightness, a, b, alpha, sigma;
  // Of the surface whose sigma it is; the rest is background, which is blurred by `most`. 1 in focus.
  FloatPlane share;
  float most = 0.0f;
};

// One side of the focus under a Gaussian of `sigma`, smaller by `factor` each way: colours times weights, and weights.
// Only pixels count that are blurred by half as much or more. It holds the pixels from (left, top) to (right, bottom).
struct BlurLevel {
  double sigma = 0.0;
  int factor = 1, left = 0, top = 0, right = 0, bottom = 0;
  int width = 0, height = 0;  // in places of its own
  std::array<FloatPlane, 4> planes;
};

// Part of a row whose weighted colours are added to sums.
struct BlurRow {
  const float *lightness, *a, *b, *alpha, *sigma;
  float side;   // 1: pixels beyond the focus count, -1: before it
  float least;  // sigma that they have
  std::size_t count;
};

// A side's levels, from the finest on; the level below the first is the picture itself.
struct BlurSide {
  float side = 1.0f;
  std::vector<BlurLevel> levels;
  std::vector<float> variances;  // of the picture, 0, and of the levels
};

}  // namespace scumble::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

void AddRowHere(const BlurRow& row, float* const* sums) {
  const Floats d;
  for (std::size_t i = 0; i < row.count; i += hn::Lanes(d)) {
    const Lane sigma = Lane(hn::LoadU(d, row.sigma + i)) * row.side;
    const Lane weight = hn::IfThenElseZero(hn::Ge(sigma.v, hn::Set(d, row.least)), hn::LoadU(d, row.alpha + i));
    const auto add = [&](float* sum, Lane value)
                         HWY_ATTR { hn::StoreU((Lane(hn::LoadU(d, sum + i)) + value).v, d, sum + i); };
    add(sums[0], weight * Lane(hn::LoadU(d, row.lightness + i)));
    add(sums[1], weight * Lane(hn::LoadU(d, row.a + i)));
    add(sums[2], weight * Lane(hn::LoadU(d, row.b + i)));
    add(sums[3], weight);
  }
}

struct BlurColor {
  Lane lightness, a, b;
  Choice counts;  // whether anything does there
};

// The level's colours at pixels of one row, by straight lines between its own.
HWY_INLINE BlurColor ColorsAt(const BlurLevel& level, Lane x, int y) {
  const Floats d;
  const Ints di;
  // The places whose middles lie around; half a place above 0 keeps conversion a floor.
  const float per_factor = 1.0f / static_cast<float>(level.factor);
  const Lane u = Max((x - static_cast<float>(level.left) + 0.5f) * per_factor + 0.5f, 0.0f);
  const float v = (static_cast<float>(y - level.top) + 0.5f) * per_factor + 0.5f;
  const auto column = hn::ConvertTo(di, u.v), last = hn::Set(di, level.width - 1);
  const auto left = hn::Min(hn::Max(hn::Sub(column, hn::Set(di, 1)), hn::Zero(di)), last),
             right = hn::Min(column, last);
  const Lane share = u - Lane(hn::ConvertTo(d, column)), rest = 1.0f - share;
  const int row = static_cast<int>(v);
  const Lane below = v - static_cast<float>(row), above = 1.0f - (v - static_cast<float>(row));
  const std::size_t first = std::size_t(std::max(row - 1, 0)) * std::size_t(level.width),
                    second = std::size_t(std::min(row, level.height - 1)) * std::size_t(level.width);
  Lane sum[4];
  for (std::size_t c = 0; c < 4; ++c) {
    const float* const plane = level.planes[c].data();
    if (level.factor == 1) {
      sum[c] = hn::GatherIndex(d, plane + first, left);
      continue;
    }
    const Lane upper =
        Lane(hn::GatherIndex(d, plane + first, left)) * rest + Lane(hn::GatherIndex(d, plane + first, right)) * share;
    const Lane lower =
        Lane(hn::GatherIndex(d, plane + second, left)) * rest + Lane(hn::GatherIndex(d, plane + second, right)) * share;
    sum[c] = upper * above + lower * below;
  }
  const Choice counts = Less(1e-6f, sum[3]);
  const Lane weight = Select(counts, sum[3], 1.0f);
  return {sum[0] / weight, sum[1] / weight, sum[2] / weight, counts};
}

// Blurs the block's pixels on that side of the focus, `sigma` being theirs and (x, y) the first. Between two levels
// their shares go by variance, so that the mean of both has the pixel's own.
void GatherHere(const BlurSide& side, const float* sigmas, int x, int y, std::size_t count, OklabBlock& block) {
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
    const Lane pixel = hn::Iota(d, static_cast<float>(x) + static_cast<float>(i));
    Lane less[3] = {hn::Load(d, block.lightness.data() + i), hn::Load(d, block.a.data() + i),
                    hn::Load(d, block.b.data() + i)};
    const Lane given[3] = {less[0], less[1], less[2]};
    Lane more[3] = {less[0], less[1], less[2]};
    for (int k = std::max(least - 1, 1); k <= most; ++k) {
      const Choice is_upper = hn::And(changes, hn::Eq(upper.v, hn::Set(d, static_cast<float>(k)))),
                   is_lower = hn::And(changes, hn::Eq(upper.v, hn::Set(d, static_cast<float>(k + 1))));
      if (hn::AllFalse(d, hn::Or(is_upper, is_lower))) continue;
      const BlurColor color = ColorsAt(side.levels[std::size_t(k) - 1], pixel, y);
      changes = hn::And(changes, hn::Or(color.counts, hn::Not(hn::Or(is_upper, is_lower))));
      const Lane colors[3] = {color.lightness, color.a, color.b};
      for (int c = 0; c < 3; ++c) {
        more[c] = Select(is_upper, colors[c], more[c]);
        less[c] = Select(is_lower, colors[c], less[c]);
      }
    }
    float* const out[3] = {block.lightness.data() + i, block.a.data() + i, block.b.data() + i};
    for (int c = 0; c < 3; ++c)
      hn::Store(Select(changes, less[c] + share * (more[c] - less[c]), given[c]).v, d, out[c]);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {
namespace {

HWY_EXPORT(AddRowHere);
HWY_EXPORT(GatherHere);

constexpr double kFinest = 1.0;    // sigma of the finest level, at most, pixels
constexpr double kSmallest = 1.0;  // sigma of a level in its own pixels, at least

// A pixel that a stroke of a painted edge fills for the most part is blurred as the stroke's surface.
void TakeSigmaOfOwners(std::span<const EdgeStroke> strokes, BlurSource& source) {
  std::vector<float> of_strokes;
  for (const EdgeStroke& stroke : strokes) of_strokes.push_back(source.sigma[stroke.owner]);
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    if (2 * strokes[i].own[3] < strokes[i].mixed[3]) continue;
    source.sigma[strokes[i].pixel] = of_strokes[i], source.share[strokes[i].pixel] = 1.0f;
  }
}

BlurSource SourceOf(const FinishStep& step, double most, const FinishFrame& frame, const Picture& picture) {
  const DepthScale scale(std::get<DepthPass>(step.pass.effect), frame.measures);
  const auto depth = frame.guides->Plane(Layer::kDepth), coverage = frame.guides->Plane(Layer::kCoverage);
  BlurSource source;
  source.width = picture.width, source.height = picture.height;
  source.most = static_cast<float>(most);
  for (auto* plane : {&source.lightness, &source.a, &source.b, &source.alpha, &source.sigma, &source.share}) {
    plane->resize(depth.size() + kBlurSpare);
    std::fill(plane->end() - kBlurSpare, plane->end(), 0.0f);
  }
  ForEachOklabBlock(depth.size(), [&](std::size_t first, std::size_t count) {
    const std::uint16_t* const texels = picture.rgba.data() + 4 * first;
    OklabBlock block;
    OklabFromTexels(texels, count, block);
    std::copy_n(block.lightness.begin(), count, source.lightness.data() + first);
    std::copy_n(block.a.begin(), count, source.a.data() + first);
    std::copy_n(block.b.begin(), count, source.b.data() + first);
    float* const sigmas = source.sigma.data() + first;
    scale.Shares(depth.data() + first, count, sigmas);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t p = first + i;
      source.alpha[p] = static_cast<float>(texels[4 * i + 3]) * (1.0f / 65535.0f);
      sigmas[i] *= static_cast<float>(scale.IsBeforeFocus(depth[p]) ? -most : most);
      const bool is_mixed = texels[4 * i + 3] == 65535 && coverage[p] > 0.0f;
      const float behind = is_mixed ? 1.0f - std::min(coverage[p], 1.0f) : 0.0f;
      source.share[p] = 1.0f - behind * std::min(std::fabs(sigmas[i]), 1.0f);  // in focus a pixel stays as it is
    }
  });
  // On a sheet what lies beside strokes is blurred as the background: as their surface they would be cut out of that.
  if (step.pass.at != FinishPass::Stage::kSheet) TakeSigmaOfOwners(frame.strokes, source);
  if (step.pass.at == FinishPass::Stage::kGuides) std::ranges::fill(source.share, 1.0f);  // nothing is mixed in
  return source;
}

// Levels of doubling sigma up to `most`. Without places yet.
std::vector<BlurLevel> LevelsUpTo(double most) {
  int count = 1;
  while (most > kFinest * double(1 << (count - 1))) ++count;
  std::vector<BlurLevel> levels{std::size_t(count)};
  for (int k = 0; k < count; ++k) {
    BlurLevel& level = levels[std::size_t(k)];
    level.sigma = most / double(1 << (count - 1 - k));
    while (level.sigma / (2 * level.factor) >= kSmallest) level.factor *= 2;
  }
  return levels;
}

// The smallest region that holds all pixels on a side of the focus, and those of the pixels that look at each level:
// at the first whose sigma is not below their own, and at the one before.
struct BlurRegions {
  Region all;
  std::vector<Region> of_level;
};

void Widen(Region& region, const Region& by) {
  if (by.empty()) return;
  region = {std::min(region.x0, by.x0), std::min(region.y0, by.y0), std::max(region.x1, by.x1),
            std::max(region.y1, by.y1)};
}

BlurRegions RegionsOf(const BlurSource& source, float side, const std::vector<BlurLevel>& levels) {
  const Region empty{source.width, source.height, 0, 0};
  const auto level_of = [&](float sigma) {
    std::size_t level = 0;
    while (level + 1 < levels.size() && sigma * sigma > static_cast<float>(levels[level].sigma * levels[level].sigma))
      ++level;
    return level;
  };
  return tbb::parallel_reduce(
      tbb::blocked_range<int>(0, source.height, 16), BlurRegions{empty, std::vector<Region>(levels.size(), empty)},
      [&](const auto& rows, BlurRegions regions) {
        for (int y = rows.begin(); y != rows.end(); ++y) {
          const float* const row = source.sigma.data() + std::size_t(y) * std::size_t(source.width);
          const float* const shares = source.share.data() + std::size_t(y) * std::size_t(source.width);
          for (int x = 0; x < source.width; ++x) {
            const auto look = [&](float sigma) {
              if (!(sigma > 0.0f)) return;
              const std::size_t level = level_of(sigma);
              const Region pixel{x, y, x + 1, y + 1};
              Widen(regions.of_level[level], pixel);
              if (level > 0) Widen(regions.of_level[level - 1], pixel);
            };
            look(row[x] * side);
            if (shares[x] < 1.0f) look(source.most * side);
          }
        }
        for (const Region& one : regions.of_level) Widen(regions.all, one);
        return regions;
      },
      [](BlurRegions one, const BlurRegions& other) {
        Widen(one.all, other.all);
        for (std::size_t k = 0; k < one.of_level.size(); ++k) Widen(one.of_level[k], other.of_level[k]);
        return one;
      });
}

// Sums of the level's place row v.
void ReduceRow(const BlurSource& source, float side, int v, std::array<std::vector<float>, 4>& sums, BlurLevel& level) {
  const int f = level.factor, wide = level.right - level.left;
  for (auto& sum : sums) std::fill_n(sum.begin(), wide, 0.0f);
  float* const to[4] = {sums[0].data(), sums[1].data(), sums[2].data(), sums[3].data()};
  for (int y = level.top + v * f; y < std::min(level.bottom, level.top + v * f + f); ++y) {
    const std::size_t first = std::size_t(y) * std::size_t(source.width) + std::size_t(level.left);
    // A little less, so that a pixel of just that sigma counts whatever the rounding.
    const BlurRow row{source.lightness.data() + first,
                      source.a.data() + first,
                      source.b.data() + first,
                      source.alpha.data() + first,
                      source.sigma.data() + first,
                      side,
                      static_cast<float>(0.499 * level.sigma),
                      std::size_t(wide)};
    HWY_DYNAMIC_DISPATCH(AddRowHere)(row, to);
  }
  for (std::size_t c = 0; c < 4; ++c) {
    float* const out = level.planes[c].data() + std::size_t(v) * std::size_t(level.width);
    if (f == 1) {
      std::copy_n(to[c], wide, out);
      continue;
    }
    for (int u = 0; u < level.width; ++u) {
      float sum = 0.0f;
      for (int x = u * f; x < std::min(wide, u * f + f); ++x) sum += to[c][x];
      out[u] = sum;
    }
  }
}

// The levels' sums, all of a strip of rows while it is in the cache.
void ReduceAll(const BlurSource& source, float side, std::vector<BlurLevel>& levels) {
  const int strip = std::max(8, levels.back().factor);
  tbb::parallel_for(tbb::blocked_range<int>(0, (source.height + strip - 1) / strip, 1), [&](const auto& strips) {
    std::array<std::vector<float>, 4> sums;  // of a row, by column of the picture
    for (auto& sum : sums) sum.resize(std::size_t(source.width) + kBlurSpare);
    for (int y = strips.begin() * strip; y < strips.end() * strip; y += strip) {
      for (BlurLevel& level : levels) {
        const int first = std::max(0, (y - level.top) / level.factor),
                  last = std::min(level.height, (y + strip - level.top) / level.factor);
        for (int v = first; v < last; ++v) ReduceRow(source, side, v, sums, level);
      }
    }
  });
}

// Only the part of each level that pixels look at, and what a Gaussian reaches around.
BlurSide SideOf(const BlurSource& source, float side, double most) {
  BlurSide made{side, LevelsUpTo(most), {0.0f}};
  const BlurRegions regions = RegionsOf(source, side, made.levels);
  if (regions.all.empty()) return {};
  for (std::size_t k = 0; k < made.levels.size(); ++k) {
    BlurLevel& level = made.levels[k];
    made.variances.push_back(static_cast<float>(level.sigma * level.sigma));
    const Region& used = regions.of_level[k];
    if (used.empty()) continue;
    // Blocks begin at multiples of their size, whatever is looked at.
    const int f = level.factor, around = static_cast<int>(std::ceil(3.0 * level.sigma)) + 2 * f;
    level.left = std::max(regions.all.x0, used.x0 - around) / f * f;
    level.top = std::max(regions.all.y0, used.y0 - around) / f * f;
    level.right = std::min(regions.all.x1, used.x1 + around);
    level.bottom = std::min(regions.all.y1, used.y1 + around);
    level.width = (level.right - level.left + f - 1) / f, level.height = (level.bottom - level.top + f - 1) / f;
    for (auto& plane : level.planes) plane.resize(std::size_t(level.width) * std::size_t(level.height));
  }
  ReduceAll(source, side, made.levels);
  for (BlurLevel& level : made.levels) {
    if (level.width == 0) continue;
    // Blocks of f pixels, and straight lines between their middles, have a variance of their own.
    const double squared = double(level.factor) * level.factor;
    const double own = (squared - 1.0) / 12.0 + (level.factor > 1 ? squared / 6.0 : 0.0);
    for (auto& plane : level.planes)
      plane = Blurred(plane, level.width, level.height, std::sqrt((level.sigma * level.sigma - own) / squared));
  }
  return made;
}

// Where a pixel shows background beside its surface, that is blurred by its own sigma.
void MixBackground(const BlurSource& source, const BlurSide& beyond, int x, int y, std::size_t count,
                   const OklabBlock& given, OklabBlock& block) {
  const float* const shares = source.share.data() + std::size_t(y) * std::size_t(source.width) + std::size_t(x);
  if (beyond.levels.empty() || std::all_of(shares, shares + count, [](float share) { return share >= 1.0f; })) return;
  std::array<float, kOklabBlock> sigmas;
  for (std::size_t i = 0; i < count; ++i) sigmas[i] = shares[i] < 1.0f ? source.most : 0.0f;
  OklabBlock behind = given;
  HWY_DYNAMIC_DISPATCH(GatherHere)(beyond, sigmas.data(), x, y, count, behind);
  for (std::size_t i = 0; i < count; ++i) {
    if (!(shares[i] < 1.0f)) continue;
    block.lightness[i] = behind.lightness[i] + (block.lightness[i] - behind.lightness[i]) * shares[i];
    block.a[i] = behind.a[i] + (block.a[i] - behind.a[i]) * shares[i];
    block.b[i] = behind.b[i] + (block.b[i] - behind.b[i]) * shares[i];
  }
}

}  // namespace

void BlurByDepth(const FinishStep& step, const FinishFrame& frame, Picture& picture) {
  const auto strength = static_cast<float>(step.pass.strength);
  const double most = std::get<DepthPass>(step.pass.effect).blur * frame.scale;
  const BlurSource source = SourceOf(step, most, frame, picture);
  const BlurSide sides[2] = {SideOf(source, 1.0f, most), SideOf(source, -1.0f, most)};
  tbb::parallel_for(tbb::blocked_range<int>(0, picture.height, 8), [&](const auto& rows) {
    for (int y = rows.begin(); y != rows.end(); ++y) {
      for (int x = 0; x < picture.width; x += static_cast<int>(kOklabBlock)) {
        const std::size_t first = std::size_t(y) * std::size_t(picture.width) + std::size_t(x),
                          count = std::min(kOklabBlock, std::size_t(picture.width - x));
        OklabBlock given{}, made;
        std::copy_n(source.lightness.data() + first, count, given.lightness.begin());
        std::copy_n(source.a.data() + first, count, given.a.begin());
        std::copy_n(source.b.data() + first, count, given.b.begin());
        made = given;
        for (const BlurSide& side : sides) {
          if (!side.levels.empty())
            HWY_DYNAMIC_DISPATCH(GatherHere)(side, source.sigma.data() + first, x, y, count, made);
        }
        MixBackground(source, sides[0], x, y, count, given, made);
        PutBlock(given, strength, step.only.empty() ? nullptr : step.only.data() + first, count, made,
                 picture.At(x, y));
      }
    }
  });
}

}  // namespace scumble::internal
#endif
