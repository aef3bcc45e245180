#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "finish/tone/point_effect.h"

namespace scumble::internal {
namespace {

// Which band a pixel lies in: 0 the darkest … bands - 1, and between two of them where their border is soft.
class BandOf {
 public:
  BandOf(const ToonPass& pass, const FinishFrame& frame)
      : light_(frame.guides->Plane(Layer::kLuminance)),
        object_(frame.guides->Plane(Layer::kObject)),
        width_(static_cast<std::size_t>(frame.guides->width())),
        bands_(static_cast<float>(pass.bands)),
        per_light_(static_cast<float>(pass.bands / frame.measures.bright)),
        softness_(static_cast<float>(pass.softness * frame.scale)) {}

  float At(std::size_t pixel) const {
    if (bands_ < 2.0f) return 0.0f;
    const float at = light_[pixel] * per_light_;
    const float border = std::clamp(std::floor(at + 0.5f), 1.0f, bands_ - 1.0f);
    // Half the border's width, in bands: the tone's slope makes it so many pixels wide.
    const float half = softness_ * Slope(pixel) * per_light_;
    const bool is_soft = std::fabs(at - border) < half && Crosses(pixel, border);
    const float share = is_soft ? 0.5f + 0.5f * (at - border) / half : at >= border ? 1.0f : 0.0f;
    return border - 1.0f + share * share * (3.0f - 2.0f * share);
  }

 private:
  // Whether the border lies between the pixel and one of its object within the softness, along a row or a column. Where
  // the light only bends nearby, nothing softens.
  bool Crosses(std::size_t pixel, float border) const {
    const auto x = static_cast<std::ptrdiff_t>(pixel % width_), y = static_cast<std::ptrdiff_t>(pixel / width_);
    const auto width = static_cast<std::ptrdiff_t>(width_), height = static_cast<std::ptrdiff_t>(light_.size()) / width;
    const bool is_above = light_[pixel] * per_light_ >= border;
    const auto reach = static_cast<std::ptrdiff_t>(std::ceil(softness_));
    for (std::ptrdiff_t k = 1; k <= reach; ++k) {
      for (const auto& [dx, dy] : {std::pair(-k, std::ptrdiff_t(0)), {k, 0}, {0, -k}, {0, k}}) {
        if (x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height) continue;
        const auto other = static_cast<std::size_t>((y + dy) * width + x + dx);
        if (object_[other] == object_[pixel] && (light_[other] * per_light_ >= border) != is_above) return true;
      }
    }
    return false;
  }

  // The larger difference to a neighbour of the same object, along each axis.
  float Slope(std::size_t pixel) const {
    const std::size_t x = pixel % width_, size = light_.size();
    const auto step = [&](bool is_inside, std::size_t other) {
      return is_inside && object_[other] == object_[pixel] ? std::fabs(light_[other] - light_[pixel]) : 0.0f;
    };
    const float along_x = std::max(step(x > 0, pixel - 1), step(x + 1 < width_, pixel + 1));
    const float along_y = std::max(step(pixel >= width_, pixel - width_), step(pixel + width_ < size, pixel + width_));
    return std::sqrt(along_x * along_x + along_y * along_y);
  }

  std::span<const float> light_, object_;
  std::size_t width_;
  float bands_, per_light_, softness_;
};

}  // namespace

PointEffect MakeToon(const ToonPass& pass, const FinishFrame& frame) {
  const BandOf band_of(pass, frame);
  const GuideSet& guides = *frame.guides;
  const bool from_albedo = pass.base == ToonPass::Color::kAlbedo;
  const LabColor color = ToOklab(pass.color);
  const float darkest = static_cast<float>(pass.shade), tint = static_cast<float>(pass.tint);
  const float per_band = pass.bands > 1 ? 1.0f / static_cast<float>(pass.bands - 1) : 0.0f;
  std::array<const float*, 3> albedo{};
  if (from_albedo) {
    for (int c = 0; c < 3; ++c) albedo[std::size_t(c)] = guides.Plane(Layer::kAlbedo, c).data();
  }
  const int bands = pass.bands;
  return [=](std::size_t first, std::size_t count, OklabBlock& block) {
    if (from_albedo) OklabFromPlanes({albedo[0] + first, albedo[1] + first, albedo[2] + first}, count, block);
    for (std::size_t i = 0; i < count; ++i) {
      const float light = bands > 1 ? band_of.At(first + i) * per_band : 1.0f;
      // Scaling all of Oklab scales linear colours by the cube: the hue and the saturation stay.
      const float factor = darkest + (1.0f - darkest) * light, share = tint * (1.0f - light);
      const float a = block.a[i] * factor, b = block.b[i] * factor;
      block.lightness[i] *= factor;
      block.a[i] = a + (color.a - a) * share, block.b[i] = b + (color.b - b) * share;
    }
  };
}

}  // namespace scumble::internal
