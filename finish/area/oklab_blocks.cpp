#include "finish/area/oklab_blocks.h"

#include <algorithm>
#include <array>

namespace scumble::internal {

void PutBlock(const OklabBlock& before, float share, const std::uint8_t* only, std::size_t count, OklabBlock& after,
              std::uint16_t* texels) {
  const auto mix = [&](const auto& from, auto& to) {
    for (std::size_t i = 0; i < count && share < 1.0f; ++i) to[i] = from[i] + (to[i] - from[i]) * share;
  };
  mix(before.lightness, after.lightness), mix(before.a, after.a), mix(before.b, after.b);
  std::uint16_t made[4 * kOklabBlock];
  std::copy_n(texels, 4 * count, made);
  std::array<std::uint32_t, kOklabBlock> puts;
  std::uint32_t leaves = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const bool same =
        (after.lightness[i] == before.lightness[i]) & (after.a[i] == before.a[i]) & (after.b[i] == before.b[i]);
    puts[i] = !same & (texels[4 * i + 3] != 0) & (!only || only[i]) ? 1u : 0u;
    leaves |= puts[i] ^ 1u;
  }
  TexelsFromOklab(after, count, made);
  if (leaves == 0) {
    std::copy_n(made, 4 * count, texels);
    return;
  }
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
  ForEachOklabBlock(pixels, [&](std::size_t first, std::size_t count) {
    float* const out = tone.data() + first;
    if (of_light) {
      const float* const light = guides.Plane(Layer::kLuminance).data() + first;
      for (std::size_t i = 0; i < count; ++i) out[i] = light[i] * per_bright;
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
