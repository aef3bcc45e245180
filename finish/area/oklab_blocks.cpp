#include "finish/area/oklab_blocks.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "core/filter/wide_loops.h"
#include "finish/area/even_light.h"

namespace scumble::internal {

namespace {

// 0 where a colour stays or its texel has no alpha, else 1.
SCUMBLE_WIDE_LOOPS void FindChanges(const OklabBlock& before, const OklabBlock& after, const std::uint16_t* texels,
                                    std::size_t count, std::uint32_t* changes) {
  for (std::size_t i = 0; i < count; ++i) {
    const bool same =
        (after.lightness[i] == before.lightness[i]) & (after.a[i] == before.a[i]) & (after.b[i] == before.b[i]);
    changes[i] = !same & (texels[4 * i + 3] != 0) ? 1u : 0u;
  }
}

}  // namespace

void PutBlock(const OklabBlock& before, float share, const std::uint8_t* only, std::size_t count, OklabBlock& after,
              std::uint16_t* texels) {
  const auto mix = [&](const auto& from, auto& to) {
    for (std::size_t i = 0; i < count && share < 1.0f; ++i) to[i] = from[i] + (to[i] - from[i]) * share;
  };
  mix(before.lightness, after.lightness), mix(before.a, after.a), mix(before.b, after.b);
  std::array<std::uint32_t, kOklabBlock> puts;
  FindChanges(before, after, texels, count, puts.data());
  for (std::size_t i = 0; i < count && only; ++i) puts[i] = only[i] ? puts[i] : 0u;
  const auto put = static_cast<std::size_t>(std::accumulate(puts.begin(), puts.begin() + std::ptrdiff_t(count), 0u));
  if (put == count) return TexelsFromOklab(after, count, texels);
  if (put == 0) return;
  std::uint16_t made[4 * kOklabBlock];
  std::copy_n(texels, 4 * count, made);
  TexelsFromOklab(after, count, made);
  for (std::size_t i = 0; i < count; ++i) {
    if (puts[i]) std::copy_n(made + 4 * i, 3, texels + 4 * i);
  }
}

FloatPlane ToneOf(EdgesPass::Tone of, const FinishFrame& frame, const Picture& picture) {
  const std::size_t pixels = picture.rgba.size() / 4;
  FloatPlane tone(pixels);
  if (of == EdgesPass::Tone::kPaint) {
    ForEachOklabBlock(pixels, [&](std::size_t first, std::size_t count) {
      OklabBlock block;
      OklabFromTexels(picture.rgba.data() + 4 * first, count, block);
      std::copy_n(block.lightness.begin(), count, tone.begin() + std::ptrdiff_t(first));
    });
    return tone;
  }
  const GuideSet& guides = *frame.guides;
  const auto coverage = guides.Plane(Layer::kCoverage);
  const bool of_light = of == EdgesPass::Tone::kLight;
  const auto per_bright = static_cast<float>(1.0 / frame.measures.bright);
  std::span<const float> light;
  if (of_light) light = guides.Plane(Layer::kLuminance);
  FloatPlane even;
  if (of_light && !HasExactLight(guides)) {
    FloatPlane covered(pixels);
    ForEachOklabBlock(pixels, [&](std::size_t first, std::size_t count) {
      for (std::size_t i = first; i < first + count; ++i) covered[i] = coverage[i] > 0.0f ? 1.0f : 0.0f;
    });
    even = EvenedLight(light, {covered}, guides.width(), guides.height(),
                       LightNoiseOf(guides) * static_cast<float>(frame.measures.bright), frame.Apart());
    light = even;
  }
  ForEachOklabBlock(pixels, [&](std::size_t first, std::size_t count) {
    float* const out = tone.data() + first;
    if (of_light) {
      for (std::size_t i = 0; i < count; ++i) out[i] = light[first + i] * per_bright;
      LightnessFromGreys(out, count, out);
    } else {
      const auto plane = [&](int c) { return guides.Plane(Layer::kAlbedo, c).data() + first; };
      OklabBlock block;
      OklabFromPlanes({plane(0), plane(1), plane(2)}, count, block);
      std::copy_n(block.lightness.begin(), count, out);
    }
    // Background has no tone: it counts as bare paper.
    for (std::size_t i = 0; i < count; ++i) out[i] = coverage[first + i] > 0.0f ? out[i] : 1.0f;
  });
  return tone;
}

}  // namespace scumble::internal
