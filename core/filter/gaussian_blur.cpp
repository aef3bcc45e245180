#include "core/filter/gaussian_blur.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace scumble {
namespace {

// One direction of a Gaussian blur. Values outside the plane have no weight.
std::vector<float> BlurredAlong(const std::vector<float>& tones, int count, int stride, int lines, int line_stride,
                                const std::vector<double>& weights) {
  const int reach = static_cast<int>(weights.size()) - 1;
  std::vector<float> out(tones.size());
  for (int line = 0; line < lines; ++line) {
    for (int i = 0; i < count; ++i) {
      double sum = 0.0, weight = 0.0;
      for (int k = std::max(0, i - reach); k <= std::min(count - 1, i + reach); ++k) {
        const double w = weights[std::size_t(std::abs(k - i))];
        sum += w * tones[std::size_t(line) * line_stride + std::size_t(k) * stride], weight += w;
      }
      out[std::size_t(line) * line_stride + std::size_t(i) * stride] = static_cast<float>(sum / weight);
    }
  }
  return out;
}

}  // namespace

std::vector<float> GaussianBlur(const std::vector<float>& plane, int width, int height, double sigma) {
  if (!(sigma > 0.0)) return plane;
  std::vector<double> weights;
  for (int k = 0; k <= std::ceil(4.0 * sigma); ++k) weights.push_back(std::exp(-0.5 * k * k / (sigma * sigma)));
  return BlurredAlong(BlurredAlong(plane, width, 1, height, width, weights), height, width, width, 1, weights);
}

}  // namespace scumble
