#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "core/image/exact_math.h"
#include "finish/smooth/smooth_filters.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "finish/smooth/smooth_bilateral.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "finish/smooth/color_sums-inl.h"

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

void BilateralHere(const BilateralRun& run, std::size_t first, std::size_t count) {
  const Floats d;
  const auto one = hn::Set(d, 1.0f), zero = hn::Zero(d), per_square = hn::Set(d, run.per_square);
  for (std::size_t p = first; p < first + count; p += hn::Lanes(d)) {
    const ColorLanes own = LoadColors(run.lightness, run.a, run.b, p);
    const auto key = hn::LoadU(d, run.key + p);
    ColorSums sums(run.weight[0]);
    const auto add = [&](std::ptrdiff_t offset, hn::Vec<Floats> of_place) HWY_ATTR {
      const std::size_t q = std::size_t(std::ptrdiff_t(p) + offset);
      const ColorLanes difference = Difference(LoadColors(run.lightness, run.a, run.b, q), own);
      const auto room = hn::Max(zero, hn::Sub(one, hn::Mul(SquaredLength(difference), per_square)));
      const auto same = hn::Eq(key, hn::LoadU(d, run.key + q));
      sums.Add(hn::IfThenElseZero(same, hn::Mul(of_place, hn::Mul(room, room))), difference);
    };
    for (std::size_t k = 1; k < run.weight.size(); ++k) {
      const auto of_place = hn::Set(d, run.weight[k]);
      add(-std::ptrdiff_t(k) * run.step, of_place);
      add(std::ptrdiff_t(k) * run.step, of_place);
    }
    sums.StoreMean(own, run.out_lightness, run.out_a, run.out_b, p);
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
