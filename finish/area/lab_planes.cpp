#include "finish/area/lab_planes.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/filter/oklab_rows.h"

namespace scumble::internal {
namespace {

// Calls visit(first, count) for blocks of up to kOklabBlock pixels, from several threads.
template <class Visit>
void ForEachBlock(const Picture& picture, const Visit& visit) {
  const std::size_t pixels = picture.rgba.size() / 4, blocks = (pixels + kOklabBlock - 1) / kOklabBlock;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, 16), [&](const auto& part) {
    for (std::size_t i = part.begin(); i != part.end(); ++i)
      visit(i * kOklabBlock, std::min(kOklabBlock, pixels - i * kOklabBlock));
  });
}

}  // namespace

LabPlanes PlanesOf(const Picture& picture) {
  LabPlanes planes;
  for (auto* plane : {&planes.lightness, &planes.a, &planes.b}) plane->resize(picture.rgba.size() / 4);
  ForEachBlock(picture, [&](std::size_t first, std::size_t count) {
    OklabBlock block;
    OklabFromTexels(picture.rgba.data() + 4 * first, count, block);
    std::copy_n(block.lightness.begin(), count, planes.lightness.begin() + std::ptrdiff_t(first));
    std::copy_n(block.a.begin(), count, planes.a.begin() + std::ptrdiff_t(first));
    std::copy_n(block.b.begin(), count, planes.b.begin() + std::ptrdiff_t(first));
  });
  return planes;
}

void PutPlanes(const LabPlanes& planes, const LabPlanes& before, double strength, std::span<const std::uint8_t> only,
               Picture& picture) {
  const auto share = static_cast<float>(strength);
  ForEachBlock(picture, [&](std::size_t first, std::size_t count) {
    OklabBlock block{};
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t p = first + i;
      const auto mix = [&](float from, float to) { return share >= 1.0f ? to : from + (to - from) * share; };
      block.lightness[i] = mix(before.lightness[p], planes.lightness[p]);
      block.a[i] = mix(before.a[p], planes.a[p]);
      block.b[i] = mix(before.b[p], planes.b[p]);
    }
    std::uint16_t* const texels = picture.rgba.data() + 4 * first;
    std::uint16_t made[4 * kOklabBlock];
    std::copy_n(texels, 4 * count, made);
    TexelsFromOklab(block, count, made);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t p = first + i;
      const bool same =
          block.lightness[i] == before.lightness[p] && block.a[i] == before.a[p] && block.b[i] == before.b[p];
      if (same || texels[4 * i + 3] == 0 || (!only.empty() && !only[p])) continue;
      std::copy_n(made + 4 * i, 3, texels + 4 * i);
    }
  });
}

}  // namespace scumble::internal
