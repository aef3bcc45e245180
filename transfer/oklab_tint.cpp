#include "transfer/oklab_tint.h"

#include <algorithm>

#include "image/color.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "transfer/oklab_tint.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "transfer/oklab-inl.h"
#include "transfer/srgb_encode-inl.h"

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

using Floats = hn::CappedTag<float, 16>;
using Ints = hn::RebindToSigned<Floats>;
using Words = hn::RebindToUnsigned<Floats>;
using Float = hn::Vec<Floats>;
using Int = hn::Vec<Ints>;
using Mask = hn::Mask<Floats>;
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

HWY_INLINE Float Mix(Float own, Float target, Float weight) {
  return hn::Add(own, hn::Mul(hn::Sub(target, own), weight));
}

HWY_INLINE Int Encode(Float linear, Mask& doubtful) {
  const Floats d;
  const Float value = hn::Min(hn::Max(linear, hn::Zero(d)), All(1.0f));
  const Float code = hn::Min(CodeOf(d, value), All(65535.0f));
  return RoundCode(d, code, hn::MulAdd(code, All(kRelativeDoubt), All(kDoubt)), doubtful);
}

constexpr int kBlock = 256;  // pixels that are tinted before their doubtful codes are settled

// A stretch of pixels.
struct Block {
  const Tint& tint;
  const float* HWY_RESTRICT decoded = Srgb16Linear();
  Scene scene{tint.reference_lightness};

  explicit Block(const Tint& wanted) : tint(wanted) {}

  HWY_ALIGN float linear[3][kBlock];
  LaneMarks<3 * kBlock> doubtful;

  // The pixels of one vector, the first of which is at `from`.
  HWY_INLINE void Make(Color albedo, std::size_t from, std::uint16_t* HWY_RESTRICT texels) {
    const Floats d;
    const Words du;
    const Ints di;
    scene.Become(albedo, tint.reference_lightness);
    hn::Vec<Words> red_green, blue_alpha;
    auto* words = reinterpret_cast<std::uint32_t*>(texels);
    hn::LoadInterleaved2(du, words, red_green, blue_alpha);
    const auto lower = hn::Set(du, 0xffff);
    const Color paint{hn::GatherIndex(d, decoded, hn::BitCast(di, hn::And(red_green, lower))),
                      hn::GatherIndex(d, decoded, hn::BitCast(di, hn::ShiftRight<16>(red_green))),
                      hn::GatherIndex(d, decoded, hn::BitCast(di, hn::And(blue_alpha, lower)))};
    Mask unknown = scene.unusual;
    const Color own = OklabFromLinear(d, paint, unknown);
    const Color target = Target(scene, own.a, tint.reference_lightness);
    const Float weight = All(tint.weight);
    const Color mixed{Mix(own.a, target.a, weight), Mix(own.b, target.b, weight), Mix(own.c, target.c, weight)};
    Color result = LinearFromOklab(d, mixed);
    const Float high = All(1.0f + kSlack);
    const Mask in = InGamut(result, All(-kSlack), high);
    if (HWY_UNLIKELY(!hn::AllTrue(d, in))) {
      result = LinearFromOklab(d, WithChroma(mixed, ChromaThatFits(mixed, hn::Not(in), high)));
    }
    hn::Store(result.a, d, linear[0] + from), hn::Store(result.b, d, linear[1] + from);
    hn::Store(result.c, d, linear[2] + from);
    const int vector = static_cast<int>(from / hn::Lanes(d));
    Mask red_doubt, green_doubt, blue_doubt;
    const auto red = hn::BitCast(du, Encode(result.a, red_doubt));
    const auto green = hn::BitCast(du, Encode(result.b, green_doubt));
    const auto blue = hn::BitCast(du, Encode(result.c, blue_doubt));
    doubtful.Set(d, 3 * vector, red_doubt), doubtful.Set(d, 3 * vector + 1, green_doubt);
    doubtful.Set(d, 3 * vector + 2, blue_doubt);
    const auto new_red_green = hn::Or(red, hn::ShiftLeft<16>(green)), new_blue_alpha = hn::Or(blue, hn::AndNot(lower, blue_alpha));
    hn::StoreInterleaved2(new_red_green, new_blue_alpha, du, words);
    if (HWY_UNLIKELY(!hn::AllFalse(d, unknown))) MakePlainly(albedo, red_green, blue_alpha, unknown, from, texels);
  }

  // The same of the unknown ones.
  HWY_NOINLINE void MakePlainly(Color albedo, hn::Vec<Words> red_green, hn::Vec<Words> blue_alpha, Mask unknown,
                                std::size_t from, std::uint16_t* HWY_RESTRICT texels) {
    const Floats d;
    HWY_ALIGN float albedos[3][16];
    HWY_ALIGN std::uint16_t before[4 * 16];
    hn::Store(albedo.a, d, albedos[0]), hn::Store(albedo.b, d, albedos[1]), hn::Store(albedo.c, d, albedos[2]);
    hn::StoreInterleaved2(red_green, blue_alpha, Words(), reinterpret_cast<std::uint32_t*>(before));
    LaneMarks<1> marks;
    marks.Set(d, 0, unknown);
    marks.ForEach(1, [&](int, std::size_t lane) {
      std::uint16_t* texel = texels + 4 * lane;
      std::copy_n(before + 4 * lane, 4, texel);
      tint.Apply({albedos[0][lane], albedos[1][lane], albedos[2][lane]}, texel);
      for (int c = 0; c < 3; ++c) linear[c][from + lane] = Srgb16ToLinear(texel[c]);
    });
  }

  HWY_INLINE void Settle(std::size_t count, std::uint16_t* HWY_RESTRICT texels) {
    const std::size_t lanes = hn::Lanes(Floats());
    doubtful.ForEach(static_cast<int>(3 * ((count + lanes - 1) / lanes)), [&](std::size_t at, std::size_t lane) {
      const std::size_t i = std::size_t(at) / 3 * lanes + lane, c = std::size_t(at) % 3;
      if (i < count) texels[4 * i + c] = Srgb16FromLinear(linear[c][i], texels[4 * i + c]);
    });
  }
};

void OklabTintHere(const float* const* albedo, std::size_t count, const Tint& tint, std::uint16_t* texels) {
  const Floats d;
  const std::size_t lanes = hn::Lanes(d);
  Block block(tint);
  for (std::size_t first = 0; first < count; first += kBlock) {
    const std::size_t size = std::min<std::size_t>(kBlock, count - first);
    std::size_t i = 0;
    for (; i + lanes <= size; i += lanes) {
      const std::size_t at = first + i;
      block.Make({hn::LoadU(d, albedo[0] + at), hn::LoadU(d, albedo[1] + at), hn::LoadU(d, albedo[2] + at)}, i, texels + 4 * at);
    }
    if (i < size) {
      HWY_ALIGN float rest[3][16];
      HWY_ALIGN std::uint16_t last[4 * 16] = {};
      const std::size_t left = size - i, at = first + i;
      for (int c = 0; c < 3; ++c) {
        std::fill_n(rest[c], 16, albedo[c][count - 1]);
        std::copy_n(albedo[c] + at, left, rest[c]);
      }
      std::copy_n(texels + 4 * at, 4 * left, last);
      block.Make({hn::Load(d, rest[0]), hn::Load(d, rest[1]), hn::Load(d, rest[2])}, i, last);
      std::copy_n(last, 4 * left, texels + 4 * at);
    }
    block.Settle(size, texels + 4 * first);
  }
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
