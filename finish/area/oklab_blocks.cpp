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
  TexelsFromOklab(after, count, made);
  for (std::size_t i = 0; i < count; ++i) {
    const bool same =
        after.lightness[i] == before.lightness[i] && after.a[i] == before.a[i] && after.b[i] == before.b[i];
    if (!same && texels[4 * i + 3] != 0 && (!only || only[i])) std::copy_n(made + 4 * i, 3, texels + 4 * i);
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
  const auto coverage = frame.guides->Plane(Layer::kCoverage);
  const bool of_light = of == EdgesPass::Tone::kLight;
  const auto luminance = of_light ? frame.guides->Plane(Layer::kLuminance) : std::span<const float>();
  const auto per_bright = static_cast<float>(1.0 / frame.measures.bright);
  ForEachOklabBlock(pixels, [&](std::size_t first, std::size_t count) {
    std::array<float, kOklabBlock> light;
    std::array<const float*, 3> planes{light.data(), light.data(), light.data()};
    for (std::size_t i = 0; i < count && of_light; ++i) light[i] = luminance[first + i] * per_bright;
    for (std::size_t c = 0; c < 3 && !of_light; ++c)
      planes[c] = frame.guides->Plane(Layer::kAlbedo, static_cast<int>(c)).data() + first;
    OklabBlock block;
    OklabFromPlanes(planes, count, block);
    // Background has no tone: it counts as bare paper.
    for (std::size_t i = 0; i < count; ++i) tone[first + i] = coverage[first + i] > 0.0f ? block.lightness[i] : 1.0f;
  });
  return tone;
}

}  // namespace scumble::internal
