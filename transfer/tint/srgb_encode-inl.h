// Encoding in sRGB's curve, many values at once: close to Srgb16FromLinear, and it says where it may be wrong, so that
// whoever asks can settle those few values by the table. Included once for each instruction set, by Highway's rules.
#if defined(SCUMBLE_TRANSFER_SRGB_ENCODE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCUMBLE_TRANSFER_SRGB_ENCODE_INL_H_
#undef SCUMBLE_TRANSFER_SRGB_ENCODE_INL_H_
#else
#define SCUMBLE_TRANSFER_SRGB_ENCODE_INL_H_
#endif

#include <hwy/highway.h>

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// The curve in codes: a code c above kKink means ((c + kOffset) / kSpan)^2.4, one below it c / kSteepness.
constexpr float kOffset = 0.055f * 65535.0f;
constexpr float kSpan = 1.055f * 65535.0f;
constexpr float kKink = 0.04045f * 65535.0f;
constexpr float kSteepness = 12.92f * 65535.0f;
constexpr float kLinearKink = 0.04045f / 12.92f;

// The least value whose 5/12th power is approximated; below it every result lies under the kink.
constexpr float kLeastRoot = 1.0f / 32768.0f;

// How far, in codes, a code made from these may be from what the tables say, which round too: above the kink
// kDoubt + kRelativeDoubt · code, below it, where BelowKink made it, kKinkDoubt.
constexpr float kDoubt = 0.003f;
constexpr float kRelativeDoubt = 1.8e-7f;
constexpr float kKinkDoubt = 0.012f;

// 1.5^(5/12) · 2^(5 e / 12) for e of -15 … 0: what floats hold of it, and the rest.
alignas(64) constexpr float kRootOfExponent[16] = {
    0.0155572882f, 0.0207664873f, 0.0277199354f, 0.0370016731f, 0.0493913107f, 0.0659294873f, 0.0880053118f, 0.117472991f,
    0.156807631f,  0.20931308f,   0.279399455f,  0.372953504f,  0.497833222f,  0.664527595f,  0.887037933f,  1.18405354f};
alignas(64) constexpr float kRootRest[16] = {
    -4.25148305e-10f, 3.89169891e-10f, 5.65617553e-11f, 1.47329415e-09f,  -7.27611527e-10f, 1.60252489e-09f,
    -2.37143505e-09f, 3.03931991e-09f, 3.4417742e-09f,  5.15541942e-10f,  -1.31031417e-08f, 5.41043166e-09f,
    -1.36047458e-08f, 1.24534365e-08f, 1.80997628e-09f, 4.71454129e-08f};

template <class D, class VI>
HWY_INLINE hn::Vec<D> LookUp16(D d, const float* HWY_RESTRICT table, VI index) {
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  if constexpr (hn::MaxLanes(D()) == 16) return hn::TableLookupLanes(hn::Load(d, table), hn::IndicesFromVec(d, index));
#endif
#if HWY_TARGET == HWY_AVX2
  if constexpr (hn::MaxLanes(D()) == 8) {
    const hn::RebindToSigned<D> di;
    const auto low = hn::IndicesFromVec(d, hn::And(index, hn::Set(di, 7)));
    const auto upper = hn::RebindMask(d, hn::Gt(index, hn::Set(di, 7)));
    return hn::IfThenElse(upper, hn::TableLookupLanes(hn::Load(d, table + 8), low),
                          hn::TableLookupLanes(hn::Load(d, table), low));
  }
#endif
  return hn::GatherIndex(d, table, index);
}

// A power in two parts, whose sum has more digits than a float.
template <class D>
struct Root {
  hn::Vec<D> high, low;
};

// value^(5/12) within 5e-8, relative, for kLeastRoot ≤ value < 2; anything for others. A polynomial for the mantissa, a
// table for the exponent.
template <class D>
HWY_INLINE Root<D> FiveTwelfths(D d, hn::Vec<D> value) {
  const hn::RebindToSigned<D> di;
  const auto bits = hn::BitCast(di, value);
  const auto exponent = hn::And(hn::Sub(hn::ShiftRight<23>(bits), hn::Set(di, 112)), hn::Set(di, 15));
  const auto mantissa = hn::BitCast(d, hn::Or(hn::And(bits, hn::Set(di, 0x7fffff)), hn::Set(di, 0x3f800000)));
  const auto t = hn::Sub(mantissa, hn::Set(d, 1.5f));
  auto p = hn::MulAdd(t, hn::Set(d, -0.000743552751f), hn::Set(d, 0.00126496947f));
  p = hn::MulAdd(t, p, hn::Set(d, -0.0019467778f));
  p = hn::MulAdd(t, p, hn::Set(d, 0.00386994868f));
  p = hn::MulAdd(t, p, hn::Set(d, -0.00818711612f));
  p = hn::MulAdd(t, p, hn::Set(d, 0.0190070234f));
  p = hn::MulAdd(t, p, hn::Set(d, -0.0540121868f));
  p = hn::MulAdd(t, p, hn::Set(d, 0.277777731f));
  const auto middle = LookUp16(d, kRootOfExponent, exponent);
  const auto rise = hn::Mul(middle, hn::Mul(t, p));
  const auto high = hn::Add(middle, rise);
  return {high, hn::Add(hn::Add(hn::Sub(middle, high), rise), LookUp16(d, kRootRest, exponent))};
}

// Where a root (a code above the kink, plus kOffset) lies below the kink, the code that the straight part has there:
// kKink · (root / root at the kink)^2.4, by a polynomial of the square root. For 0 ≤ root ≤ kKink + kOffset.
template <class D>
HWY_INLINE hn::Vec<D> BelowKink(D d, hn::Vec<D> root) {
  const auto z = hn::Mul(hn::Max(root, hn::Zero(d)), hn::Set(d, 1.0f / (kKink + kOffset)));
  const auto s = hn::Sqrt(z);
  auto p = hn::MulAdd(s, hn::Set(d, -54.0899f), hn::Set(d, 274.252f));
  p = hn::MulAdd(s, p, hn::Set(d, -694.174f));
  p = hn::MulAdd(s, p, hn::Set(d, 2884.05f));
  p = hn::MulAdd(s, p, hn::Set(d, 260.23f));
  p = hn::MulAdd(s, p, hn::Set(d, -20.2001f));
  p = hn::MulAdd(s, p, hn::Set(d, 0.830549f));
  return hn::Mul(z, p);
}

// The code of a linear value of 0 … 1, to fractions of a code.
template <class D>
HWY_INLINE hn::Vec<D> CodeOf(D d, hn::Vec<D> linear) {
  const auto root = FiveTwelfths(d, linear);
  const auto curved = hn::MulAdd(root.high, hn::Set(d, kSpan), hn::MulAdd(root.low, hn::Set(d, kSpan), hn::Set(d, -kOffset)));
  const auto straight = hn::Mul(linear, hn::Set(d, kSteepness));
  return hn::IfThenElse(hn::Lt(linear, hn::Set(d, kLinearKink)), straight, curved);
}

// Rounds codes of 0 … 65535, given to fractions of a code; `doubtful` gets the lanes whose fraction is within `doubt` of a
// half.
template <class D>
HWY_INLINE hn::Vec<hn::RebindToSigned<D>> RoundCode(D d, hn::Vec<D> code, hn::Vec<D> doubt, hn::Mask<D>& doubtful) {
  const hn::RebindToSigned<D> di;
  // Of a sum above 2^23 the lowest bits are the nearest whole number.
  const auto whole = hn::Set(d, 8388608.0f), raised = hn::Add(code, whole);
  const auto off = hn::Abs(hn::Sub(code, hn::Sub(raised, whole)));
  doubtful = hn::Gt(hn::Add(off, doubt), hn::Set(d, 0.5f));
  return hn::And(hn::BitCast(di, raised), hn::Set(di, 0xffff));
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#endif
