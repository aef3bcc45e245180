// core/image/color_math-inl.h for Highway's vectors of up to sixteen floats. Included once for each instruction set, by
// Highway's rules.
#if defined(SCUMBLE_TRANSFER_VECTOR_LANE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCUMBLE_TRANSFER_VECTOR_LANE_INL_H_
#undef SCUMBLE_TRANSFER_VECTOR_LANE_INL_H_
#else
#define SCUMBLE_TRANSFER_VECTOR_LANE_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using Ints = hn::RebindToSigned<Floats>;
using Choice = hn::Mask<Floats>;

struct Lane {
  hn::Vec<Floats> v;

  HWY_INLINE Lane() = default;
  HWY_INLINE Lane(hn::Vec<Floats> vector) : v(vector) {}
  HWY_INLINE Lane(float value) : v(hn::Set(Floats(), value)) {}

  friend HWY_INLINE Lane operator+(Lane a, Lane b) { return hn::Add(a.v, b.v); }
  friend HWY_INLINE Lane operator-(Lane a, Lane b) { return hn::Sub(a.v, b.v); }
  friend HWY_INLINE Lane operator*(Lane a, Lane b) { return hn::Mul(a.v, b.v); }
  friend HWY_INLINE Lane operator/(Lane a, Lane b) { return hn::Div(a.v, b.v); }
};

struct LaneColor {
  Lane r, g, b;
};

HWY_INLINE Choice Less(Lane a, Lane b) { return hn::Lt(a.v, b.v); }
HWY_INLINE Choice Both(Choice a, Choice b) { return hn::And(a, b); }
HWY_INLINE bool All(Choice choice) { return hn::AllTrue(Floats(), choice); }
HWY_INLINE Lane Select(Choice choice, Lane yes, Lane no) { return hn::IfThenElse(choice, yes.v, no.v); }
HWY_INLINE Lane Min(Lane a, Lane b) { return hn::Min(a.v, b.v); }
HWY_INLINE Lane Max(Lane a, Lane b) { return hn::Max(a.v, b.v); }
HWY_INLINE Lane Sqrt(Lane x) { return hn::Sqrt(x.v); }
HWY_INLINE Lane BitsAsNumber(Lane x) { return hn::ConvertTo(Floats(), hn::BitCast(Ints(), x.v)); }
HWY_INLINE Lane NumberAsBits(Lane n) { return hn::BitCast(Floats(), hn::ShiftLeft<9>(hn::BitCast(Ints(), n.v))); }

#include "core/image/color_math-inl.h"

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#endif
