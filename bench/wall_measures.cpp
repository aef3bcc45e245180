#include "bench/wall_measures.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "core/filter/gaussian_blur.h"
#include "core/image/check.h"
#include "core/image/color.h"
#include "core/image/oklab.h"

namespace scumble {
namespace {

float OklabLightness(const std::uint16_t* pixel) {
  return OklabFromLinear({Srgb16ToLinear(pixel[0]), Srgb16ToLinear(pixel[1]), Srgb16ToLinear(pixel[2])}).x;
}

// The region's Oklab lightness, in row order.
std::vector<float> Lightness(const Picture& picture, const PictureRegion& region) {
  SCUMBLE_CHECK(region.x >= 0 && region.y >= 0 && region.x + region.width <= picture.width &&
                region.y + region.height <= picture.height);
  std::vector<float> tones;
  for (int y = 0; y < region.height; ++y) {
    for (int x = 0; x < region.width; ++x) tones.push_back(OklabLightness(picture.At(region.x + x, region.y + y)));
  }
  return tones;
}

// Pearson's correlation of the values with themselves, (dx, dy) away, where both are inside.
double Correlation(const std::vector<float>& tones, int width, int height, int dx, int dy) {
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  for (int y = std::max(0, -dy); y < std::min(height, height - dy); ++y) {
    for (int x = std::max(0, -dx); x < std::min(width, width - dx); ++x) {
      const double p = tones[std::size_t(y) * width + x], q = tones[std::size_t(y + dy) * width + x + dx];
      n += 1, a += p, b += q, aa += p * p, bb += q * q, ab += p * q;
    }
  }
  const double variances = (n * aa - a * a) * (n * bb - b * b);
  return variances > 1e-12 * n * n ? (n * ab - a * b) / std::sqrt(variances) : 0.0;
}

}  // namespace

AutocorrelationPeak HighestAutocorrelation(const Picture& picture, const PictureRegion& region,
                                           const AutocorrelationOptions& options) {
  const int step = options.step;
  SCUMBLE_CHECK(step >= 1);
  std::vector<float> tones = Lightness(picture, region);
  if (options.subtract_sigma > 0.0) {
    const std::vector<float> blurred = GaussianBlur(tones, region.width, region.height, options.subtract_sigma);
    for (std::size_t i = 0; i < tones.size(); ++i) tones[i] -= blurred[i];
  }
  AutocorrelationPeak peak{-1.0, 0, 0};
  bool any = false;
  // The other half plane holds the same shifts reversed.
  for (int dy = 0; dy <= region.height / 2; dy += step) {
    for (int dx = -(region.width / 2 / step) * step; dx <= region.width / 2; dx += step) {
      if (std::max(std::abs(dx), dy) <= options.least_shift || (dy == 0 && dx < 0)) continue;
      const double value = Correlation(tones, region.width, region.height, dx, dy);
      if (!any || value > peak.value) peak = {value, dx, dy}, any = true;
    }
  }
  return any ? peak : AutocorrelationPeak{};
}

double ToneSpread(const Picture& picture, const PictureRegion& region, double sigma) {
  const std::vector<float> tones = GaussianBlur(Lightness(picture, region), region.width, region.height, sigma);
  if (tones.empty()) return 0.0;
  double mean = 0.0, variance = 0.0;
  for (const float tone : tones) mean += tone;
  mean /= static_cast<double>(tones.size());
  for (const float tone : tones) variance += (tone - mean) * (tone - mean);
  return std::sqrt(variance / static_cast<double>(tones.size()));
}

}  // namespace scumble
