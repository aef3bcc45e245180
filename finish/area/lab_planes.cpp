#include "finish/area/lab_planes.h"

#include <algorithm>

#include "finish/area/oklab_blocks.h"

namespace scumble::internal {

LabPlanes PlanesOf(const Picture& picture) {
  LabPlanes planes;
  for (auto* plane : {&planes.lightness, &planes.a, &planes.b}) plane->resize(picture.rgba.size() / 4);
  ForEachOklabBlock(picture.rgba.size() / 4, [&](std::size_t first, std::size_t count) {
    OklabBlock block;
    OklabFromTexels(picture.rgba.data() + 4 * first, count, block);
    std::copy_n(block.lightness.begin(), count, planes.lightness.begin() + std::ptrdiff_t(first));
    std::copy_n(block.a.begin(), count, planes.a.begin() + std::ptrdiff_t(first));
    std::copy_n(block.b.begin(), count, planes.b.begin() + std::ptrdiff_t(first));
  });
  return planes;
}

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

void PutPlanes(const LabPlanes& planes, const LabPlanes& before, double strength, std::span<const std::uint8_t> only,
               Picture& picture) {
  ForEachOklabBlock(picture.rgba.size() / 4, [&](std::size_t first, std::size_t count) {
    const auto block_of = [&](const LabPlanes& from) {
      OklabBlock block;
      std::copy_n(from.lightness.data() + first, count, block.lightness.begin());
      std::copy_n(from.a.data() + first, count, block.a.begin());
      std::copy_n(from.b.data() + first, count, block.b.begin());
      return block;
    };
    OklabBlock made = block_of(planes);
    PutBlock(block_of(before), static_cast<float>(strength), only.empty() ? nullptr : only.data() + first, count, made,
             picture.rgba.data() + 4 * first);
  });
}

}  // namespace scumble::internal
