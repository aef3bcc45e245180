#include "measure/heat_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/image/color.h"
#include "core/image/oklab.h"
#include "measure/compare.h"

namespace scumble {
namespace {

using HeatColor = std::array<std::uint16_t, 3>;

// From dark blue to yellow, both inside the gamut of Rec.709.
HeatColor RampColor(double share) {
  constexpr glm::vec3 kBlue(0.26f, -0.01f, -0.12f), kYellow(0.92f, -0.04f, 0.17f);
  const glm::vec3 linear = LinearFromOklab(kBlue + static_cast<float>(share) * (kYellow - kBlue));
  HeatColor color;
  for (int i = 0; i < 3; ++i) color[static_cast<std::size_t>(i)] = Srgb16FromLinear(linear[i]);
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
  std::array<HeatColor, kSteps + 1> ramp;
  for (int i = 0; i <= kSteps; ++i) ramp[static_cast<std::size_t>(i)] = RampColor(double(i) / kSteps);
  map.picture = Picture(a.width, a.height);
  for (std::size_t i = 0; i < largest.size(); ++i) {
    HeatColor color = {65535, 0, 65535};
    if (!std::isfinite(largest[i])) {
      ++map.incomparable;
    } else {
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
    const HeatColor color = RampColor(std::clamp(values[i] / full_scale, 0.0, 1.0));
    std::copy(color.begin(), color.end(), picture.rgba.begin() + std::ptrdiff_t(4 * i));
    picture.rgba[4 * i + 3] = 65535;
  }
  return picture;
}

}  // namespace scumble
