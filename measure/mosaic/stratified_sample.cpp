#include "measure/mosaic/stratified_sample.h"

#include <cmath>
#include <numeric>

#include "core/image/hash.h"

namespace scumble::internal {

StratifiedSample ChooseStratified(std::size_t count, std::size_t samples, std::uint64_t seed) {
  StratifiedSample sample;
  const std::size_t strata = samples / 2 + samples % 2;
  if (samples == 0 || strata >= (count + 1) / 2) {
    sample.places.resize(count);
    std::iota(sample.places.begin(), sample.places.end(), std::size_t(0));
    return sample;
  }
  for (std::size_t s = 0; s < strata; ++s) {
    const std::size_t begin = s * count / strata, size = (s + 1) * count / strata - begin;
    const std::size_t one = Hash(seed, s, 0) % size;
    std::size_t other = Hash(seed, s, 1) % (size - 1);
    if (other >= one) ++other;
    sample.places.push_back(begin + one), sample.places.push_back(begin + other);
    sample.strata.push_back(size);
  }
  return sample;
}

Estimate MeanOf(const StratifiedSample& sample, std::span<const double> values) {
  Estimate estimate;
  if (values.empty()) return estimate;
  if (sample.strata.empty()) {
    for (const double value : values) estimate.mean += value;
    estimate.mean /= static_cast<double>(values.size());
    return estimate;
  }
  double total = 0.0, variance = 0.0;
  for (std::size_t s = 0; s < sample.strata.size(); ++s) {
    const double size = static_cast<double>(sample.strata[s]), a = values[2 * s], b = values[2 * s + 1];
    total += size;
    estimate.mean += size * 0.5 * (a + b);
    variance += size * size * (1.0 - 2.0 / size) * 0.25 * (a - b) * (a - b);
  }
  estimate.mean /= total, estimate.standard_error = std::sqrt(variance) / total;
  return estimate;
}

}  // namespace scumble::internal
