#include "core/style/scan/resample_scan.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/image/color.h"

namespace scumble {
namespace {

constexpr int kLobes = 2;

double Lanczos(double x) {
  const double a = std::abs(x) * std::acos(-1.0);
  if (a < 1e-9) return 1;
  if (std::abs(x) >= kLobes) return 0;
  return std::sin(a) / a * std::sin(a / kLobes) / (a / kLobes);
}

// Weights of a pixel's own fine points and of `lead` points on each side; together 1.
std::vector<float> Window(int fine, int lead) {
  std::vector<double> weights(std::size_t(fine + 2 * lead));
  double sum = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) sum += weights[i] = Lanczos((double(i) + 0.5 - lead) / fine - 0.5);
  std::vector<float> window;
  for (const double w : weights) window.push_back(float(w / sum));
  return window;
}

std::array<float, 4> Cubic(float t) {
  return {t * (-0.5f + t * (1.0f - 0.5f * t)), 1.0f + t * t * (-2.5f + 1.5f * t), t * (0.5f + t * (2.0f - 1.5f * t)),
          t * t * (-0.5f + 0.5f * t)};
}

void ReadCubic(const Picture& scan, glm::dvec2 at, float* rgb) {
  const double u = std::clamp(at.x, -1.0, scan.width + 1.0) - 0.5, v = std::clamp(at.y, -1.0, scan.height + 1.0) - 0.5;
  const int x = int(std::floor(u)), y = int(std::floor(v));
  const auto wx = Cubic(float(u - x)), wy = Cubic(float(v - y));
  rgb[0] = rgb[1] = rgb[2] = 0;
  for (int j = 0; j < 4; ++j) {
    const int row = std::clamp(y + j - 1, 0, scan.height - 1);
    float sum[3] = {0, 0, 0};
    for (int i = 0; i < 4; ++i) {
      const std::uint16_t* pixel = scan.At(std::clamp(x + i - 1, 0, scan.width - 1), row);
      for (int c = 0; c < 3; ++c) sum[c] += wx[i] * Srgb16ToLinear(pixel[c]);
    }
    for (int c = 0; c < 3; ++c) rgb[c] += wy[j] * sum[c];
  }
}

}  // namespace

LinearPicture ResampleScan(const Picture& scan, int width, int height, double shrink,
                           const std::function<glm::dvec2(glm::dvec2)>& place) {
  // As fine as the scan, but at most 16 points a pixel: more make no visible difference.
  const int fine = std::clamp(int(std::ceil(shrink - 1e-6)), 1, 16);
  const int lead = fine == 1 ? 0 : (2 * kLobes - 1) * fine / 2;
  const std::vector<float> window = Window(fine, lead);
  LinearPicture result{width, height, std::vector<float>(std::size_t(3) * width * height, 0.0f)};
  const int fine_width = width * fine + 2 * lead;
  std::vector<float> line(std::size_t(3) * fine_width), row(std::size_t(3) * width);
  for (int fine_y = -lead; fine_y < height * fine + lead; ++fine_y) {
    for (int i = 0; i < fine_width; ++i) {
      ReadCubic(scan, place({(i - lead + 0.5) / fine, (fine_y + 0.5) / fine}), &line[std::size_t(3) * i]);
    }
    std::fill(row.begin(), row.end(), 0.0f);
    for (int x = 0; x < width; ++x) {
      for (std::size_t k = 0; k < window.size(); ++k) {
        for (int c = 0; c < 3; ++c)
          row[std::size_t(3 * x + c)] += window[k] * line[3 * (std::size_t(x) * fine + k) + std::size_t(c)];
      }
    }
    // The pixels whose windows this line is in.
    for (int y = std::max(0, (fine_y - lead) / fine - kLobes); y < height && y * fine - lead <= fine_y; ++y) {
      const int k = fine_y - (y * fine - lead);
      if (k >= int(window.size())) continue;
      float* out = &result.rgb[std::size_t(3) * width * y];
      for (std::size_t i = 0; i < row.size(); ++i) out[i] += window[std::size_t(k)] * row[i];
    }
  }
  return result;
}

}  // namespace scumble
