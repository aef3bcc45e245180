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

// Whole vectors: `count` is a multiple of kWidest.
void DecodeHere(const std::uint16_t* texels, std::size_t count, float* lightness, float* a, float* b) {
  for (std::size_t i = 0; i < count; i += hn::Lanes(Floats())) {
    const LaneColor cones = ConesFromLinear(Each(LinearFromCode, LoadTexels(texels + 4 * i)));
    const LaneColor lab = OklabFromRoots(Each(CubeRoot, cones));
    hn::Store(lab.r.v, Floats(), lightness + i);
    hn::Store(lab.g.v, Floats(), a + i);
    hn::Store(lab.b.v, Floats(), b + i);
  }
}

void FromLinearHere(const OklabBlock& linear, std::size_t count, OklabBlock& block) {
  const auto load = [](const std::array<float, kOklabBlock>& plane, std::size_t i) HWY_ATTR {
    const Lane value = hn::Load(Floats(), plane.data() + i);
    return Select(Less(0.0f, value), Min(value, 1.0f), 0.0f);
  };
  for (std::size_t i = 0; i < count; i += hn::Lanes(Floats())) {
    const LaneColor cones = ConesFromLinear({load(linear.lightness, i), load(linear.a, i), load(linear.b, i)});
    const LaneColor lab = OklabFromRoots(Each(CubeRoot, cones));
    hn::Store(lab.r.v, Floats(), block.lightness.data() + i);
    hn::Store(lab.g.v, Floats(), block.a.data() + i);
    hn::Store(lab.b.v, Floats(), block.b.data() + i);
  }
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
    StoreTexels(Each(ClampedCode, linear), texels + 4 * i);
  }
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
  OklabBlock linear{};
  std::copy_n(planes[0], count, linear.lightness.begin());
  std::copy_n(planes[1], count, linear.a.begin());
  std::copy_n(planes[2], count, linear.b.begin());
  HWY_DYNAMIC_DISPATCH(FromLinearHere)(linear, count, block);
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
