#include "measure/texture/normal_tone.h"

#include <algorithm>

#include "core/filter/gaussian_blur.h"
#include "core/image/color.h"
#include "core/image/oklab.h"

namespace scumble::internal {
namespace {

// Of Gaussians in bins: 1.5 are 0.05 of a unit normal, less than chunks differ by.
constexpr double kWidths[] = {1.5, 3.0, 6.0, 12.0, 24.0, 48.0};
constexpr float kLeastWeight = 1.0f;  // in pixels a bin

}  // namespace

glm::vec3 OklabOf(const std::uint16_t* texel) {
  return OklabFromLinear({Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])});
}

NormalTone::NormalTone(const Picture& picture, const NormalPlanes& normal, std::span<const std::uint8_t> usable) {
  constexpr std::size_t kBins = std::size_t(kSide) * kSide;
  std::array<std::vector<float>, 4> sums;  // of L, a, b, and of pixels
  for (auto& sum : sums) sum.resize(kBins);
  for (std::size_t i = 0; i < usable.size(); ++i) {
    if (!usable[i]) continue;
    const glm::vec3 color = OklabOf(picture.rgba.data() + 4 * i);
    const std::size_t bin = BinOf(normal[0][i], normal[1][i]);
    for (int c = 0; c < 3; ++c) sums[std::size_t(c)][bin] += color[c];
    sums[3][bin] += 1.0f;
  }
  for (auto& mean : mean_) mean.resize(kBins);
  std::vector<bool> known(kBins);
  for (const double sigma : kWidths) {
    std::array<std::vector<float>, 4> wide;
    for (std::size_t c = 0; c < 4; ++c) wide[c] = GaussianBlur(sums[c], kSide, kSide, sigma);
    for (std::size_t i = 0; i < kBins; ++i) {
      if (known[i] || !(wide[3][i] > kLeastWeight)) continue;
      for (std::size_t c = 0; c < 3; ++c) mean_[c][i] = wide[c][i] / wide[3][i];
      known[i] = true;
    }
  }
}

std::size_t NormalTone::BinOf(float x, float y) {
  const auto bin = [](float component) {
    return std::size_t(std::clamp((component + 1.0f) * (0.5f * kSide), 0.0f, kSide - 1.0f));
  };
  return bin(y) * kSide + bin(x);
}

glm::vec3 NormalTone::At(float x, float y) const {
  const auto place = [](float component) {
    return std::clamp((component + 1.0f) * (0.5f * kSide) - 0.5f, 0.0f, kSide - 1.001f);
  };
  const float u = place(x), v = place(y);
  const auto column = std::size_t(u), row = std::size_t(v);
  const float right = u - static_cast<float>(column), below = v - static_cast<float>(row);
  glm::vec3 tone;
  for (int c = 0; c < 3; ++c) {
    const float* const at = mean_[std::size_t(c)].data() + row * kSide + column;
    const float upper = (1.0f - right) * at[0] + right * at[1];
    const float lower = (1.0f - right) * at[kSide] + right * at[kSide + 1];
    tone[c] = (1.0f - below) * upper + below * lower;
  }
  return tone;
}

}  // namespace scumble::internal
