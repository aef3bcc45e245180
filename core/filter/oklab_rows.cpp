#include "core/filter/oklab_rows.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/filter/oklab_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/filter/vector_lane-inl.h"

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

// The colours of a block, a plane each. Functions of Planes take whole vectors: `count` is a multiple of kWidest.
//
// They go over a block several times, with a short step each: a colour's way from code to Oklab is one long chain of
// dependent operations, and a processor looks ahead far enough to work on many short chains at once, but not on two
// long ones.
struct Planes {
  float *x, *y, *z;
};

HWY_INLINE LaneColor Load(const Planes& planes, std::size_t i) {
  const Floats d;
  return {hn::Load(d, planes.x + i), hn::Load(d, planes.y + i), hn::Load(d, planes.z + i)};
}

HWY_INLINE void Store(LaneColor color, const Planes& planes, std::size_t i) {
  const Floats d;
  hn::Store(color.r.v, d, planes.x + i);
  hn::Store(color.g.v, d, planes.y + i);
  hn::Store(color.b.v, d, planes.z + i);
}

template <class Change>
HWY_INLINE void ForEachColor(const Planes& planes, std::size_t count, const Change& change) {
  for (std::size_t i = 0; i < count; i += hn::Lanes(Floats())) Store(change(Load(planes, i)), planes, i);
}

template <class Change>
HWY_INLINE void ForEachValue(const Planes& planes, std::size_t count, const Change& change) {
  for (float* const plane : {planes.x, planes.y, planes.z}) {
    for (std::size_t i = 0; i < count; i += hn::Lanes(Floats()))
      hn::Store(change(Lane(hn::Load(Floats(), plane + i))).v, Floats(), plane + i);
  }
}

HWY_INLINE void OklabFromLinear(const Planes& planes, std::size_t count) {
  ForEachColor(planes, count, [](LaneColor c) HWY_ATTR { return ConesFromLinear(c); });
  ForEachValue(planes, count, [](Lane x) HWY_ATTR { return CubeRoot(x); });
  ForEachColor(planes, count, [](LaneColor c) HWY_ATTR { return OklabFromRoots(c); });
}

void DecodeHere(const std::uint16_t* texels, std::size_t count, float* lightness, float* a, float* b) {
  const Planes planes{lightness, a, b};
  for (std::size_t i = 0; i < count; i += hn::Lanes(Floats())) Store(LoadTexels(texels + 4 * i), planes, i);
  ForEachValue(planes, count, [](Lane code) HWY_ATTR { return LinearFromCode(code); });
  OklabFromLinear(planes, count);
}

void FromLinearHere(std::size_t count, OklabBlock& block) {
  const Planes planes{block.lightness.data(), block.a.data(), block.b.data()};
  ForEachValue(planes, count, [](Lane value) HWY_ATTR { return Select(Less(0.0f, value), Min(value, 1.0f), 0.0f); });
  OklabFromLinear(planes, count);
}

void FromGreysHere(float* greys, std::size_t count) {
  for (std::size_t i = 0; i < count; i += hn::Lanes(Floats())) {
    const Lane value = hn::Load(Floats(), greys + i);
    hn::Store(CubeRoot(Select(Less(0.0f, value), Min(value, 1.0f), 0.0f)).v, Floats(), greys + i);
  }
}

HWY_INLINE LaneColor LinearOf(Lane lightness, Lane a, Lane b, Lane chroma) {
  return LinearFromRoots(RootsFromOklab({lightness, a * chroma, b * chroma}));
}

HWY_INLINE Choice InGamut(LaneColor c) {
  constexpr float kSlack = 1e-4f;
  return Both(Less(Max(Max(c.r, c.g), c.b), 1.0f + kSlack), Less(-kSlack, Min(Min(c.r, c.g), c.b)));
}

void EncodeHere(const float* of_lightness, const float* of_a, const float* of_b, std::size_t count,
                std::uint16_t* texels) {
  OklabBlock block;
  const Planes codes{block.lightness.data(), block.a.data(), block.b.data()};
  for (std::size_t i = 0; i < count; i += hn::Lanes(Floats())) {
    const Lane lightness = Min(Max(Lane(hn::Load(Floats(), of_lightness + i)), 0.0f), 1.0f);
    const Lane a = hn::Load(Floats(), of_a + i), b = hn::Load(Floats(), of_b + i);
    LaneColor linear = LinearOf(lightness, a, b, 1.0f);
    const Choice fits = InGamut(linear);
    if (!All(fits)) {
      Lane inside = 0.0f, outside = 1.0f;
      for (int step = 0; step < 10; ++step) {
        const Lane middle = 0.5f * (inside + outside);
        const Choice in = InGamut(LinearOf(lightness, a, b, middle));
        inside = Select(in, middle, inside);
        outside = Select(in, outside, middle);
      }
      linear = LinearOf(lightness, a, b, Select(fits, 1.0f, inside));
    }
    Store(linear, codes, i);
  }
  ForEachValue(codes, count, [](Lane linear) HWY_ATTR { return ClampedCode(linear); });
  for (std::size_t i = 0; i < count; i += hn::Lanes(Floats())) StoreTexels(Load(codes, i), texels + 4 * i);
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(DecodeHere);
HWY_EXPORT(FromLinearHere);
HWY_EXPORT(FromGreysHere);
HWY_EXPORT(EncodeHere);

namespace {

constexpr std::size_t kWidest = 16;  // floats of the widest vector

}  // namespace

// What is left of a block after whole vectors goes through a vector of its own.
void OklabFromTexels(const std::uint16_t* texels, std::size_t count, OklabBlock& block) {
  const std::size_t whole = count / kWidest * kWidest, left = count - whole;
  const auto decode = HWY_DYNAMIC_DISPATCH(DecodeHere);
  decode(texels, whole, block.lightness.data(), block.a.data(), block.b.data());
  if (left == 0) return;
  alignas(64) std::uint16_t last[4 * kWidest] = {};
  std::copy_n(texels + 4 * whole, 4 * left, last);
  decode(last, kWidest, block.lightness.data() + whole, block.a.data() + whole, block.b.data() + whole);
}

void OklabFromPlanes(const std::array<const float*, 3>& planes, std::size_t count, OklabBlock& block) {
  const std::size_t whole = (count + kWidest - 1) / kWidest * kWidest;
  const std::array<float*, 3> to{block.lightness.data(), block.a.data(), block.b.data()};
  for (std::size_t c = 0; c < 3; ++c) std::fill(std::copy_n(planes[c], count, to[c]), to[c] + whole, 0.0f);
  HWY_DYNAMIC_DISPATCH(FromLinearHere)(whole, block);
}

void LightnessFromGreys(const float* greys, std::size_t count, float* lightness) {
  alignas(64) std::array<float, kOklabBlock> values;
  std::copy_n(greys, count, values.begin());
  std::fill(values.begin() + std::ptrdiff_t(count), values.end(), 0.0f);
  HWY_DYNAMIC_DISPATCH(FromGreysHere)(values.data(), count);
  std::copy_n(values.begin(), count, lightness);
}

void TexelsFromOklab(const OklabBlock& block, std::size_t count, std::uint16_t* texels) {
  const std::size_t whole = count / kWidest * kWidest, left = count - whole;
  const auto encode = HWY_DYNAMIC_DISPATCH(EncodeHere);
  encode(block.lightness.data(), block.a.data(), block.b.data(), whole, texels);
  if (left == 0) return;
  alignas(64) std::array<float, kWidest> lightness{}, a{}, b{};
  std::copy_n(block.lightness.data() + whole, left, lightness.data());
  std::copy_n(block.a.data() + whole, left, a.data());
  std::copy_n(block.b.data() + whole, left, b.data());
  alignas(64) std::uint16_t last[4 * kWidest] = {};
  std::copy_n(texels + 4 * whole, 4 * left, last);
  encode(lightness.data(), a.data(), b.data(), kWidest, last);
  std::copy_n(last, 4 * left, texels + 4 * whole);
}

}  // namespace scumble::internal
#endif
