// Weighted means of Oklab colours. Included once for each instruction set, by Highway's rules.
#if defined(SCUMBLE_FINISH_COLOR_SUMS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCUMBLE_FINISH_COLOR_SUMS_INL_H_
#undef SCUMBLE_FINISH_COLOR_SUMS_INL_H_
#else
#define SCUMBLE_FINISH_COLOR_SUMS_INL_H_
#endif

#include <cstddef>

#include "core/filter/vector_lane-inl.h"

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

struct ColorLanes {
  hn::Vec<Floats> l, a, b;
};

HWY_INLINE ColorLanes LoadColors(const float* l, const float* a, const float* b, std::size_t place) {
  const Floats d;
  return {hn::LoadU(d, l + place), hn::LoadU(d, a + place), hn::LoadU(d, b + place)};
}

HWY_INLINE ColorLanes Difference(const ColorLanes& of, const ColorLanes& to) {
  return {hn::Sub(of.l, to.l), hn::Sub(of.a, to.a), hn::Sub(of.b, to.b)};
}

HWY_INLINE hn::Vec<Floats> SquaredLength(const ColorLanes& color) {
  return hn::Add(hn::Add(hn::Mul(color.l, color.l), hn::Mul(color.a, color.a)), hn::Mul(color.b, color.b));
}

// Sums differences to the pixel's own colour, so that an even colour stays as it is to the bit.
struct ColorSums {
  // `own`: the weight of the pixel itself.
  explicit HWY_INLINE ColorSums(float own)
      : weights(hn::Set(Floats(), own)), differences{hn::Zero(Floats()), hn::Zero(Floats()), hn::Zero(Floats())} {}

  HWY_INLINE void Add(hn::Vec<Floats> weight, const ColorLanes& difference) {
    weights = hn::Add(weights, weight);
    differences.l = hn::Add(differences.l, hn::Mul(weight, difference.l));
    differences.a = hn::Add(differences.a, hn::Mul(weight, difference.a));
    differences.b = hn::Add(differences.b, hn::Mul(weight, difference.b));
  }

  // Stores the mean of colours around `own`.
  HWY_INLINE void StoreMean(const ColorLanes& own, float* l, float* a, float* b, std::size_t place) const {
    const Floats d;
    const auto per_sum = hn::Div(hn::Set(d, 1.0f), weights);
    hn::StoreU(hn::Add(own.l, hn::Mul(differences.l, per_sum)), d, l + place);
    hn::StoreU(hn::Add(own.a, hn::Mul(differences.a, per_sum)), d, a + place);
    hn::StoreU(hn::Add(own.b, hn::Mul(differences.b, per_sum)), d, b + place);
  }

  hn::Vec<Floats> weights;
  ColorLanes differences;
};

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#endif
