#include "transfer/tint/oklab.h"

#include <algorithm>

#include "core/image/color.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/tint/oklab.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "transfer/tint/oklab_simd-inl.h"
#include "transfer/tint/texel_blocks-inl.h"

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

using Color = Triple<Floats>;

HWY_INLINE Float All(float value) { return hn::Set(Floats(), value); }

HWY_INLINE Mask InGamut(Color c, Float low, Float high) {
  return hn::And(hn::Ge(hn::Min(c.a, hn::Min(c.b, c.c)), low), hn::Le(hn::Max(c.a, hn::Max(c.b, c.c)), high));
}

HWY_INLINE Color WithChroma(Color lab, Float factor) { return {lab.a, hn::Mul(factor, lab.b), hn::Mul(factor, lab.c)}; }

constexpr float kSlack = 1e-4f;

// How much of a colour's chroma fits, for the lanes in which not all of it does; 1 in others.
HWY_NOINLINE Float ChromaThatFits(Color lab, Mask outside_gamut, Float high) {
  const Floats d;
  const Float low = All(-kSlack), half = All(0.5f);
  Float inside = hn::Zero(d), outside = All(1.0f);
  for (int step = 0; step < 10; ++step) {
    const Float middle = hn::Mul(half, hn::Add(inside, outside));
    const Mask in = InGamut(LinearFromOklab(d, WithChroma(lab, middle)), low, high);
    inside = hn::IfThenElse(in, middle, inside);
    outside = hn::IfThenElse(in, outside, middle);
  }
  return hn::IfThenElse(outside_gamut, inside, All(1.0f));
}

// What follows from the albedo alone. Neighbours mostly share theirs.
struct Scene {
  Color albedo, lab;
  Float room, rest, high;
  Mask unusual;

  explicit Scene(float reference) { Set({hn::Zero(Floats()), hn::Zero(Floats()), hn::Zero(Floats())}, reference); }

  HWY_NOINLINE void Set(Color color, float reference) {
    const Floats d;
    albedo = color;
    const auto clamp = [&](Float v) HWY_ATTR { return hn::Min(hn::Max(v, hn::Zero(d)), All(1.0f)); };
    const Color base{clamp(color.a), clamp(color.b), clamp(color.c)};
    unusual = hn::Not(hn::And(hn::And(hn::Eq(color.a, color.a), hn::Eq(color.b, color.b)), hn::Eq(color.c, color.c)));
    lab = OklabFromLinear(d, base, unusual);
    const Float brightest = hn::Max(base.a, hn::Max(base.b, base.c));
    // Of darker ones the cubes of the roots are no longer known exactly.
    unusual = hn::Or(unusual, hn::And(hn::Lt(brightest, All(kLeastCube)), hn::Gt(brightest, hn::Zero(d))));
    rest = hn::Sub(All(1.0f), lab.a);
    room = hn::Max(hn::Sub(All(1.0f), hn::Min(All(reference), lab.a)), All(1e-6f));
    high = hn::Add(hn::Max(All(0.98f), brightest), All(kSlack));
  }
  HWY_INLINE void Become(Color color, float reference) {
    const Floats d;
    const auto same = hn::And(hn::And(hn::Eq(color.a, albedo.a), hn::Eq(color.b, albedo.b)), hn::Eq(color.c, albedo.c));
    if (HWY_UNLIKELY(!hn::AllTrue(d, same))) Set(color, reference);
  }
};

HWY_INLINE Color Target(const Scene& scene, Float own, float reference) {
  const Floats d;
  const Mask light = hn::Gt(own, All(reference));
  const Float share = hn::Div(hn::IfThenElse(light, hn::Sub(own, All(reference)), own),
                              hn::IfThenElse(light, scene.room, All(std::max(reference, 1e-6f))));
  const Color darker{hn::Mul(scene.lab.a, share), hn::Mul(scene.lab.b, share), hn::Mul(scene.lab.c, share)};
  if (hn::AllFalse(d, light)) return darker;
  const Float rise = hn::Min(share, All(1.0f));
  const Color lighter = WithChroma({hn::Add(scene.lab.a, hn::Mul(rise, scene.rest)), scene.lab.b, scene.lab.c},
                                   hn::Sub(All(1.0f), hn::Mul(rise, rise)));
  Color target{hn::IfThenElse(light, lighter.a, darker.a), hn::IfThenElse(light, lighter.b, darker.b),
               hn::IfThenElse(light, lighter.c, darker.c)};
  const Mask out = hn::AndNot(InGamut(LinearFromOklab(d, lighter), All(-kSlack), scene.high), light);
  if (hn::AllFalse(d, out)) return target;
  return WithChroma(target, ChromaThatFits(lighter, out, scene.high));
}

HWY_INLINE Int Encode(Float linear, Mask& doubtful) {
  const Floats d;
  const Float value = hn::Min(hn::Max(linear, hn::Zero(d)), All(1.0f));
  const Float code = hn::Min(CodeOf(d, value), All(65535.0f));
  return RoundCode(d, code, hn::MulAdd(code, All(kRelativeDoubt), All(kDoubt)), doubtful);
}

// One colour a pixel.
struct Colors {
  HWY_ALIGN float a[kBlock], b[kBlock], c[kBlock];

  HWY_INLINE Color Load(std::size_t i) const {
    const Floats d;
    return {hn::Load(d, a + i), hn::Load(d, b + i), hn::Load(d, c + i)};
  }
  HWY_INLINE void Store(Color color, std::size_t i) {
    const Floats d;
    hn::Store(color.a, d, a + i), hn::Store(color.b, d, b + i), hn::Store(color.c, d, c + i);
  }
};

// Tints up to kBlock pixels, in whole vectors. Each step is taken by all of them before the next: the steps of one vector
// wait for each other, those of several do not.
class OklabBlock {
 public:
  explicit OklabBlock(const Tint& tint) : tint_(tint), scene_(tint.reference_lightness) {}

  void Make(const float* const* albedo, std::size_t count, std::uint16_t* HWY_RESTRICT texels) {
    all_known_ = true;
    for (std::size_t i = 0; i < count; i += hn::Lanes(Floats())) Read(texels + 4 * i, i);
    for (std::size_t i = 0; i < count; i += hn::Lanes(Floats())) {
      const Floats d;
      Mix({hn::LoadU(d, albedo[0] + i), hn::LoadU(d, albedo[1] + i), hn::LoadU(d, albedo[2] + i)}, i);
    }
    if (HWY_UNLIKELY(!all_known_)) std::copy_n(texels, 4 * count, before_);
    for (std::size_t i = 0; i < count; i += hn::Lanes(Floats())) Write(texels + 4 * i, i);
    Settle(count, texels);
    if (HWY_UNLIKELY(!all_known_)) MakePlainly(albedo, count, texels);
  }

 private:
  // The paint's Oklab.
  HWY_INLINE void Read(const std::uint16_t* HWY_RESTRICT texels, std::size_t i) {
    const Floats d;
    const Codes codes(texels);
    const Color paint{hn::GatherIndex(d, srgb_.decoded, codes.red), hn::GatherIndex(d, srgb_.decoded, codes.green),
                      hn::GatherIndex(d, srgb_.decoded, codes.blue)};
    Mask unknown = hn::Lt(hn::Zero(d), hn::Zero(d));
    colors_.Store(OklabFromLinear(d, paint, unknown), i);
    Mark(unknown, i, read_unknown_);
  }

  // From the paint's Oklab to the result, linear.
  HWY_INLINE void Mix(Color albedo, std::size_t i) {
    const Floats d;
    scene_.Become(albedo, tint_.reference_lightness);
    const Color own = colors_.Load(i), target = Target(scene_, own.a, tint_.reference_lightness);
    const Float weight = All(tint_.weight);
    const auto mix = [&](Float o, Float t) HWY_ATTR { return hn::Add(o, hn::Mul(hn::Sub(t, o), weight)); };
    const Color mixed = Each(mix, own, target);
    Color result = LinearFromOklab(d, mixed);
    const Float high = All(1.0f + kSlack);
    const Mask in = InGamut(result, All(-kSlack), high);
    if (HWY_UNLIKELY(!hn::AllTrue(d, in))) {
      result = LinearFromOklab(d, WithChroma(mixed, ChromaThatFits(mixed, hn::Not(in), high)));
    }
    colors_.Store(result, i);
    Mark(scene_.unusual, i, scene_unknown_);
  }

  HWY_INLINE void Mark(Mask unknown, std::size_t i, LaneMarks& marks) {
    marks.Set(Floats(), i, unknown);
    all_known_ &= hn::AllFalse(Floats(), unknown);
  }

  HWY_INLINE void Write(std::uint16_t* HWY_RESTRICT texels, std::size_t i) {
    const Floats d;
    const Color linear = colors_.Load(i);
    Mask red_doubt, green_doubt, blue_doubt;
    const Int red = Encode(linear.a, red_doubt), green = Encode(linear.b, green_doubt), blue = Encode(linear.c, blue_doubt);
    red_doubtful_.Set(d, i, red_doubt), green_doubtful_.Set(d, i, green_doubt), blue_doubtful_.Set(d, i, blue_doubt);
    Codes(texels).Replace(red, green, blue, texels);
  }

  HWY_INLINE void Settle(std::size_t count, std::uint16_t* HWY_RESTRICT texels) const {
    const auto settle = [&](const LaneMarks& doubtful, const float* linear, std::size_t c) {
      doubtful.ForEach(Floats(), count, [&](std::size_t i) {
        texels[4 * i + c] = srgb_.Encode(linear[i], texels[4 * i + c]);
      });
    };
    settle(red_doubtful_, colors_.a, 0), settle(green_doubtful_, colors_.b, 1), settle(blue_doubtful_, colors_.c, 2);
  }

  HWY_NOINLINE void MakePlainly(const float* const* albedo, std::size_t count, std::uint16_t* HWY_RESTRICT texels) const {
    const auto make = [&](std::size_t i) {
      std::copy_n(before_ + 4 * i, 4, texels + 4 * i);
      tint_.Apply({albedo[0][i], albedo[1][i], albedo[2][i]}, texels + 4 * i);
    };
    read_unknown_.ForEach(Floats(), count, make);
    scene_unknown_.ForEach(Floats(), count, make);
  }

  const Tint& tint_;
  const Srgb16Tables srgb_ = Srgb16();
  Scene scene_;
  Colors colors_;  // the paint's Oklab, then the result
  LaneMarks red_doubtful_, green_doubtful_, blue_doubtful_, read_unknown_, scene_unknown_;
  std::uint16_t before_[4 * kBlock];  // where not all are known
  bool all_known_ = true;
};

void OklabTintHere(const float* const* albedo, std::size_t count, const Tint& tint, std::uint16_t* texels) {
  ForEachBlock(OklabBlock(tint), albedo, count, texels);
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(OklabTintHere);

void OklabTint(const float* const albedo[3], std::size_t count, const Tint& tint, std::uint16_t* texels) {
  HWY_DYNAMIC_DISPATCH(OklabTintHere)(albedo, count, tint, texels);
}

}  // namespace scumble::internal
#endif
