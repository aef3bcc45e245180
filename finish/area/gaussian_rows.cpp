#include "finish/area/gaussian_rows.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/image/exact_math.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "finish/area/gaussian_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/filter/vector_lane-inl.h"

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

void SumSymmetricHere(std::span<const float> weights, const float* const* rows, std::size_t count, float* out) {
  const Floats d;
  const std::size_t reach = weights.size() - 1, lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    auto sum = hn::Mul(hn::Set(d, weights[0]), hn::LoadU(d, rows[reach] + i));
    for (std::size_t k = 1; k <= reach; ++k) {
      const auto both = hn::Add(hn::LoadU(d, rows[reach - k] + i), hn::LoadU(d, rows[reach + k] + i));
      sum = hn::Add(sum, hn::Mul(hn::Set(d, weights[k]), both));
    }
    hn::StoreU(sum, d, out + i);
  }
  for (; i < count; ++i) {
    float sum = weights[0] * rows[reach][i];
    for (std::size_t k = 1; k <= reach; ++k) sum = sum + weights[k] * (rows[reach - k][i] + rows[reach + k][i]);
    out[i] = sum;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {
namespace {

HWY_EXPORT(SumSymmetricHere);

constexpr int kBand = 32;  // rows that are treated together: their blurred rows stay in the cache

// Of one thread, kept from band to band: large blocks are slow to get and to hand back.
template <std::size_t kCount>
struct BandScratch {
  std::vector<float> padded;
  std::array<std::vector<float>, kCount> half, blurred;
  std::vector<const float*> taps;
};

// Blurs rows of a band and calls row(y, blurred) for each, `blurred` by weights in turn.
template <std::size_t kCount, class Row>
void BlurBand(const FloatPlane& plane, int width, int height, int first, int last,
              const std::array<std::vector<float>, kCount>& weights, BandScratch<kCount>& scratch, const Row& row) {
  int reach = 0;
  for (const auto& one : weights) reach = std::max(reach, static_cast<int>(one.size()) - 1);
  const int top = std::max(0, first - reach), bottom = std::min(height, last + reach);
  const auto columns = static_cast<std::size_t>(width);
  auto& [padded, half, blurred, taps] = scratch;
  padded.resize(columns + 2 * std::size_t(reach));
  for (std::size_t c = 0; c < kCount; ++c) {
    half[c].resize(columns * std::size_t(bottom - top));
    blurred[c].resize(columns);
  }
  for (int y = top; y < bottom; ++y) {
    const float* const from = plane.data() + std::size_t(y) * columns;
    std::fill_n(padded.begin(), reach, from[0]);
    std::copy_n(from, width, padded.begin() + reach);
    std::fill_n(padded.begin() + reach + width, reach, from[width - 1]);
    for (std::size_t c = 0; c < kCount; ++c) {
      const int own = static_cast<int>(weights[c].size()) - 1;
      taps.clear();
      for (int k = -own; k <= own; ++k) taps.push_back(padded.data() + reach + k);
      SumSymmetric(weights[c], taps.data(), columns, half[c].data() + std::size_t(y - top) * columns);
    }
  }
  for (int y = first; y < last; ++y) {
    for (std::size_t c = 0; c < kCount; ++c) {
      const int own = static_cast<int>(weights[c].size()) - 1;
      taps.clear();
      for (int k = -own; k <= own; ++k)
        taps.push_back(half[c].data() + std::size_t(std::clamp(y + k, 0, height - 1) - top) * columns);
      SumSymmetric(weights[c], taps.data(), columns, blurred[c].data());
    }
    row(y, blurred);
  }
}

template <std::size_t kCount, class Row>
void ForEachBand(const FloatPlane& plane, int width, int height, const std::array<std::vector<float>, kCount>& weights,
                 const Row& row) {
  tbb::enumerable_thread_specific<BandScratch<kCount>> scratch;
  tbb::parallel_for(
      tbb::blocked_range<int>(0, (height + kBand - 1) / kBand),
      [&](const auto& bands) {
        for (int band = bands.begin(); band != bands.end(); ++band)
          BlurBand(plane, width, height, band * kBand, std::min(height, band * kBand + kBand), weights, scratch.local(),
                   row);
      },
      tbb::simple_partitioner());
}

}  // namespace

void SumSymmetric(std::span<const float> weights, const float* const* rows, std::size_t count, float* out) {
  HWY_DYNAMIC_DISPATCH(SumSymmetricHere)(weights, rows, count, out);
}

std::vector<float> GaussianWeights(double sigma) {
  const int reach = static_cast<int>(std::ceil(3.0 * sigma));
  std::vector<double> exact;
  double sum = 0.0;
  for (int k = 0; k <= reach; ++k) {
    exact.push_back(Exp2(-0.5 * k * k / (sigma * sigma) * kLog2OfE));
    sum += k == 0 ? exact.back() : 2.0 * exact.back();
  }
  std::vector<float> weights;
  for (const double weight : exact) weights.push_back(static_cast<float>(weight / sum));
  return weights;
}

FloatPlane Blurred(const FloatPlane& plane, int width, int height, double sigma) {
  const std::array<std::vector<float>, 1> weights = {GaussianWeights(sigma)};
  FloatPlane out(plane.size());
  ForEachBand(plane, width, height, weights, [&](int y, const auto& blurred) {
    std::copy_n(blurred[0].data(), width, out.begin() + std::ptrdiff_t(y) * width);
  });
  return out;
}

void ForEachGaussianPair(const FloatPlane& plane, int width, int height, double sigma, float narrow, float wide,
                         float level, const std::function<void(int y, const float* values)>& row) {
  const std::array<std::vector<float>, 2> weights = {GaussianWeights(sigma), GaussianWeights(1.6 * sigma)};
  ForEachBand(plane, width, height, weights, [&](int y, auto& blurred) {
    float* const values = blurred[0].data();
    for (std::size_t x = 0; x < std::size_t(width); ++x)
      values[x] = level + (narrow * values[x] + wide * blurred[1][x]);
    row(y, values);
  });
}

}  // namespace scumble::internal
#endif
