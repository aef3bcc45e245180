#include "transfer/vote/edge/open_steps.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/vote/edge/open_steps.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "transfer/vote/mask_lanes-inl.h"

#ifndef SCUMBLE_OPEN_STEPS_ONCE
#define SCUMBLE_OPEN_STEPS_ONCE
namespace scumble::internal {

// The test's input from one row, each array from column 0 on.
struct StepRow {
  const float* depth[4];  // of the rows from the one above to two below; NaN where nothing is covered; padded
  const float* object;
  const float* normal[3];
  std::ptrdiff_t to_below;  // from a guide's value to the one below
  std::int64_t readable;    // values of the guides from column 0 to their end
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

// Depth on covered pixels, NaN elsewhere. `covered` is null, or replaces coverage.
void CoveredDepth(const float* depth, const float* coverage, const std::uint8_t* covered, std::size_t count,
                  float* out) {
  const hn::Rebind<std::uint8_t, decltype(kFloat)> byte;
  const hn::RebindToUnsigned<decltype(kFloat)> word;
  const F none = hn::Set(kFloat, std::numeric_limits<float>::quiet_NaN());
  std::size_t i = 0;
  for (; i + hn::Lanes(kFloat) <= count; i += hn::Lanes(kFloat)) {
    const auto there =
        covered ? hn::RebindMask(kFloat, hn::Ne(hn::PromoteTo(word, hn::LoadU(byte, covered + i)), hn::Zero(word)))
                : hn::Gt(hn::LoadU(kFloat, coverage + i), hn::Zero(kFloat));
    hn::StoreU(hn::IfThenElse(there, hn::LoadU(kFloat, depth + i), none), kFloat, out + i);
  }
  for (; i < count; ++i) {
    out[i] = (covered ? covered[i] != 0 : coverage[i] > 0.0f) ? depth[i] : std::numeric_limits<float>::quiet_NaN();
  }
}

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
  const auto depth = [&](int k, int dx) HWY_ATTR { return hn::LoadU(kFloat, row.depth[k] + column + dx); };
  const auto guide = [&](const float* plane, std::ptrdiff_t step) HWY_ATTR {
    const std::ptrdiff_t at = column + step;
    if constexpr (kInside) {
      return hn::LoadU(kFloat, plane + at);
    } else {
      float values[16] = {};
      std::copy_n(plane + at, std::clamp<std::int64_t>(row.readable - at, 0, 16), values);
      return hn::LoadU(kFloat, values);
    }
  };
  const F here = depth(1, 0), next = depth(1, 1), below = depth(2, 0);
  const F slope_x = Slope(depth(1, -1), here, next), next_slope_x = Slope(here, next, depth(1, 2));
  const F slope_y = Slope(depth(0, 0), here, below), below_slope_y = Slope(here, below, depth(3, 0));
  auto right = DepthPasses(row.give, here, next, slope_x, next_slope_x);
  auto down = DepthPasses(row.give, here, below, slope_y, below_slope_y);
  const F object = guide(row.object, 0);
  right = hn::And(right, hn::Eq(object, guide(row.object, 1)));
  down = hn::And(down, hn::Eq(object, guide(row.object, row.to_below)));
  const F x = guide(row.normal[0], 0), y = guide(row.normal[1], 0), z = guide(row.normal[2], 0);
  const F crease = hn::Set(kFloat, row.crease_cosine);
  const auto alike = [&](std::ptrdiff_t step) HWY_ATTR {
    const F along = hn::Mul(x, guide(row.normal[0], step)), across = hn::Mul(y, guide(row.normal[1], step));
    return hn::Gt(hn::Add(hn::Add(along, across), hn::Mul(z, guide(row.normal[2], step))), crease);
  };
  return {BitsOf(hn::And(right, alike(1))), BitsOf(hn::And(down, alike(row.to_below)))};
}

void TestRow(const StepRow& row, int first_word, int words, const StepWords& bits) {
  const int lanes = static_cast<int>(hn::Lanes(kFloat));
  const std::uint64_t vector = lanes < 64 ? (std::uint64_t{1} << lanes) - 1 : ~std::uint64_t{0};
  const std::int64_t reach = lanes + std::max<std::int64_t>(1, row.to_below);
  for (int w = 0; w < words; ++w) {
    std::uint64_t right = 0, down = 0;
    for (int i = 0; i < 64 && bits.wanted[w] >> i; i += lanes) {
      if (!(bits.wanted[w] >> i & vector)) continue;
      const int column = 64 * (first_word + w) + i;
      if (column < 0) continue;  // no pixel is active there, and above the first row's start there is no guide
      const StepBits found =
          column + reach <= row.readable ? TestSteps<true>(row, column) : TestSteps<false>(row, column);
      right |= found.right << i, down |= found.down << i;
    }
    bits.right[w] = right, bits.down[w] = down;
  }
}

}  // namespace scumble::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(CoveredDepth);
HWY_EXPORT(TestRow);

namespace {

// The depths of four rows; the next row replaces the first.
class DepthRows {
 public:
  DepthRows(const EdgeRules& rules, int first_word, int words)
      : rules_(rules),
        first_(64 * first_word - kPad),
        stride_(std::size_t(64 * words + 2 * kPad)),
        values_(4 * stride_, std::numeric_limits<float>::quiet_NaN()) {}

  void Add(int y) {
    const GuideSet& guides = rules_.guides;
    float* row = values_.data() + Offset(y);
    if (y < 0 || y >= guides.height()) {
      std::fill_n(row, stride_, std::numeric_limits<float>::quiet_NaN());
      return;
    }
    // Columns outside the picture stay NaN.
    const int begin = std::max(0, first_), end = std::min(guides.width(), first_ + int(stride_));
    if (begin >= end) return;
    const std::size_t at = guides.Index(begin, y);
    HWY_DYNAMIC_DISPATCH(CoveredDepth)
    (guides.Plane(Layer::kDepth).data() + at, guides.Plane(Layer::kCoverage).data() + at,
     rules_.covered.empty() ? nullptr : rules_.covered.data() + at, std::size_t(end - begin), row + (begin - first_));
  }
  // From column 0 of the picture.
  const float* Row(int y) const { return values_.data() + Offset(y) - first_; }

 private:
  static constexpr int kPad = 16;
  std::size_t Offset(int y) const { return std::size_t((y + 4) & 3) * stride_; }
  const EdgeRules& rules_;
  int first_;
  std::size_t stride_;
  std::vector<float> values_;
};

}  // namespace

void MarkOpenSteps(const EdgeRules& rules, const MaskedTile& tile, const BitMaskRows& active, const BitMaskRows& wanted,
                   OpenSteps& steps) {
  const GuideSet& guides = rules.guides;
  steps.right.Reset(tile, 0), steps.down.Reset(tile, 0);
  DepthRows depths(rules, tile.first_word, tile.words);
  const float crease_cosine = rules.CreaseCosine();
  const DepthTolerance give = rules.Give();
  const int end = std::min(tile.first_row + tile.rows, guides.height());
  int next = std::numeric_limits<int>::min();  // the first row of depths that is not filled yet
  for (int y = std::max(0, tile.first_row); y < end; ++y) {
    const std::uint64_t* row = wanted.Row(y);
    if (std::all_of(row, row + tile.words, [](std::uint64_t bits) { return bits == 0; })) continue;
    for (next = std::max(next, y - 1); next <= y + 2; ++next) depths.Add(next);
    const std::size_t begin = guides.Index(0, y);
    const auto plane = [&](Layer layer, int channel) { return guides.Plane(layer, channel).data() + begin; };
    const StepRow tested{{depths.Row(y - 1), depths.Row(y), depths.Row(y + 1), depths.Row(y + 2)},
                         plane(Layer::kObject, 0),
                         {plane(Layer::kNormal, 0), plane(Layer::kNormal, 1), plane(Layer::kNormal, 2)},
                         y + 1 < guides.height() ? guides.width() : 0,
                         static_cast<std::int64_t>(guides.pixel_count() - begin),
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
