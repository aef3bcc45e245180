#include "transfer/frame/compose.h"

#include <algorithm>

#include "core/image/color.h"

namespace scumble::internal {
namespace {

// A row of the background.
class Backdrop {
 public:
  Backdrop(const Background& background, int y) {
    const Paper& paper = background.paper;
    if (background.over) {
      texels_ = background.over->At(0, y), width_ = background.over->width;
    } else if (paper.picture) {
      texels_ = paper.picture->At(0, y % paper.picture->height), width_ = paper.picture->width;
    } else if (paper.color) {
      std::copy_n(paper.color->begin(), 3, one_), one_[3] = 65535;
    }
  }
  Backdrop(const Backdrop&) = delete;
  const std::uint16_t* At(int x) const {
    return texels_ ? texels_ + 4 * std::size_t(x < width_ ? x : x % width_) : one_;
  }

 private:
  const std::uint16_t* texels_ = nullptr;  // null: one colour everywhere
  int width_ = 0;
  std::uint16_t one_[4] = {0, 0, 0, 0};
};

}  // namespace

void BlendOver(std::uint16_t* front, const std::uint16_t* back) {
  if (front[3] == 65535 || back[3] == 0) return;
  if (front[3] == 0) {
    std::copy_n(back, 4, front);
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
  return ForEachRow(region, progress, [&](int y) {
    const Backdrop behind(background, y);
    const float* covered = coverage.empty() ? nullptr : coverage.data() + std::size_t(y) * picture.width;
    std::uint16_t* pixel = picture.At(region.x0, y);
    for (int x = region.x0; x < region.x1; ++x, pixel += 4) {
      const float share = covered ? std::min(covered[x], 1.0f) : 1.0f;
      if (!(share > 0.0f)) {
        const std::uint16_t* shown = behind.At(x);
        if (shown[3] != 0)
          std::copy_n(shown, 4, pixel);
        else
          std::fill_n(pixel, 4, std::uint16_t{0});
        continue;
      }
      if (share < 1.0f) pixel[3] = static_cast<std::uint16_t>(static_cast<float>(pixel[3]) * share + 0.5f);
      if (pixel[3] != 65535) BlendOver(pixel, behind.At(x));
    }
  });
}

}  // namespace scumble::internal
