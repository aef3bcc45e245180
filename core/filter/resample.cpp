#include "core/filter/resample.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/filter/weighted_rows.h"
#include "core/image/exact_math.h"

namespace scumble {
namespace {

using internal::kWeightBits;

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

// Calls work(begin, end) for ranges of rows, on the threads of the caller's arena.
template <class Work>
void ForRows(int rows, const Work& work) {
  constexpr int kRowsPerTask = 16;
  tbb::parallel_for(tbb::blocked_range<int>(0, rows, kRowsPerTask),
                    [&](const auto& range) { work(range.begin(), range.end()); });
}

// Along y only. Edges are repeated.
Picture ResampleColumns(const Picture& source, int height) {
  const std::vector<Taps> taps = MakeTaps(source.height, height);
  Picture result(source.width, height);
  ForRows(height, [&](int begin, int end) {
    std::vector<const std::uint16_t*> rows;
    for (int y = begin; y < end; ++y) {
      rows.clear();
      for (std::size_t t = 0; t < taps[y].weights.size(); ++t) {
        rows.push_back(source.At(0, std::clamp(taps[y].first + static_cast<int>(t), 0, source.height - 1)));
      }
      internal::SumRows(taps[y].weights, rows, source.width, result.At(0, y));
    }
  });
  return result;
}

Picture Transpose(const Picture& source) {
  Picture result(source.height, source.width);
  ForRows(source.width, [&](int begin, int end) {  // ranges of columns, a few cache lines wide
    for (int y = 0; y < source.height; ++y) {
      for (int x = begin; x < end; ++x) std::copy_n(source.At(x, y), 4, result.At(y, x));
    }
  });
  return result;
}

}  // namespace

Picture Resample(const Picture& source, int width, int height) {
  const bool is_wide = width != source.width;
  const Picture rows = is_wide ? Transpose(ResampleColumns(Transpose(source), width)) : Picture();
  const Picture& stretched = is_wide ? rows : source;
  return height != source.height ? ResampleColumns(stretched, height) : stretched;
}

}  // namespace scumble
