// Texels, and core/image/color_math-inl.h, for Highway's vectors of up to sixteen floats. Included once for each
// instruction set, by Highway's rules.
#if defined(SCUMBLE_FILTER_VECTOR_LANE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCUMBLE_FILTER_VECTOR_LANE_INL_H_
#undef SCUMBLE_FILTER_VECTOR_LANE_INL_H_
#else
#define SCUMBLE_FILTER_VECTOR_LANE_INL_H_
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

using Words = hn::RebindToUnsigned<Floats>;

// Texels are two words each: red and green, blue and alpha, the lower half first.
HWY_INLINE LaneColor LoadTexels(const std::uint16_t* HWY_RESTRICT texels) {
  const Words du;
  hn::Vec<Words> red_green, blue_alpha;
  hn::LoadInterleaved2(du, reinterpret_cast<const std::uint32_t*>(texels), red_green, blue_alpha);
  const auto number = [&](hn::Vec<Words> code) HWY_ATTR { return hn::ConvertTo(Floats(), hn::BitCast(Ints(), code)); };
  const auto low = hn::Set(du, 0xffff);
  return {number(hn::And(red_green, low)), number(hn::ShiftRight<16>(red_green)), number(hn::And(blue_alpha, low))};
}

// Rounds codes; alpha stays.
HWY_INLINE void StoreTexels(LaneColor codes, std::uint16_t* HWY_RESTRICT texels) {
  const Words du;
  std::uint32_t* const words = reinterpret_cast<std::uint32_t*>(texels);
  hn::Vec<Words> red_green, blue_alpha;
  hn::LoadInterleaved2(du, words, red_green, blue_alpha);
  const auto low = hn::Set(du, 0xffff);
  // The lowest bits of a sum above 2^23 are the nearest whole number.
  const auto rounded = [&](Lane code) HWY_ATTR { return hn::BitCast(du, (code + 8388608.0f).v); };
  const auto red = hn::And(rounded(codes.r), low), blue = hn::And(rounded(codes.b), low);
  hn::StoreInterleaved2(hn::Or(red, hn::ShiftLeft<16>(rounded(codes.g))), hn::Or(blue, hn::AndNot(low, blue_alpha)), du,
                        words);
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#endif
