// The light that toon shades by, and the bands that it is cut into.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "finish/finish.h"

namespace scumble::internal {

// Direct light, 1 at the brightness that was measured.
class DirectLight {
 public:
  explicit DirectLight(const FinishFrame& frame)
      : light_(frame.guides->Plane(Layer::kLuminance)), bright_(frame.measures.bright) {}

  float At(std::size_t pixel) const { return light_[pixel]; }
  // The number of bands for 1 of At, of `bands` in all.
  float PerLight(int bands) const { return static_cast<float>(bands / bright_); }

 private:
  std::span<const float> light_;
  double bright_;
};

// Light that wraps around the form: ((1 + c) / 2)^power with c the cosine to the key light (Half-Lambert: Mitchell,
// Francke, Eng, "Illustrative rendering in Team Fortress 2", 2007). Where c is above 0, cast shadow takes of it first.
class WrappedLight {
 public:
  WrappedLight(const ToonPass& pass, const FinishFrame& frame)
      : cosine_(frame.guides->Plane(Layer::kCosine)),
        cast_(static_cast<float>(pass.cast)),
        squares_(pass.wrap_power == 2) {
    if (pass.cast > 0.0) shadow_ = frame.guides->Plane(Layer::kShadow);
  }

  // 0 … 1, of any floats.
  float At(std::size_t pixel) const {
    float cosine = cosine_[pixel] > -1.0f ? std::min(cosine_[pixel], 1.0f) : -1.0f;  // NaN is dark
    if (!shadow_.empty() && cosine > 0.0f)
      cosine *= 1.0f - cast_ * (shadow_[pixel] > 0.0f ? std::min(shadow_[pixel], 1.0f) : 0.0f);
    const float half = 0.5f + 0.5f * cosine;
    return squares_ ? half * half : half;
  }
  float PerLight(int bands) const { return static_cast<float>(bands); }

 private:
  std::span<const float> cosine_, shadow_;
  float cast_;
  bool squares_;
};

// Which band a pixel lies in: 0 the darkest … bands - 1, and between two of them where their border is soft.
template <class Light>
class BandOf {
 public:
  BandOf(const ToonPass& pass, const FinishFrame& frame, const Light& light)
      : light_(light),
        object_(frame.guides->Plane(Layer::kObject)),
        width_(static_cast<std::size_t>(frame.guides->width())),
        bands_(static_cast<float>(pass.bands)),
        per_light_(light.PerLight(pass.bands)),
        softness_(static_cast<float>(pass.softness * frame.scale)) {}

  float At(std::size_t pixel) const {
    if (bands_ < 2.0f) return 0.0f;
    const float at = Finite(light_.At(pixel) * per_light_);
    const float border = std::clamp(std::floor(at + 0.5f), 1.0f, bands_ - 1.0f);
    // Half the border's width, in bands: the tone's slope makes it so many pixels wide.
    const float half = softness_ * Slope(pixel) * per_light_;
    const bool is_soft = std::fabs(at - border) < half && Crosses(pixel, border);
    const float share = is_soft ? 0.5f + 0.5f * (at - border) / half : at >= border ? 1.0f : 0.0f;
    return border - 1.0f + share * share * (3.0f - 2.0f * share);
  }

  // The tone itself, as a share of all bands, 0 … 1.
  float Tone(std::size_t pixel) const { return std::clamp(Finite(light_.At(pixel) * per_light_) / bands_, 0.0f, 1.0f); }

 private:
  // What is no number is dark.
  static float Finite(float value) { return value == value ? value : 0.0f; }

  // Whether the border lies between the pixel and one of its object within the softness, along a row or a column. Where
  // the light only bends nearby, nothing softens.
  bool Crosses(std::size_t pixel, float border) const {
    const auto x = static_cast<std::ptrdiff_t>(pixel % width_), y = static_cast<std::ptrdiff_t>(pixel / width_);
    const auto width = static_cast<std::ptrdiff_t>(width_),
               height = static_cast<std::ptrdiff_t>(object_.size()) / width;
    const bool is_above = light_.At(pixel) * per_light_ >= border;
    const auto reach = static_cast<std::ptrdiff_t>(std::ceil(softness_));
    for (std::ptrdiff_t k = 1; k <= reach; ++k) {
      for (const auto& [dx, dy] : {std::pair(-k, std::ptrdiff_t(0)), {k, 0}, {0, -k}, {0, k}}) {
        if (x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height) continue;
        const auto other = static_cast<std::size_t>((y + dy) * width + x + dx);
        if (object_[other] == object_[pixel] && (light_.At(other) * per_light_ >= border) != is_above) return true;
      }
    }
    return false;
  }

  // The larger difference to a neighbour of the same object, along each axis.
  float Slope(std::size_t pixel) const {
    const std::size_t x = pixel % width_, size = object_.size();
    const float here = light_.At(pixel);
    const auto step = [&](bool is_inside, std::size_t other) {
      return is_inside && object_[other] == object_[pixel] ? std::fabs(light_.At(other) - here) : 0.0f;
    };
    const float along_x = std::max(step(x > 0, pixel - 1), step(x + 1 < width_, pixel + 1));
    const float along_y = std::max(step(pixel >= width_, pixel - width_), step(pixel + width_ < size, pixel + width_));
    return std::sqrt(along_x * along_x + along_y * along_y);
  }

  Light light_;
  std::span<const float> object_;
  std::size_t width_;
  float bands_, per_light_, softness_;
};

}  // namespace scumble::internal
