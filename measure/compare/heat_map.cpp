#include "measure/compare/heat_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/image/color.h"
#include "measure/compare/compare.h"

namespace scumble {
namespace {

// Oklab to linear Rec.709; https://bottosson.github.io/posts/oklab/
std::array<double, 3> LinearFromOklab(const std::array<double, 3>& lab) {
  const double l = lab[0] + 0.3963377774 * lab[1] + 0.2158037573 * lab[2];
  const double m = lab[0] - 0.1055613458 * lab[1] - 0.0638541728 * lab[2];
  const double s = lab[0] - 0.0894841775 * lab[1] - 1.2914855480 * lab[2];
  const double l3 = l * l * l;
  const double m3 = m * m * m;
  const double s3 = s * s * s;
  return {4.0767416621 * l3 - 3.3077115913 * m3 + 0.2309699292 * s3,
          -1.2684380046 * l3 + 2.6097574011 * m3 - 0.3413193965 * s3,
          -0.0041960863 * l3 - 0.7034186147 * m3 + 1.7076147010 * s3};
}

using Color = std::array<std::uint16_t, 3>;

// From dark blue to yellow, both inside the gamut of Rec.709.
Color RampColor(double share) {
  constexpr std::array<double, 3> kBlue = {0.26, -0.01, -0.12};
  constexpr std::array<double, 3> kYellow = {0.92, -0.04, 0.17};
  std::array<double, 3> lab;
  for (std::size_t i = 0; i < 3; ++i) lab[i] = kBlue[i] + share * (kYellow[i] - kBlue[i]);
  const std::array<double, 3> linear = LinearFromOklab(lab);
  Color color;
  for (std::size_t i = 0; i < 3; ++i) color[i] = Srgb16FromLinear(static_cast<float>(linear[i]));
  return color;
}

// Per pixel the largest difference of the report's channels; infinite where they cannot be compared.
std::vector<double> LargestDifferences(const ChannelImage& a, const ChannelImage& b, const CompareReport& report) {
  std::vector<double> largest(a.pixel_count(), 0.0);
  for (const LayerReport& layer : report.layers) {
    for (const ChannelReport& channel : layer.channels) {
      const std::vector<float>& plane_a = *a.Find(channel.name);
      const std::vector<float>& plane_b = *b.Find(channel.name);
      for (std::size_t i = 0; i < largest.size(); ++i) {
        if (plane_a[i] == plane_b[i]) continue;
        const double difference = std::abs(static_cast<double>(plane_a[i]) - static_cast<double>(plane_b[i]));
        largest[i] = std::isfinite(difference) ? std::max(largest[i], difference) : HUGE_VAL;
      }
    }
  }
  return largest;
}

}  // namespace

Expected<HeatMap> DifferenceHeatMap(const ChannelImage& a, const ChannelImage& b, const HeatMapOptions& options) {
  if (!(options.full_scale >= 0.0) || std::isinf(options.full_scale)) {
    return UsageError("the heat map's full scale is " + std::to_string(options.full_scale) +
                      ": expected a positive difference, or 0 for the largest there is");
  }
  CompareOptions compare_options;
  compare_options.layers = options.layers;
  SCUMBLE_ASSIGN(const CompareReport report, Compare(a, b, compare_options));
  const std::vector<double> largest = LargestDifferences(a, b, report);
  HeatMap map;
  map.full_scale = options.full_scale;
  if (map.full_scale == 0.0) {
    for (const double difference : largest) {
      if (std::isfinite(difference)) map.full_scale = std::max(map.full_scale, difference);
    }
  }
  constexpr int kSteps = 1023;
  std::array<Color, kSteps + 1> ramp;
  for (int i = 0; i <= kSteps; ++i) ramp[static_cast<std::size_t>(i)] = RampColor(double(i) / kSteps);
  map.picture = Picture(a.width, a.height);
  for (std::size_t i = 0; i < largest.size(); ++i) {
    Color color = {65535, 0, 65535};
    if (std::isfinite(largest[i])) {
      const double share = largest[i] == 0.0 ? 0.0 : std::min(largest[i] / map.full_scale, 1.0);
      color = ramp[static_cast<std::size_t>(std::lround(share * kSteps))];
    }
    std::uint16_t* pixel = map.picture.rgba.data() + 4 * i;
    std::copy(color.begin(), color.end(), pixel);
    pixel[3] = 65535;
  }
  return map;
}

Picture ValueHeatMap(std::span<const float> values, int width, int height, double full_scale) {
  Picture picture(width, height);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    const Color color = RampColor(std::clamp(values[i] / full_scale, 0.0, 1.0));
    std::copy(color.begin(), color.end(), picture.rgba.begin() + std::ptrdiff_t(4 * i));
    picture.rgba[4 * i + 3] = 65535;
  }
  return picture;
}

}  // namespace scumble
