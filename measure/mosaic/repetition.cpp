#include "measure/mosaic/repetition.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/filter/gaussian_blur.h"
#include "core/image/check.h"
#include "core/image/color.h"
#include "core/image/oklab.h"

namespace scumble {
namespace {

constexpr float kSmoothCosine = 0.9659258f;  // 15 degrees

glm::vec3 LabAt(const Picture& picture, int x, int y) {
  const std::uint16_t* pixel = picture.At(x, y);
  return OklabFromLinear({Srgb16ToLinear(pixel[0]), Srgb16ToLinear(pixel[1]), Srgb16ToLinear(pixel[2])});
}

std::uint8_t ExemplarAt(const SourcePlanes& planes, std::size_t i) {
  return planes.exemplar.empty() ? std::uint8_t{0} : planes.exemplar[i];
}

bool SameChunk(const SourcePlanes& planes, std::size_t a, std::size_t b, int dx, int dy) {
  return planes.source_x[b] - planes.source_x[a] == dx && planes.source_y[b] - planes.source_y[a] == dy &&
         ExemplarAt(planes, a) == ExemplarAt(planes, b);
}

// The region's Oklab lightness, in row order.
std::vector<float> Lightness(const Picture& picture, const PictureRegion& region) {
  SCUMBLE_CHECK(region.x >= 0 && region.y >= 0 && region.x + region.width <= picture.width &&
                region.y + region.height <= picture.height);
  std::vector<float> tones;
  for (int y = 0; y < region.height; ++y) {
    for (int x = 0; x < region.width; ++x) tones.push_back(LabAt(picture, region.x + x, region.y + y).x);
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

double SourceRepetition(const SourcePlanes& planes) {
  std::vector<std::uint64_t> sources;
  for (std::size_t i = 0; i < planes.covered.size(); ++i) {
    if (!planes.covered[i]) continue;
    sources.push_back(std::uint64_t(ExemplarAt(planes, i)) << 32 |
                      std::uint64_t(std::uint16_t(planes.source_y[i])) << 16 | std::uint16_t(planes.source_x[i]));
  }
  const double covered = static_cast<double>(sources.size());
  std::sort(sources.begin(), sources.end());
  sources.erase(std::unique(sources.begin(), sources.end()), sources.end());
  return sources.empty() ? 0.0 : covered / static_cast<double>(sources.size());
}

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

SeamStrength MeasureSeams(const Picture& picture, const SourcePlanes& planes, const GuideSet& guides) {
  SCUMBLE_CHECK(picture.width == planes.width && picture.height == planes.height);
  SCUMBLE_CHECK(guides.width() == planes.width && guides.height() == planes.height);
  const std::span<const float> object =
      guides.Has(Layer::kObject) ? guides.Plane(Layer::kObject) : std::span<const float>();
  double across = 0.0, within = 0.0;
  SeamStrength seams;
  const auto add = [&](int x, int y, int dx, int dy) {
    if (x + dx >= planes.width || y + dy >= planes.height) return;
    const std::size_t a = std::size_t(y) * planes.width + x, b = a + std::size_t(dy) * planes.width + std::size_t(dx);
    if (!planes.covered[a] || !planes.covered[b]) return;
    if (!object.empty() && object[a] != object[b]) return;
    if (!(glm::dot(guides.Vec3(Layer::kNormal, a), guides.Vec3(Layer::kNormal, b)) > kSmoothCosine)) return;
    const glm::vec3 d = LabAt(picture, x, y) - LabAt(picture, x + dx, y + dy);
    const double length = std::sqrt(double(d.x) * d.x + double(d.y) * d.y + double(d.z) * d.z);
    if (SameChunk(planes, a, b, dx, dy))
      within += length, ++seams.inside_pairs;
    else
      across += length, ++seams.border_pairs;
  };
  for (int y = 0; y < planes.height; ++y) {
    for (int x = 0; x < planes.width; ++x) add(x, y, 1, 0), add(x, y, 0, 1);
  }
  if (seams.border_pairs > 0) seams.along_borders = across / static_cast<double>(seams.border_pairs);
  if (seams.inside_pairs > 0) seams.inside = within / static_cast<double>(seams.inside_pairs);
  if (seams.border_pairs > 0 && seams.inside > 0.0) seams.excess = seams.along_borders / seams.inside - 1.0;
  return seams;
}

}  // namespace scumble
