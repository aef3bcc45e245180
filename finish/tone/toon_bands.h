// The bands that toon cuts light into.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "core/filter/light_contour.h"
#include "core/filter/oklab_rows.h"
#include "core/filter/wide_loops.h"
#include "finish/finish.h"

namespace scumble::internal {

// The light at which the brightest band ends: the brightness that was measured, or 1 of wrapped light.
inline double BrightestOf(const ToonPass& pass, const FinishFrame& frame) {
  return pass.light == ToonPass::Light::kWrapped ? 1.0 : frame.measures.bright;
}

// What is no number is dark.
inline float NumberOf(float value) { return value == value ? value : 0.0f; }

// A block of pixels of one row with what is around it: beside the picture's edges, the pixels themselves.
struct ToonBlock {
  const float *light, *above, *below;  // `count` values
  const float *object, *object_above, *object_below;
  const float *across,
      *objects;  // light and object from the pixel on the left to the one on the right, count + 2 values
};

// Of each pixel its place among the bands, the nearest border, and the squared slope of its light: of the larger
// differences to neighbours of the same object, along each axis. A difference above `hard` is no slope.
SCUMBLE_WIDE_LOOPS inline void FindBands(const ToonBlock& block, float per_light, float bands, float hard,
                                         std::size_t count, float* places, float* borders, float* slopes) {
  const float *const light = block.light, *const above = block.above, *const below = block.below,
                     *const across = block.across;
  const float *const object = block.object, *const object_above = block.object_above,
                     *const object_below = block.object_below, *const objects = block.objects;
  const auto step = [hard](float here, float there, float object_here, float object_there) {
    const float difference = std::fabs(there - here);
    return (object_here == object_there) & (difference <= hard) ? difference : 0.0f;
  };
  const auto larger = [](float a, float b) { return a < b ? b : a; };
  for (std::size_t i = 0; i < count; ++i) {
    const float at = NumberOf(light[i] * per_light), up = at + 0.5f;
    places[i] = at;
    borders[i] = static_cast<float>(static_cast<int>(up < 1.0f ? 1.0f : bands - 1.0f < up ? bands - 1.0f : up));
    const float along_x = larger(step(light[i], across[i], object[i], objects[i]),
                                 step(light[i], across[i + 2], object[i], objects[i + 2]));
    const float along_y = larger(step(light[i], above[i], object[i], object_above[i]),
                                 step(light[i], below[i], object[i], object_below[i]));
    slopes[i] = along_x * along_x + along_y * along_y;
  }
}

// Bands with hard borders, and where a border may be soft: where the light comes so near to it, with its slope, that
// `soft` times the slope reaches it.
SCUMBLE_WIDE_LOOPS inline void TakeHardBands(const float* places, const float* borders, const float* slopes, float soft,
                                             std::size_t count, float* bands, std::uint32_t* may_be_soft) {
  for (std::size_t i = 0; i < count; ++i) {
    const float off = places[i] - borders[i], square = soft * soft * slopes[i];
    bands[i] = borders[i] - (places[i] >= borders[i] ? 0.0f : 1.0f);
    may_be_soft[i] = off * off > 1.01f * square ? 0u : 1u;
  }
}

// Which band a pixel lies in: 0 the darkest … bands - 1, and between two of them where their border is soft.
class BandOf {
 public:
  // `light`: what ToonLight gives; keeps references to it and to the guides.
  BandOf(const ToonPass& pass, const FinishFrame& frame, std::span<const float> light)
      : light_(light),
        object_(frame.guides->Plane(Layer::kObject)),
        width_(static_cast<std::size_t>(frame.guides->width())),
        bands_(static_cast<float>(pass.bands)),
        per_light_(static_cast<float>(pass.bands / BrightestOf(pass, frame))),
        hard_(kHardStep * static_cast<float>(BrightestOf(pass, frame))),
        softness_(static_cast<float>(pass.softness * frame.scale)) {}

  // Of pixels of one row, kOklabBlock at most.
  void At(std::size_t first, std::size_t count, float* bands) const {
    float places[kOklabBlock], borders[kOklabBlock], slopes[kOklabBlock];
    std::uint32_t may_be_soft[kOklabBlock];
    Look(first, count, places, borders, slopes);
    TakeHardBands(places, borders, slopes, softness_ * per_light_, count, bands, may_be_soft);
    for (std::size_t i = 0; i < count; ++i) {
      if (!may_be_soft[i]) continue;
      // Half the border's width, in bands: the tone's slope makes it so many pixels wide.
      const float border = borders[i], off = places[i] - border, half = softness_ * std::sqrt(slopes[i]) * per_light_;
      if (!(std::fabs(off) < half && Crosses(first + i, border))) continue;
      const float share = 0.5f + 0.5f * off / half;
      bands[i] = border - 1.0f + share * share * (3.0f - 2.0f * share);
    }
  }

  // The tones themselves, as shares of all bands, 0 … 1.
  void Tones(std::size_t first, std::size_t count, float* tones) const {
    for (std::size_t i = 0; i < count; ++i)
      tones[i] = std::clamp(NumberOf(light_[first + i] * per_light_) / bands_, 0.0f, 1.0f);
  }

 private:
  void Look(std::size_t first, std::size_t count, float* places, float* borders, float* slopes) const {
    const std::size_t x = first % width_, has_left = x > 0, has_right = x + count < width_;
    float objects[kOklabBlock + 2];
    const float* const light = light_.data() + first;
    const bool has_above = first >= width_, has_below = first + width_ < object_.size();
    const float* const above = has_above ? light - width_ : light;
    const float* const below = has_below ? light + width_ : light;
    const float* const object = object_.data() + first;
    const float* const object_above = has_above ? object - width_ : object;
    const float* const object_below = has_below ? object + width_ : object;
    // Beside the picture's edges there is no difference.
    float across[kOklabBlock + 2];
    for (std::size_t i = 0; i < count; ++i) across[i + 1] = light[i], objects[i + 1] = object[i];
    across[0] = has_left ? light[-1] : light[0], objects[0] = has_left ? object[-1] : object[0];
    across[count + 1] = has_right ? light[count] : light[count - 1];
    objects[count + 1] = has_right ? object[count] : object[count - 1];
    FindBands({light, above, below, object, object_above, object_below, across, objects}, per_light_, bands_, hard_,
              count, places, borders, slopes);
  }

  // Whether the border lies between the pixel and one of its object within the softness, along a row or a column. Where
  // the light only bends nearby, nothing softens.
  bool Crosses(std::size_t pixel, float border) const {
    const auto x = static_cast<std::ptrdiff_t>(pixel % width_), y = static_cast<std::ptrdiff_t>(pixel / width_);
    const auto width = static_cast<std::ptrdiff_t>(width_),
               height = static_cast<std::ptrdiff_t>(object_.size()) / width;
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

  std::span<const float> light_, object_;
  std::size_t width_;
  float bands_, per_light_, hard_, softness_;
};

}  // namespace scumble::internal
