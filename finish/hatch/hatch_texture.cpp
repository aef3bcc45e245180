#include "finish/hatch/hatch_texture.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>

#include "finish/finish.h"

namespace scumble {
namespace {

constexpr int kSmallestTexture = 16;
constexpr float kWhite = 3.0f * 65535.0f;  // the sum of three channels

// Replaces numbers by their ranks, 0 … 1; equal ones get the middle of theirs.
void Rank(std::vector<float>& values) {
  std::vector<std::uint32_t> order(values.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return values[a] < values[b]; });
  const std::vector<float> given = values;
  const auto count = static_cast<float>(values.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first;
    while (last < order.size() && given[order[last]] == given[order[first]]) ++last;
    const float middle = 0.5f * static_cast<float>(first + last) / count;
    for (; first < last; ++first) values[order[first]] = middle;
  }
}

HatchTexture::Level Halved(const HatchTexture::Level& level) {
  HatchTexture::Level half{level.size / 2, {}};
  half.thresholds.resize(std::size_t(half.size) * std::size_t(half.size));
  for (int y = 0; y < half.size; ++y) {
    for (int x = 0; x < half.size; ++x) {
      const float* const at = level.thresholds.data() + std::size_t(2 * y) * std::size_t(level.size) + 2 * x;
      half.thresholds[std::size_t(y) * std::size_t(half.size) + std::size_t(x)] =
          0.25f * (at[0] + at[1] + at[level.size] + at[level.size + 1]);
    }
  }
  Rank(half.thresholds);
  return half;
}

}  // namespace

Expected<HatchTexture> MakeHatchTexture(const Picture& picture) {
  if (picture.width != picture.height || picture.width < kSmallestTexture) {
    return InputError("the picture is " + std::to_string(picture.width) + "×" + std::to_string(picture.height) +
                      "; expected a square of at least " + std::to_string(kSmallestTexture) + " pixels");
  }
  HatchTexture texture;
  texture.levels.push_back({picture.width, {}});
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    const std::uint16_t* const texel = picture.rgba.data() + i;
    const float alpha = static_cast<float>(texel[3]) / 65535.0f,
                ink = static_cast<float>(texel[0]) + texel[1] + texel[2];
    texture.levels[0].thresholds.push_back(alpha * ink + (1.0f - alpha) * kWhite);
  }
  const auto [darkest, lightest] = std::ranges::minmax(texture.levels[0].thresholds);
  if (darkest == lightest) {
    return InputError(
        "the picture has one grey all over, so it shows no strokes; expected dark strokes on white or on "
        "transparency");
  }
  Rank(texture.levels[0].thresholds);
  while (texture.levels.back().size >= 2 * kSmallestTexture) texture.levels.push_back(Halved(texture.levels.back()));
  return texture;
}

namespace internal {
namespace {

// Thresholds that lie so near to each other as half of this are parts of one edge.
constexpr float kEdge = 0.16f;

// The level at which thresholds that are equally frequent in 0 … 1, with edges that soft, cover `share`.
float LevelFor(float share) {
  if (share < 0.5f * kEdge) return std::sqrt(2.0f * kEdge * share) - 0.5f * kEdge;
  if (share > 1.0f - 0.5f * kEdge) return 1.0f + 0.5f * kEdge - std::sqrt(2.0f * kEdge * (1.0f - share));
  return share;
}

}  // namespace

TextureStrokes::TextureStrokes(const HatchTexture& texture, double spacing, double reference) {
  const auto pixels = static_cast<float>(spacing) * kSpacingsOfTexture;  // of the texture's side
  const float least = std::max(pixels, static_cast<float>(reference) * kSpacingsOfTexture);
  std::size_t level = 0;
  while (level + 1 < texture.levels.size() && static_cast<float>(texture.levels[level + 1].size) >= least) ++level;
  level_ = &texture.levels[level];
  texels_per_pixel_ = static_cast<float>(level_->size) / pixels;
  // More than one a texel, as texels are turned against pixels; in the large picture's pixels.
  const float sized = static_cast<float>(reference) * kSpacingsOfTexture;
  const float large = std::max(2.0f, std::ceil(1.5f * static_cast<float>(level_->size) / sized));
  samples_ = std::max(2, static_cast<int>(std::ceil(large * sized / pixels - 0.01f)));
}

// The nearest: means of several would lie nearer to the middle, and ink would no longer be what the tone lacks.
float TextureStrokes::Threshold(glm::vec2 texel) const {
  const int size = level_->size;
  const auto wrapped = [size](float at) {
    const int rest = static_cast<int>(static_cast<std::int64_t>(std::floor(at)) % size);
    return std::size_t(rest < 0 ? rest + size : rest);
  };
  return level_->thresholds[wrapped(texel.y) * std::size_t(size) + wrapped(texel.x)];
}

float TextureStrokes::Cover(glm::vec2 at, Axis along, float share) const {
  if (!(share > 0.0f)) return 0.0f;
  if (share >= 1.0f) return 1.0f;
  const float level = LevelFor(share);
  const float step = 1.0f / static_cast<float>(samples_), first = 0.5f * step - 0.5f;
  float sum = 0.0f;
  for (int v = 0; v < samples_; ++v) {
    for (int u = 0; u < samples_; ++u) {
      const float x = first + step * static_cast<float>(u), y = first + step * static_cast<float>(v);
      const glm::vec2 off(x * along.x + y * along.y, y * along.x - x * along.y);
      sum += std::clamp((level - Threshold((at + off) * texels_per_pixel_)) / kEdge + 0.5f, 0.0f, 1.0f);
    }
  }
  return sum * step * step;
}

}  // namespace internal
}  // namespace scumble
