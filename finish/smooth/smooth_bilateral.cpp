#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/image/exact_math.h"
#include "finish/smooth/smooth_filters.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "finish/smooth/smooth_bilateral.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/filter/vector_lane-inl.h"

#ifndef SCUMBLE_FINISH_SMOOTH_BILATERAL_ONCE_
#define SCUMBLE_FINISH_SMOOTH_BILATERAL_ONCE_
namespace scumble::internal {

struct BilateralRun {
  const float *lightness, *a, *b, *key;
  float *out_lightness, *out_a, *out_b;
  std::ptrdiff_t step;            // from a pixel to the next of its line
  std::span<const float> weight;  // of places, at 0, 1, …
  float per_square;
};

}  // namespace scumble::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

// Sums differences to the pixel itself, so that an even colour stays as it is to the bit.
void BilateralHere(const BilateralRun& run, std::size_t first, std::size_t count) {
  const Floats d;
  const auto one = hn::Set(d, 1.0f), zero = hn::Zero(d), per_square = hn::Set(d, run.per_square);
  for (std::size_t p = first; p < first + count; p += hn::Lanes(d)) {
    const auto l = hn::LoadU(d, run.lightness + p), a = hn::LoadU(d, run.a + p), b = hn::LoadU(d, run.b + p),
               key = hn::LoadU(d, run.key + p);
    auto sum = hn::Set(d, run.weight[0]), sum_l = zero, sum_a = zero, sum_b = zero;
    const auto add = [&](std::ptrdiff_t offset, hn::Vec<Floats> of_place) HWY_ATTR {
      const std::size_t q = std::size_t(std::ptrdiff_t(p) + offset);
      const auto dl = hn::Sub(hn::LoadU(d, run.lightness + q), l), da = hn::Sub(hn::LoadU(d, run.a + q), a),
                 db = hn::Sub(hn::LoadU(d, run.b + q), b);
      const auto square = hn::Add(hn::Add(hn::Mul(dl, dl), hn::Mul(da, da)), hn::Mul(db, db));
      const auto room = hn::Max(zero, hn::Sub(one, hn::Mul(square, per_square)));
      const auto weight =
          hn::IfThenElseZero(hn::Eq(key, hn::LoadU(d, run.key + q)), hn::Mul(of_place, hn::Mul(room, room)));
      sum = hn::Add(sum, weight);
      sum_l = hn::Add(sum_l, hn::Mul(weight, dl));
      sum_a = hn::Add(sum_a, hn::Mul(weight, da));
      sum_b = hn::Add(sum_b, hn::Mul(weight, db));
    };
    for (std::size_t k = 1; k < run.weight.size(); ++k) {
      const auto of_place = hn::Set(d, run.weight[k]);
      add(-std::ptrdiff_t(k) * run.step, of_place);
      add(std::ptrdiff_t(k) * run.step, of_place);
    }
    const auto per_sum = hn::Div(one, sum);
    hn::StoreU(hn::Add(l, hn::Mul(sum_l, per_sum)), d, run.out_lightness + p);
    hn::StoreU(hn::Add(a, hn::Mul(sum_a, per_sum)), d, run.out_a + p);
    hn::StoreU(hn::Add(b, hn::Mul(sum_b, per_sum)), d, run.out_b + p);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {

HWY_EXPORT(BilateralHere);

std::size_t BilateralPad(double sigma, std::size_t longer_side) {
  return static_cast<std::size_t>(std::min(std::ceil(2.0 * sigma), static_cast<double>(longer_side)));
}

void BilateralFilter(double sigma, double range, SmoothPlanes& planes) {
  std::vector<float> weights;
  for (std::size_t k = 0; k <= BilateralPad(sigma, std::max(planes.width, planes.height)); ++k)
    weights.push_back(static_cast<float>(Exp2(-0.5 * double(k) * double(k) / (sigma * sigma) * kLog2OfE)));
  planes.MakeNext();
  for (const bool rows : {true, false}) {
    const BilateralRun run{planes.lightness.data(),
                           planes.a.data(),
                           planes.b.data(),
                           planes.key.data(),
                           planes.next_lightness.data(),
                           planes.next_a.data(),
                           planes.next_b.data(),
                           rows ? 1 : std::ptrdiff_t(planes.stride),
                           weights,
                           BiweightPerSquare(range)};
    // Tiles of whole vectors whose rows above and below stay in the cache.
    constexpr std::size_t kTile = 128;
    const std::size_t tiles = (planes.width + kTile - 1) / kTile;
    tbb::parallel_for(tbb::blocked_range2d<std::size_t>(0, planes.height, 64, 0, tiles, 1), [&](const auto& part) {
      for (std::size_t tile = part.cols().begin(); tile != part.cols().end(); ++tile) {
        for (std::size_t y = part.rows().begin(); y != part.rows().end(); ++y) {
          HWY_DYNAMIC_DISPATCH(BilateralHere)
          (run, planes.At(tile * kTile, y), std::min(kTile, planes.width - tile * kTile));
        }
      }
    });
    // Around the picture stays 0 but for the rest of the last vectors, which nothing looks at.
    planes.TakeNext();
  }
}

}  // namespace scumble::internal
#endif
