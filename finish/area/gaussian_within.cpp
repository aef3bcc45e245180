#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "finish/area/gaussian_rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "finish/area/gaussian_within.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/filter/vector_lane-inl.h"

#ifndef SCUMBLE_FINISH_GAUSSIAN_WITHIN_ONCE_
#define SCUMBLE_FINISH_GAUSSIAN_WITHIN_ONCE_
namespace scumble::internal {

// Tap k is values[k], shares[k] and keys[k]; the place itself is the middle one. Vectors may reach 15 values further.
struct WithinTaps {
  std::span<const float> weights;
  std::vector<const float*> values, shares, keys;
};

}  // namespace scumble::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

// Sums of values and of shares over the taps whose key is that of the place. Taps at equal distances are added first,
// so that a mirrored plane gives mirrored bytes.
void SumWithinHere(const WithinTaps& taps, std::size_t count, float* value, float* share) {
  const Floats d;
  const std::size_t reach = taps.weights.size() - 1;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto key = hn::LoadU(d, taps.keys[reach] + i);
    const auto if_equal = [&](const std::vector<const float*>& rows, std::size_t k) HWY_ATTR {
      return hn::IfThenElseZero(hn::Eq(key, hn::LoadU(d, taps.keys[k] + i)), hn::LoadU(d, rows[k] + i));
    };
    const auto own = hn::Set(d, taps.weights[0]);
    auto values = hn::Mul(own, if_equal(taps.values, reach)), shares = hn::Mul(own, if_equal(taps.shares, reach));
    for (std::size_t k = 1; k <= reach; ++k) {
      const auto weight = hn::Set(d, taps.weights[k]);
      const auto both = hn::Add(if_equal(taps.values, reach - k), if_equal(taps.values, reach + k));
      const auto both_shares = hn::Add(if_equal(taps.shares, reach - k), if_equal(taps.shares, reach + k));
      values = hn::Add(values, hn::Mul(weight, both));
      shares = hn::Add(shares, hn::Mul(weight, both_shares));
    }
    hn::StoreU(values, d, value + i);
    hn::StoreU(shares, d, share + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {
namespace {

HWY_EXPORT(SumWithinHere);

constexpr std::size_t kWithinSpare = 16;  // values that a vector may reach beyond a row

// Calls row(y, scratch) for all rows, from several threads.
template <class Scratch, class Row>
void ForEachRowWith(int height, const Scratch& empty, const Row& row) {
  tbb::parallel_for(tbb::blocked_range<int>(0, height, 16), [&](const auto& rows) {
    Scratch scratch = empty;
    for (int y = rows.begin(); y != rows.end(); ++y) row(y, scratch);
  });
}

struct WithinScratch {
  std::vector<float> values, shares, keys;  // of a row with its surroundings
  std::vector<float> value, share;          // sums
  WithinTaps taps;
};

}  // namespace

FloatPlane BlurredWithin(const FloatPlane& plane, std::span<const float> keys, int width, int height, double sigma) {
  const std::vector<float> weights = GaussianWeights(sigma);
  const auto reach = static_cast<std::ptrdiff_t>(weights.size()) - 1;
  const auto columns = static_cast<std::size_t>(width);
  const std::size_t taps = 2 * std::size_t(reach) + 1, padded = columns + 2 * std::size_t(reach) + kWithinSpare;
  constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
  FloatPlane value(plane.size() + kWithinSpare), share(plane.size() + kWithinSpare), key(plane.size() + kWithinSpare);
  for (auto* one : {&value, &share, &key}) std::fill(one->end() - kWithinSpare, one->end(), 0.0f);

  WithinScratch scratch;
  scratch.values.assign(padded, 0.0f), scratch.shares.assign(padded, 1.0f), scratch.keys.assign(padded, kNothing);
  scratch.value.resize(columns + kWithinSpare), scratch.share.resize(columns + kWithinSpare);
  scratch.taps.weights = weights;
  for (auto* rows : {&scratch.taps.values, &scratch.taps.shares, &scratch.taps.keys}) rows->resize(taps);
  ForEachRowWith(height, scratch, [&](int y, WithinScratch& own) {
    const std::size_t first = std::size_t(y) * columns;
    std::copy_n(plane.data() + first, columns, own.values.begin() + reach);
    std::copy_n(keys.data() + first, columns, own.keys.begin() + reach);
    for (std::size_t k = 0; k < taps; ++k) {
      own.taps.values[k] = own.values.data() + k, own.taps.shares[k] = own.shares.data() + k;
      own.taps.keys[k] = own.keys.data() + k;
    }
    HWY_DYNAMIC_DISPATCH(SumWithinHere)(own.taps, columns, own.value.data(), own.share.data());
    std::copy_n(own.value.data(), columns, value.data() + first);
    std::copy_n(own.share.data(), columns, share.data() + first);
    std::copy_n(keys.data() + first, columns, key.data() + first);
  });

  FloatPlane out(plane.size());
  const std::vector<float> outside(columns + kWithinSpare, kNothing);
  ForEachRowWith(height, scratch, [&](int y, WithinScratch& own) {
    for (std::size_t k = 0; k < taps; ++k) {
      const std::ptrdiff_t v = y + std::ptrdiff_t(k) - reach;
      const bool is_inside = v >= 0 && v < height;
      const std::size_t first = std::size_t(is_inside ? v : y) * columns;
      own.taps.values[k] = value.data() + first, own.taps.shares[k] = share.data() + first;
      own.taps.keys[k] = is_inside ? key.data() + first : outside.data();
    }
    HWY_DYNAMIC_DISPATCH(SumWithinHere)(own.taps, columns, own.value.data(), own.share.data());
    const std::size_t first = std::size_t(y) * columns;
    for (std::size_t x = 0; x < columns; ++x)
      out[first + x] = own.share[x] > 0.0f ? own.value[x] / own.share[x] : plane[first + x];
  });
  return out;
}

}  // namespace scumble::internal
#endif
