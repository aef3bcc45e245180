#include "transfer/illumination.h"

#include <algorithm>
#include <cmath>

#include "image/color.h"
#include "image/exact_math.h"

namespace scumble {

Illumination::Illumination(std::span<const double> luminances, float weight, LuminanceError form)
    : luminances_(luminances.begin(), luminances.end()), weight_(weight), form_(form) {}

int Illumination::Choose(float luminance) const {
  if (!(luminance >= 0.0f)) luminance = 0.0f;
  int best = 0;
  for (int k = 1; k < static_cast<int>(luminances_.size()); ++k) {
    if (std::fabs(luminance - luminances_[k]) < std::fabs(luminance - luminances_[best])) best = k;
  }
  return best;
}

float Illumination::Error(float luminance, int chosen) const {
  if (!active() || !(weight_ > 0.0f)) return 0.0f;
  if (!(luminance >= 0.0f)) luminance = 0.0f;
  const float off = std::fabs(luminance - luminances_[chosen]);
  if (form_ == LuminanceError::kPublished) return weight_ * off;
  const float excess = off - std::fabs(luminance - luminances_[Choose(luminance)]);
  // A weight of infinity cuts exactly where the best exemplar changes; infinity times 0 would be NaN.
  return excess > 0.0f ? weight_ * excess : 0.0f;
}

double MeasuredLuminance(const Picture& picture, double rim) {
  const double radius = 0.5 * picture.width - rim;
  std::vector<std::uint8_t> disc(std::size_t(picture.width) * picture.height);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double dx = x + 0.5 - 0.5 * picture.width, dy = y + 0.5 - 0.5 * picture.height;
      disc[std::size_t(y) * picture.width + x] = dx * dx + dy * dy <= radius * radius;
    }
  }
  return MeasuredLuminance(picture, disc);
}

double MeasuredLuminance(const Picture& picture, std::span<const std::uint8_t> mask) {
  double sum = 0.0, weight = 0.0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (!mask[i]) continue;
    const std::uint16_t* texel = picture.rgba.data() + 4 * i;
    sum += static_cast<double>(texel[3]) *
           Luminance(Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2]));
    weight += texel[3];
  }
  return weight > 0.0 ? sum / weight : 0.0;
}

double BrightPercentile(const GuideSet& guides, Layer layer) {
  const auto coverage = guides.Plane(Layer::kCoverage);
  const bool is_color = ChannelCount(layer) == 3;
  std::vector<float> lit;
  for (std::size_t i = 0; i < coverage.size(); ++i) {
    if (!(coverage[i] > 0.0f)) continue;
    float light = guides.Plane(layer)[i];
    if (is_color) {
      const glm::vec3 rgb = guides.Vec3(layer, i);
      light = static_cast<float>(Luminance(rgb.r, rgb.g, rgb.b));
    }
    lit.push_back(light > 0.0f ? light : 0.0f);
  }
  if (lit.empty()) return 0.0;
  // Nearest rank: the smallest value that 90% of the pixels do not exceed.
  const std::size_t rank = (lit.size() * 9 + 9) / 10 - 1;
  const auto place = lit.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(lit.begin(), place, lit.end());
  return *place;
}

double MeasureExposure(const GuideSet& guides, std::span<const float> luminances, Layer layer) {
  const float brightest = luminances.empty() ? 0.0f : *std::max_element(luminances.begin(), luminances.end());
  if (!(brightest > 0.0f)) return 0.0;
  const double bright = BrightPercentile(guides, layer);
  if (!(bright > 0.0 && std::isfinite(bright))) return 0.0;
  return std::round(100.0 * Log2(static_cast<double>(brightest) / bright)) / 100.0;
}

}  // namespace scumble
