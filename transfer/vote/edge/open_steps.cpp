#include "transfer/vote/edge/open_steps.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/vote/edge/open_steps.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "transfer/field/mask_lanes-inl.h"

#ifndef SCUMBLE_OPEN_STEPS_ONCE
#define SCUMBLE_OPEN_STEPS_ONCE
namespace scumble::internal {

// The test's input from one row, each array from column 0 on.
struct StepRow {
  const float* depth;
  const float* coverage;
  const std::uint8_t* covered;  // null, or replaces coverage
  const float* object;
  const float* normal[3];
  int y, width, height;  // of the row; of the guides
  float crease_cosine;
  DepthTolerance give;
};

struct StepWords {
  const std::uint64_t* wanted;
  std::uint64_t* right;
  std::uint64_t* down;
};

}  // namespace scumble::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace scumble::internal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// As in DepthSlopes.
HWY_INLINE F Slope(F before, F here, F after) {
  const F back = hn::Sub(here, before), front = hn::Sub(after, here);
  const F gentler = hn::IfThenElse(hn::Lt(hn::Abs(back), hn::Abs(front)), back, front);
  return hn::IfThenElseZero(hn::Gt(hn::Mul(back, front), hn::Zero(kFloat)), gentler);
}

// As std::min.
HWY_INLINE F Least(F a, F b) { return hn::IfThenElse(hn::Lt(b, a), b, a); }

// Whether depth passes the test between p and the neighbour q; slopes along the step.
HWY_INLINE hn::Mask<hn::CappedTag<float, 16>> DepthPasses(const DepthTolerance& give, F depth_p, F depth_q, F slope_p,
                                                          F slope_q) {
  const F expected = hn::Mul(hn::Set(kFloat, 0.5f), hn::Add(slope_p, slope_q));
  const F given = hn::Add(hn::Set(kFloat, give.fixed), hn::Mul(hn::Set(kFloat, give.share), Least(depth_p, depth_q)));
  const F tolerance = hn::Add(Least(hn::Abs(slope_p), hn::Abs(slope_q)), given);
  return hn::Le(hn::Abs(hn::Sub(hn::Sub(depth_q, depth_p), expected)), tolerance);
}

struct StepBits {
  std::uint64_t right, down;
};

// A vector of pixels from `column` on; with kInside all its pixels and neighbours are inside the guides.
template <bool kInside>
HWY_INLINE StepBits TestSteps(const StepRow& row, int column) {
  // Nothing is read beyond the guides.
  const auto inside = [&](int i, int dx, int dy) {
    const int u = column + i + dx, v = row.y + dy;
    return u >= 0 && u < row.width && v >= 0 && v < row.height;
  };
  const auto guide = [&](const float* plane, int dx, int dy) HWY_ATTR {
    const std::ptrdiff_t at = column + dx + std::ptrdiff_t(dy) * row.width;
    if constexpr (kInside) {
      return hn::LoadU(kFloat, plane + at);
    } else {
      float values[16] = {};
      for (int i = 0; i < 16; ++i) values[i] = inside(i, dx, dy) ? plane[at + i] : 0.0f;
      return hn::LoadU(kFloat, values);
    }
  };
  // NaN where nothing is covered.
  const auto depth = [&](int dx, int dy) HWY_ATTR {
    const std::ptrdiff_t at = column + dx + std::ptrdiff_t(dy) * row.width;
    const F none = hn::Set(kFloat, std::numeric_limits<float>::quiet_NaN());
    if (!row.covered) {
      const auto there = hn::Gt(guide(row.coverage, dx, dy), hn::Zero(kFloat));
      return hn::IfThenElse(there, guide(row.depth, dx, dy), none);
    }
    const hn::Rebind<std::uint8_t, decltype(kFloat)> byte;
    const hn::RebindToUnsigned<decltype(kFloat)> word;
    std::uint8_t values[16] = {};
    const std::uint8_t* covered = row.covered + at;
    if constexpr (!kInside) {
      for (int i = 0; i < 16; ++i) values[i] = inside(i, dx, dy) ? covered[i] : std::uint8_t{0};
      covered = values;
    }
    const auto there = hn::Ne(hn::PromoteTo(word, hn::LoadU(byte, covered)), hn::Zero(word));
    return hn::IfThenElse(hn::RebindMask(kFloat, there), guide(row.depth, dx, dy), none);
  };
  const F here = depth(0, 0), next = depth(1, 0), below = depth(0, 1);
  const F slope_x = Slope(depth(-1, 0), here, next), next_slope_x = Slope(here, next, depth(2, 0));
  const F slope_y = Slope(depth(0, -1), here, below), below_slope_y = Slope(here, below, depth(0, 2));
  auto right = DepthPasses(row.give, here, next, slope_x, next_slope_x);
  auto down = DepthPasses(row.give, here, below, slope_y, below_slope_y);
  const F object = guide(row.object, 0, 0);
  right = hn::And(right, hn::Eq(object, guide(row.object, 1, 0)));
  down = hn::And(down, hn::Eq(object, guide(row.object, 0, 1)));
  const F x = guide(row.normal[0], 0, 0), y = guide(row.normal[1], 0, 0), z = guide(row.normal[2], 0, 0);
  const F crease = hn::Set(kFloat, row.crease_cosine);
  const auto alike = [&](int dx, int dy) HWY_ATTR {
    const F along = hn::Mul(x, guide(row.normal[0], dx, dy)), across = hn::Mul(y, guide(row.normal[1], dx, dy));
    return hn::Gt(hn::Add(hn::Add(along, across), hn::Mul(z, guide(row.normal[2], dx, dy))), crease);
  };
  return {BitsOf(hn::And(right, alike(1, 0))), BitsOf(hn::And(down, alike(0, 1)))};
}

void TestRow(const StepRow& row, int first_word, int words, const StepWords& bits) {
  const int lanes = static_cast<int>(hn::Lanes(kFloat));
  const std::uint64_t vector = lanes < 64 ? (std::uint64_t{1} << lanes) - 1 : ~std::uint64_t{0};
  const bool rows_inside = row.y >= 1 && row.y + 2 < row.height;
  for (int w = 0; w < words; ++w) {
    std::uint64_t right = 0, down = 0;
    for (int i = 0; i < 64 && bits.wanted[w] >> i; i += lanes) {
      if (!(bits.wanted[w] >> i & vector)) continue;
      const int column = 64 * (first_word + w) + i;
      const bool all_inside = rows_inside && column >= 1 && column + lanes + 2 <= row.width;
      const StepBits found = all_inside ? TestSteps<true>(row, column) : TestSteps<false>(row, column);
      right |= found.right << i, down |= found.down << i;
    }
    bits.right[w] = right, bits.down[w] = down;
  }
}

}  // namespace scumble::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(TestRow);

void MarkOpenSteps(const EdgeRules& rules, const MaskedTile& tile, const BitMaskRows& active, const BitMaskRows& wanted,
                   OpenSteps& steps) {
  const GuideSet& guides = rules.guides;
  steps.right.Reset(tile, 0), steps.down.Reset(tile, 0);
  const float crease_cosine = rules.CreaseCosine();
  const DepthTolerance give = rules.Give();
  const int end = std::min(tile.first_row + tile.rows, guides.height());
  for (int y = std::max(0, tile.first_row); y < end; ++y) {
    const std::uint64_t* row = wanted.Row(y);
    if (std::all_of(row, row + tile.words, [](std::uint64_t bits) { return bits == 0; })) continue;
    const std::size_t begin = guides.Index(0, y);
    const auto plane = [&](Layer layer, int channel) { return guides.Plane(layer, channel).data() + begin; };
    const StepRow tested{plane(Layer::kDepth, 0),
                         plane(Layer::kCoverage, 0),
                         rules.covered.empty() ? nullptr : rules.covered.data() + begin,
                         plane(Layer::kObject, 0),
                         {plane(Layer::kNormal, 0), plane(Layer::kNormal, 1), plane(Layer::kNormal, 2)},
                         y,
                         guides.width(),
                         guides.height(),
                         crease_cosine,
                         give};
    std::uint64_t *right = steps.right.Row(y), *down = steps.down.Row(y);
    HWY_DYNAMIC_DISPATCH(TestRow)(tested, tile.first_word, tile.words, {row, right, down});
    const std::uint64_t* here = active.Row(y);
    for (int w = 0; w < tile.words; ++w) {
      right[w] &= here[w] & (here[w] >> 1 | here[w + 1] << 63);
      down[w] &= y + 1 < tile.first_row + tile.rows ? here[w] & active.Row(y + 1)[w] : 0;
    }
  }
}

}  // namespace scumble::internal
#endif
