#include "transfer/compose.h"

#include <algorithm>
#include <array>

#include "image/color.h"

namespace scumble::internal {
namespace {

using Texel = std::array<std::uint16_t, 4>;

}  // namespace

void BlendOver(std::uint16_t* front, const Texel& back) {
  if (front[3] == 65535 || back[3] == 0) return;
  if (front[3] == 0) {
    std::copy(back.begin(), back.end(), front);
    return;
  }
  const float front_alpha = static_cast<float>(front[3]) / 65535.0f;
  const float back_alpha = static_cast<float>(back[3]) / 65535.0f * (1.0f - front_alpha);
  const float alpha = front_alpha + back_alpha;
  for (int c = 0; c < 3; ++c) {
    const float sum = Srgb16ToLinear(front[c]) * front_alpha + Srgb16ToLinear(back[c]) * back_alpha;
    front[c] = Srgb16FromLinear(sum / alpha);
  }
  front[3] = static_cast<std::uint16_t>(std::min(65535.0f, alpha * 65535.0f + 0.5f));
}

bool Compose(std::span<const float> coverage, const Background& background, const Region& region, Picture& picture,
             RowProgress& progress) {
  const Paper& paper = background.paper;
  const auto behind = [&](int x, int y) -> Texel {
    const std::uint16_t* texel = nullptr;
    if (background.over) texel = background.over->At(x, y);
    else if (paper.picture) texel = paper.picture->At(x % paper.picture->width, y % paper.picture->height);
    if (texel) return {texel[0], texel[1], texel[2], texel[3]};
    if (paper.color) return {(*paper.color)[0], (*paper.color)[1], (*paper.color)[2], 65535};
    return {0, 0, 0, 0};
  };
  return ForEachRow(region, progress, [&](int y) {
    for (int x = region.x0; x < region.x1; ++x) {
      std::uint16_t* pixel = picture.At(x, y);
      const float covered = std::min(coverage[std::size_t(y) * picture.width + x], 1.0f);
      if (covered > 0.0f) {
        pixel[3] = static_cast<std::uint16_t>(static_cast<float>(pixel[3]) * covered + 0.5f);
      } else {
        std::fill_n(pixel, 4, std::uint16_t{0});
      }
      BlendOver(pixel, behind(x, y));
    }
  });
}

}  // namespace scumble::internal
