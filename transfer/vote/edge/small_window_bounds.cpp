#include "transfer/vote/edge/small_window_bounds.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/vote/edge/small_window_bounds.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "transfer/field/mask_lanes-inl.h"

#ifndef SCUMBLE_CALM_MARKS_ONCE
#define SCUMBLE_CALM_MARKS_ONCE
namespace scumble::internal {

constexpr int kCalmBlock = 16;

// Where what is found of a row goes: bits of words, and centres of blocks.
struct CalmFound {
  std::uint64_t* calm;
  float* centre[3];
};

struct CalmLimits {
  int radius = 0;
  float bend = 0, bend_fixed = 0, spread = 0;
};

}  // namespace scumble::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace scumble::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The calm ones of 16 pixels.
HWY_INLINE std::uint64_t CalmBits(const CalmRow& row, int begin, const CalmLimits& limits) {
  const F bend = hn::Set(kFloat, limits.bend), fixed = hn::Set(kFloat, limits.bend_fixed);
  const F tiny = hn::Set(kFloat, 1e-16f), share = hn::Set(kFloat, 1.0f / 32);
  std::uint64_t bits = 0;
  for (int i = 0; i < kCalmBlock; i += int(hn::Lanes(kFloat))) {
    const int x = begin + i;
    const F here = hn::LoadU(kFloat, row.here.depth + x);
    const F front_x = hn::Sub(hn::LoadU(kFloat, row.here.depth + x + 1), here);
    const F back_x = hn::Sub(here, hn::LoadU(kFloat, row.here.depth + x - 1));
    const F front_y = hn::Sub(hn::LoadU(kFloat, row.below.depth + x), here);
    const F back_y = hn::Sub(here, hn::LoadU(kFloat, row.above + x));
    // Less, not less or equal: nothing that is NaN or infinite may pass.
    const F most = hn::Sub(hn::Add(fixed, hn::Mul(bend, here)), tiny);
    auto calm =
        hn::And(hn::Lt(hn::Abs(hn::Sub(front_x, back_x)), most), hn::Lt(hn::Abs(hn::Sub(front_y, back_y)), most));
    calm = hn::And(calm, hn::Lt(hn::Add(hn::Abs(front_x), hn::Abs(front_y)), hn::Mul(share, here)));
    const F object = hn::LoadU(kFloat, row.here.object + x);
    calm = hn::And(calm, hn::Eq(object, hn::LoadU(kFloat, row.here.object + x + 1)));
    calm = hn::And(calm, hn::Eq(object, hn::LoadU(kFloat, row.below.object + x)));
    bits |= BitsOf(calm) << i;
  }
  return bits;
}

// Whether all covered normals of 16 pixels and of `radius` on either side are near the middle one.
HWY_INLINE bool Near(const CalmRow& row, int begin, int radius, const float* centre, float spread) {
  const F x = hn::Set(kFloat, centre[0]), y = hn::Set(kFloat, centre[1]), z = hn::Set(kFloat, centre[2]);
  const F most = hn::Set(kFloat, spread * spread);
  auto far = hn::Lt(most, most);
  for (int side = -radius; side <= radius; side += 2 * radius) {
    for (int i = begin + side; i < begin + side + kCalmBlock; i += int(hn::Lanes(kFloat))) {
      const F off_x = hn::Sub(hn::LoadU(kFloat, row.here.normal[0] + i), x);
      const F off_y = hn::Sub(hn::LoadU(kFloat, row.here.normal[1] + i), y);
      const F off_z = hn::Sub(hn::LoadU(kFloat, row.here.normal[2] + i), z);
      const F square = hn::Add(hn::Add(hn::Mul(off_x, off_x), hn::Mul(off_y, off_y)), hn::Mul(off_z, off_z));
      const F depth = hn::LoadU(kFloat, row.here.depth + i);
      far = hn::Or(far, hn::And(hn::Not(hn::Lt(square, most)), hn::Eq(depth, depth)));
    }
  }
  return hn::AllFalse(kFloat, far);
}

void CalmWords(const CalmRow& row, const CalmLimits& limits, const std::uint8_t* wanted, int first_word, int words,
               const CalmFound& out) {
  for (int w = 0; w < words; ++w) {
    const int begin = 64 * (first_word + w);
    if (!wanted[w] || begin < 0 || begin + 64 + kCalmBlock > row.below.readable) continue;
    const bool ahead = begin + 64 + row.width <= row.below.readable;
    std::uint64_t calm = 0;
    for (int b = 0; b < 4; ++b) {
      if (!(wanted[w] >> b & 1)) continue;
      const int x = begin + kCalmBlock * b, middle = x + kCalmBlock / 2;
      if (ahead) {
        hwy::Prefetch(row.below.object + row.width + x);
        for (int k = 0; k < 3; ++k) hwy::Prefetch(row.here.normal[k] + row.width + x);
      }
      const std::uint64_t bits = CalmBits(row, x, limits);
      if (!bits) continue;
      calm |= bits << kCalmBlock * b;
      const float centre[3] = {row.here.normal[0][middle], row.here.normal[1][middle], row.here.normal[2][middle]};
      if (!(centre[0] * centre[0] + centre[1] * centre[1] + centre[2] * centre[2] <= 1.01f)) continue;
      if (!Near(row, x, limits.radius, centre, limits.spread)) continue;
      for (int k = 0; k < 3; ++k) out.centre[k][4 * w + b] = centre[k];
    }
    out.calm[w] = calm;
  }
}

// Of each word, the pixels of its four blocks for which a·b > least.
void CompareBlocks(const float* const* a, const float* const* b, int words, float least, std::uint64_t* out) {
  const F most = hn::Set(kFloat, least);
  const int lanes = static_cast<int>(hn::Lanes(kFloat));
  for (int i = 0; i < 4 * words; i += 16) {
    std::uint64_t bits = 0;
    for (int j = 0; j < 16; j += lanes) {
      const auto product = [&](int k) HWY_ATTR {
        return hn::Mul(hn::LoadU(kFloat, a[k] + i + j), hn::LoadU(kFloat, b[k] + i + j));
      };
      bits |= BitsOf(hn::Gt(hn::Add(hn::Add(product(0), product(1)), product(2)), most)) << j;
    }
    for (int w = i / 4; w < std::min(words, i / 4 + 4); ++w, bits >>= 4) {
      // Each of four bits becomes sixteen.
      const std::uint64_t apart = (bits & 1) | (bits & 2) << 15 | (bits & 4) << 30 | (bits & 8) << 45;
      out[w] = (apart << 16) - apart;
    }
  }
}

}  // namespace scumble::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(CalmWords);
HWY_EXPORT(CompareBlocks);

CalmMarks::CalmMarks(const EdgeRules& rules, int radius, const MarkedTile& tile) : radius_(radius), tile_(tile) {
  const DepthGive give = rules.Give();
  const float part = 0.7f / float(radius * (radius + 1));
  bend_ = std::min(part * give.share - 1e-6f, 1.0f / 64);
  bend_fixed_ = part * give.fixed;
  // As wide as it can be where blocks below each other share a normal, so that their middles are 2L apart at most: c·d
  // is then at least 1 - 2L² for normals of length 1, whose products are never below -1.
  const float crease = std::max(rules.CreaseCosine(), -1.0f);
  spread_ = (std::sqrt(1.0f + 3.0f * std::max(0.0f, 1.0f - crease)) - 1.0f) / 3.0f;
  // Rounding, of products below 4, is far less than the last term.
  least_product_ = crease + 2.02f * spread_ + spread_ * spread_ + 1e-4f;
  for (int k = 0; k <= radius; ++k)
    runs_[std::size_t(k)].Reset(tile.first_row, tile.rows, tile.first_word, tile.words, 0);
  blocks_.resize(std::size_t(radius + 1));
  for (Blocks& blocks : blocks_) {
    for (auto& centre : blocks.centre) centre.assign(std::size_t(4 * tile.words + 16), 0.0f);
  }
  alike_.resize(std::size_t(tile.words));
  const std::size_t across = std::size_t(2 * radius + 1), words = std::size_t(tile.words);
  box_.resize(across * words);
  level_.resize((across * (radius + 1) - radius - 1) * words);
  sure_.resize(level_.size());
}

void CalmMarks::AddNothing(int y) {
  for (auto& centre : BlocksOf(y).centre)
    std::fill(centre.begin(), centre.end(), std::numeric_limits<float>::quiet_NaN());
}

void CalmMarks::Add(int y, const CalmRow& row, const std::uint8_t* wanted) {
  AddNothing(y);
  if (!(bend_ > 0.0f || bend_fixed_ > 0.0f)) return;
  Blocks& blocks = BlocksOf(y);
  std::uint64_t* calm = runs_[0].Row(y);
  const CalmFound out{calm, {blocks.centre[0].data(), blocks.centre[1].data(), blocks.centre[2].data()}};
  HWY_DYNAMIC_DISPATCH(CalmWords)(row, {radius_, bend_, bend_fixed_, spread_}, wanted, tile_.first_word, tile_.words, out);
  for (int k = 1; k <= radius_; ++k) {
    const std::uint64_t* shorter = runs_[std::size_t(k - 1)].Row(y);
    std::uint64_t* run = runs_[std::size_t(k)].Row(y);
    for (int w = 0; w < tile_.words; ++w) run[w] = shorter[w] & (calm[w] >> k | calm[w + 1] << (64 - k));
  }
}

void CalmMarks::Compare(int y, int last) {
  const int words = tile_.words;
  std::fill(box_.begin(), box_.end(), BitRows::kAll);
  std::uint64_t *level = level_.data(), *sure = sure_.data();
  for (int dy = 0; dy <= std::min(radius_, last - y); ++dy) {
    const float *here[3], *there[3];
    for (int k = 0; k < 3; ++k) here[k] = BlocksOf(y).centre[k].data(), there[k] = BlocksOf(y + dy).centre[k].data();
    HWY_DYNAMIC_DISPATCH(CompareBlocks)(here, there, words, least_product_, alike_.data());
    for (int dx = -radius_; dx <= radius_; ++dx) {
      const int far = std::abs(dx);
      const std::uint64_t* run = runs_[std::size_t(far)].Row(y + dy);
      std::uint64_t* box = box_.data() + (dx + radius_) * words;
      if (dx < 0) {
        for (int w = 0; w < words; ++w) box[w] &= run[w] << far | run[w - 1] >> (64 - far);
      } else {
        for (int w = 0; w < words; ++w) box[w] &= run[w];
      }
      if (dy == 0 && dx <= 0) continue;
      for (int w = 0; w < words; ++w) level[w] = box[w], sure[w] = box[w] & alike_[std::size_t(w)];
      level += words, sure += words;
    }
  }
}

}  // namespace scumble::internal
#endif
