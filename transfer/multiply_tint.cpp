#include "transfer/multiply_tint.h"

#include <algorithm>

#include "image/color.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/multiply_tint.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "transfer/srgb_encode-inl.h"

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

using Floats = hn::CappedTag<float, 16>;
using Ints = hn::RebindToSigned<Floats>;
using Float = hn::Vec<Floats>;
using Int = hn::Vec<Ints>;

// What albedo makes of one channel: a code c becomes c · high + (c · low + shift).
struct Factor {
  Float value, high, low, shift;

  HWY_INLINE void Set(Float wanted) {
    const Floats d;
    const auto root = FiveTwelfths(d, wanted);
    value = wanted, high = root.high, low = root.low;
    shift = hn::MulSub(high, hn::Set(d, kOffset), hn::Set(d, kOffset));
  }
  HWY_INLINE hn::Mask<Floats> Plain() const {
    const Floats d;
    return hn::And(hn::Ge(value, hn::Set(d, kLeastRoot)), hn::Le(value, hn::Set(d, 1.0f)));
  }
};

// Of all channels. Neighbours mostly share their albedo: then the last roots are still good.
struct Factors {
  Factor red, green, blue;
  bool plain = false;  // no lane needs what Unusual looks after

  Factors() { Set(hn::Zero(Floats()), hn::Zero(Floats()), hn::Zero(Floats())); }

  HWY_INLINE void Set(Float r, Float g, Float b) {
    const Floats d;
    red.Set(r), green.Set(g), blue.Set(b);
    plain = hn::AllTrue(d, hn::And(hn::And(red.Plain(), green.Plain()), blue.Plain()));
  }
  HWY_INLINE void Become(Float r, Float g, Float b) {
    const Floats d;
    const auto same = hn::And(hn::And(hn::Eq(r, red.value), hn::Eq(g, green.value)), hn::Eq(b, blue.value));
    if (!hn::AllTrue(d, same)) Set(r, g, b);
  }
};

struct Tinted {
  Float code;   // to fractions of a code
  Float doubt;  // how far it may be off; 1: it says nothing
};

// Factors of 0 give 0. Those above 1 may lift what was below the kink over it; they, very small and impossible ones are
// left to the tables.
HWY_INLINE Tinted Unusual(Float code, Float factor, Tinted tinted) {
  const Floats d;
  const auto zero = hn::Eq(factor, hn::Zero(d));
  const auto in_range = hn::And(hn::Ge(factor, hn::Set(d, kLeastRoot)), hn::Lt(factor, hn::Set(d, 2.0f)));
  const auto lifted = hn::And(hn::Lt(code, hn::Set(d, kKink)), hn::Gt(tinted.code, hn::Set(d, kKink - 0.5f)));
  const auto unknown = hn::AndNot(zero, hn::Or(hn::Not(in_range), lifted));
  return {hn::IfThenZeroElse(hn::Or(zero, unknown), tinted.code),
          hn::IfThenElse(unknown, hn::Set(d, 1.0f), hn::IfThenZeroElse(zero, tinted.doubt))};
}

// For vectors where paint or result lie below the kink, or a factor is unusual.
HWY_NOINLINE Tinted Bend(Float code, Float factor, bool plain, Tinted curved) {
  const Floats d;
  const auto below = hn::Lt(code, hn::Set(d, kKink));
  const auto fallen = hn::AndNot(below, hn::Lt(curved.code, hn::Set(d, kKink)));
  Tinted bent{hn::IfThenElse(below, hn::Mul(code, factor), curved.code), curved.doubt};
  bent.code = hn::IfThenElse(fallen, BelowKink(d, hn::Add(curved.code, hn::Set(d, kOffset))), bent.code);
  bent.doubt = hn::IfThenElse(fallen, hn::Set(d, kKinkDoubt), bent.doubt);
  return plain ? bent : Unusual(code, factor, bent);
}

HWY_INLINE Int TintChannel(Int channel, const Factor& factor, bool plain, hn::Mask<Floats>& doubtful) {
  const Floats d;
  const auto code = hn::ConvertTo(d, channel);
  Tinted tinted{hn::MulAdd(code, factor.high, hn::MulAdd(code, factor.low, factor.shift)), hn::Zero(d)};
  tinted.doubt = hn::MulAdd(tinted.code, hn::Set(d, kRelativeDoubt), hn::Set(d, kDoubt));
  const bool above = hn::AllTrue(d, hn::Gt(hn::Min(code, tinted.code), hn::Set(d, kKink)));
  if (HWY_UNLIKELY(!above || !plain)) tinted = Bend(code, factor.value, plain, tinted);
  return RoundCode(d, hn::Min(tinted.code, hn::Set(d, 65535.0f)), tinted.doubt, doubtful);
}

// Makes the doubtful lanes of one channel by the tables.
HWY_INLINE void Settle(hn::Mask<Floats> doubtful, Int before, Float factor, std::uint16_t* HWY_RESTRICT channel) {
  const Floats d;
  const Ints di;
  HWY_ALIGN std::int32_t code[16];
  HWY_ALIGN float times[16];
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(d, doubtful, bits);
  std::uint32_t left = bits[0] | std::uint32_t(bits[1]) << 8;
  if (left == 0) return;
  hn::Store(before, di, code), hn::Store(factor, d, times);
  for (; left != 0; left &= left - 1) {
    const int lane = hwy::Num0BitsBelowLS1Bit_Nonzero32(left);
    const float linear = Srgb16ToLinear(static_cast<std::uint16_t>(code[lane])) * times[lane];
    channel[4 * lane] = Srgb16FromLinear(linear, channel[4 * lane]);
  }
}

// One vector of pixels.
HWY_INLINE void TintBlock(Float red_albedo, Float green_albedo, Float blue_albedo, float weight, Factors& factors,
                          std::uint16_t* HWY_RESTRICT texels) {
  const Floats d;
  const hn::RebindToUnsigned<Floats> du;
  const Ints di;
  const auto rest = hn::Set(d, 1.0f - weight), share = hn::Set(d, weight);
  factors.Become(hn::Add(rest, hn::Mul(share, red_albedo)), hn::Add(rest, hn::Mul(share, green_albedo)),
                 hn::Add(rest, hn::Mul(share, blue_albedo)));
  hn::Vec<decltype(du)> red_green, blue_alpha;
  auto* words = reinterpret_cast<std::uint32_t*>(texels);
  hn::LoadInterleaved2(du, words, red_green, blue_alpha);
  const auto lower = hn::Set(du, 0xffff);
  const Int red = hn::BitCast(di, hn::And(red_green, lower)), green = hn::BitCast(di, hn::ShiftRight<16>(red_green));
  const Int blue = hn::BitCast(di, hn::And(blue_alpha, lower));
  hn::Mask<Floats> red_doubt, green_doubt, blue_doubt;
  const auto new_red = hn::BitCast(du, TintChannel(red, factors.red, factors.plain, red_doubt));
  const auto new_green = hn::BitCast(du, TintChannel(green, factors.green, factors.plain, green_doubt));
  const auto new_blue = hn::BitCast(du, TintChannel(blue, factors.blue, factors.plain, blue_doubt));
  hn::StoreInterleaved2(hn::Or(new_red, hn::ShiftLeft<16>(new_green)), hn::Or(new_blue, hn::AndNot(lower, blue_alpha)),
                        du, words);
  if (hn::AllFalse(d, hn::Or(hn::Or(red_doubt, green_doubt), blue_doubt))) return;
  Settle(red_doubt, red, factors.red.value, texels);
  Settle(green_doubt, green, factors.green.value, texels + 1);
  Settle(blue_doubt, blue, factors.blue.value, texels + 2);
}

void MultiplyTintHere(const float* const* albedo, std::size_t count, float weight, std::uint16_t* texels) {
  const Floats d;
  const std::size_t lanes = hn::Lanes(d);
  Factors factors;
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    TintBlock(hn::LoadU(d, albedo[0] + i), hn::LoadU(d, albedo[1] + i), hn::LoadU(d, albedo[2] + i), weight, factors,
              texels + 4 * i);
  }
  if (i == count) return;
  HWY_ALIGN float rest[3][16] = {};
  HWY_ALIGN std::uint16_t last[4 * 16] = {};
  for (int c = 0; c < 3; ++c) std::copy(albedo[c] + i, albedo[c] + count, rest[c]);
  std::copy(texels + 4 * i, texels + 4 * count, last);
  TintBlock(hn::Load(d, rest[0]), hn::Load(d, rest[1]), hn::Load(d, rest[2]), weight, factors, last);
  std::copy(last, last + 4 * (count - i), texels + 4 * i);
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(MultiplyTintHere);

void MultiplyTint(const float* const albedo[3], std::size_t count, float weight, std::uint16_t* texels) {
  HWY_DYNAMIC_DISPATCH(MultiplyTintHere)(albedo, count, weight, texels);
}

}  // namespace scumble::internal
#endif
