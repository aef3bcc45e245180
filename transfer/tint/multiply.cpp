#include "transfer/tint/multiply.h"

#include <algorithm>

#include "core/image/color.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/tint/multiply.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "transfer/tint/texel_blocks-inl.h"

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

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

// Tints up to kBlock pixels, in whole vectors.
class MultiplyBlock {
 public:
  explicit MultiplyBlock(float weight) : rest_(1.0f - weight), share_(weight) {}

  void Make(const float* const* albedo, std::size_t count, std::uint16_t* HWY_RESTRICT texels) {
    std::copy_n(texels, 4 * count, before_);
    for (std::size_t i = 0; i < count; i += hn::Lanes(Floats())) MakeVector(albedo, i, texels + 4 * i);
    for (int c = 0; c < 3; ++c) {
      doubtful_[c].ForEach(Floats(), count, [&](std::size_t i) {
        const float linear = srgb_.decoded[before_[4 * i + c]] * (rest_ + share_ * albedo[c][i]);
        texels[4 * i + c] = srgb_.Encode(linear, texels[4 * i + c]);
      });
    }
  }

 private:
  HWY_INLINE Float FactorOf(const float* HWY_RESTRICT albedo) const {
    const Floats d;
    return hn::Add(hn::Set(d, rest_), hn::Mul(hn::Set(d, share_), hn::LoadU(d, albedo)));
  }

  HWY_INLINE void MakeVector(const float* const* albedo, std::size_t i, std::uint16_t* HWY_RESTRICT texels) {
    const Floats d;
    factors_.Become(FactorOf(albedo[0] + i), FactorOf(albedo[1] + i), FactorOf(albedo[2] + i));
    const Codes codes(texels);
    Mask doubtful[3];
    const Int red = TintChannel(codes.red, factors_.red, factors_.plain, doubtful[0]);
    const Int green = TintChannel(codes.green, factors_.green, factors_.plain, doubtful[1]);
    const Int blue = TintChannel(codes.blue, factors_.blue, factors_.plain, doubtful[2]);
    for (int c = 0; c < 3; ++c) doubtful_[c].Set(d, i, doubtful[c]);
    codes.Replace(red, green, blue, texels);
  }

  float rest_, share_;
  const Srgb16Tables srgb_ = Srgb16();
  Factors factors_;
  LaneMarks doubtful_[3];
  std::uint16_t before_[4 * kBlock];
};

void MultiplyTintHere(const float* const* albedo, std::size_t count, float weight, std::uint16_t* texels) {
  MultiplyBlock stretch(weight);
  ForEachBlock(stretch, albedo, count, texels);
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
