#include "core/filter/resample.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/image/exact_math.h"

namespace scumble {
namespace {

constexpr int kWeightBits = 14;
constexpr double kLobes = 3.0;

double Lanczos(double x) {
  x = std::fabs(x);
  if (x < 1e-9) return 1.0;
  if (x >= kLobes) return 0.0;
  const double angle = std::numbers::pi * x;
  return kLobes * SinPi(x) * SinPi(x / kLobes) / (angle * angle);
}

// The source samples of one output sample and their integer weights, which sum to 2^kWeightBits exactly.
struct Taps {
  int first = 0;
  std::vector<std::int32_t> weights;
};

std::vector<Taps> MakeTaps(int from, int to) {
  const double ratio = static_cast<double>(from) / to;
  const double widening = std::max(1.0, ratio);
  std::vector<Taps> all(to);
  for (int i = 0; i < to; ++i) {
    const double centre = (i + 0.5) * ratio;
    const int first = static_cast<int>(std::floor(centre - kLobes * widening));
    const int last = static_cast<int>(std::ceil(centre + kLobes * widening));
    std::vector<double> weights;
    double sum = 0.0;
    for (int s = first; s <= last; ++s) sum += weights.emplace_back(Lanczos((s + 0.5 - centre) / widening));
    Taps& taps = all[i];
    taps.first = first;
    std::int32_t total = 0;
    for (double weight : weights) {
      total += taps.weights.emplace_back(static_cast<std::int32_t>(std::lround(weight / sum * (1 << kWeightBits))));
    }
    *std::max_element(taps.weights.begin(), taps.weights.end()) += (1 << kWeightBits) - total;
  }
  return all;
}

// Sums of colour · alpha, so that transparent texels add no colour. Not divided yet, so that no precision is lost.
struct Sums {
  std::int64_t color[3] = {0, 0, 0};
  std::int64_t alpha = 0;
};

std::uint16_t Clamp16(std::int64_t value) {
  return static_cast<std::uint16_t>(std::clamp<std::int64_t>(value, 0, 65535));
}

void Store(const Sums& sums, std::uint16_t* out) {
  constexpr std::int64_t kHalf = 1 << (kWeightBits - 1);
  out[3] = Clamp16((sums.alpha + kHalf) >> kWeightBits);
  for (int c = 0; c < 3; ++c) {
    out[c] = sums.alpha > 0 ? Clamp16((sums.color[c] + sums.alpha / 2) / sums.alpha) : 0;
  }
}

// Along x only.
Picture ResampleRows(const Picture& source, int width) {
  const std::vector<Taps> taps = MakeTaps(source.width, width);
  Picture result(width, source.height);
  for (int y = 0; y < source.height; ++y) {
    for (int x = 0; x < width; ++x) {
      Sums sums;
      for (std::size_t t = 0; t < taps[x].weights.size(); ++t) {
        const int from = std::clamp(taps[x].first + static_cast<int>(t), 0, source.width - 1);
        const std::uint16_t* texel = source.At(from, y);
        const std::int64_t weight = std::int64_t(taps[x].weights[t]) * texel[3];
        sums.alpha += weight;
        for (int c = 0; c < 3; ++c) sums.color[c] += weight * texel[c];
      }
      Store(sums, result.At(x, y));
    }
  }
  return result;
}

Picture Transpose(const Picture& source) {
  Picture result(source.height, source.width);
  for (int y = 0; y < source.height; ++y) {
    for (int x = 0; x < source.width; ++x) std::copy_n(source.At(x, y), 4, result.At(y, x));
  }
  return result;
}

}  // namespace

Picture Resample(const Picture& source, int width, int height) {
  Picture result = source;
  if (width != source.width) result = ResampleRows(result, width);
  if (height != source.height) result = Transpose(ResampleRows(Transpose(result), height));
  return result;
}

}  // namespace scumble
