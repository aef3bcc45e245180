// The light that toon shades by, and the bands that it is cut into.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "core/filter/oklab_rows.h"
#include "finish/finish.h"

namespace scumble::internal {

// Direct light, 1 at the brightness that was measured.
class DirectLight {
 public:
  explicit DirectLight(const FinishFrame& frame)
      : light_(frame.guides->Plane(Layer::kLuminance)), bright_(frame.measures.bright) {}

  float At(std::size_t pixel) const { return light_[pixel]; }
  // The values of At from a pixel on, in `buffer` or elsewhere.
  const float* Of(std::size_t first, std::size_t, float*) const { return light_.data() + first; }
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
  float At(std::size_t pixel) const { return Wrapped(cosine_[pixel], shadow_.empty() ? 0.0f : shadow_[pixel]); }
  const float* Of(std::size_t first, std::size_t count, float* buffer) const {
    for (std::size_t i = 0; i < count; ++i) buffer[i] = cosine_[first + i];
    if (shadow_.empty()) {
      for (std::size_t i = 0; i < count; ++i) buffer[i] = Wrapped(buffer[i], 0.0f);
    } else {
      for (std::size_t i = 0; i < count; ++i) buffer[i] = Wrapped(buffer[i], shadow_[first + i]);
    }
    return buffer;
  }
  float PerLight(int bands) const { return static_cast<float>(bands); }

 private:
  // NaN is dark, and no shadow.
  float Wrapped(float cosine, float shadow) const {
    const float turned = cosine > -1.0f ? std::min(cosine, 1.0f) : -1.0f;
    const float blocked = shadow > 0.0f ? std::min(shadow, 1.0f) : 0.0f;
    const float lit = turned > 0.0f ? turned * (1.0f - cast_ * blocked) : turned;
    const float half = 0.5f + 0.5f * lit;
    return squares_ ? half * half : half;
  }

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

  // Of pixels of one row, kOklabBlock at most.
  void At(std::size_t first, std::size_t count, float* bands) const {
    Near near;
    Look(first, count, near);
    for (std::size_t i = 0; i < count; ++i) {
      const float at = near.at[i], border = near.border[i], off = at - border;
      float share = at >= border ? 1.0f : 0.0f;
      // Far from the border no root is taken.
      const float square = softness_ * per_light_ * (softness_ * per_light_) * near.slope[i];
      if (!(off * off > 1.01f * square)) {
        // Half the border's width, in bands: the tone's slope makes it so many pixels wide.
        const float half = softness_ * std::sqrt(near.slope[i]) * per_light_;
        if (std::fabs(off) < half && Crosses(first + i, border)) share = 0.5f + 0.5f * off / half;
      }
      bands[i] = border - 1.0f + share * share * (3.0f - 2.0f * share);
    }
  }

  // The tones themselves, as shares of all bands, 0 … 1.
  void Tones(std::size_t first, std::size_t count, float* tones) const {
    const float* const light = light_.Of(first, count, tones);
    for (std::size_t i = 0; i < count; ++i) tones[i] = std::clamp(Number(light[i] * per_light_) / bands_, 0.0f, 1.0f);
  }

 private:
  // Of each pixel of a block its place among the bands, the nearest border, and the squared slope of its light: of the
  // larger differences to neighbours of the same object, along each axis.
  struct Near {
    float at[kOklabBlock], border[kOklabBlock], slope[kOklabBlock];
  };

  void Look(std::size_t first, std::size_t count, Near& near) const {
    const std::size_t x = first % width_, has_left = x > 0, has_right = x + count < width_;
    float buffers[3][kOklabBlock + 2], objects[kOklabBlock + 2];
    const float* const light = light_.Of(first - has_left, count + has_left + has_right, buffers[0]) + has_left;
    const bool has_above = first >= width_, has_below = first + width_ < object_.size();
    const float* const above = has_above ? light_.Of(first - width_, count, buffers[1]) : light;
    const float* const below = has_below ? light_.Of(first + width_, count, buffers[2]) : light;
    const float* const object = object_.data() + first;
    const float* const object_above = has_above ? object - width_ : object;
    const float* const object_below = has_below ? object + width_ : object;
    const auto step = [](float here, float there, float object_here, float object_there) {
      return object_here == object_there ? std::fabs(there - here) : 0.0f;
    };
    // Beside the picture's edges there is no difference.
    float across[kOklabBlock + 2];
    for (std::size_t i = 0; i < count; ++i) across[i + 1] = light[i], objects[i + 1] = object[i];
    across[0] = has_left ? light[-1] : light[0], objects[0] = has_left ? object[-1] : object[0];
    across[count + 1] = has_right ? light[count] : light[count - 1];
    objects[count + 1] = has_right ? object[count] : object[count - 1];
    for (std::size_t i = 0; i < count; ++i) {
      const float at = Number(light[i] * per_light_);
      near.at[i] = at;
      near.border[i] = static_cast<float>(static_cast<int>(std::clamp(at + 0.5f, 1.0f, bands_ - 1.0f)));
      const float along_x = std::max(step(light[i], across[i], object[i], objects[i]),
                                     step(light[i], across[i + 2], object[i], objects[i + 2]));
      const float along_y = std::max(step(light[i], above[i], object[i], object_above[i]),
                                     step(light[i], below[i], object[i], object_below[i]));
      near.slope[i] = along_x * along_x + along_y * along_y;
    }
  }

  // What is no number is dark.
  static float Number(float value) { return value == value ? value : 0.0f; }

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

  Light light_;
  std::span<const float> object_;
  std::size_t width_;
  float bands_, per_light_, softness_;
};

}  // namespace scumble::internal
