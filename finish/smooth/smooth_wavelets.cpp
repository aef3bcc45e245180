#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "finish/smooth/smooth_filters.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "finish/smooth/smooth_wavelets.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "finish/smooth/color_sums-inl.h"

#ifndef SCUMBLE_FINISH_SMOOTH_WAVELETS_ONCE_
#define SCUMBLE_FINISH_SMOOTH_WAVELETS_ONCE_
namespace scumble::internal {

struct WaveletRun {
  const float *lightness, *a, *b, *key;
  const float *normal_x, *normal_y, *normal_z, *depth;  // null: no stops
  float *out_lightness, *out_a, *out_b;
  std::ptrdiff_t across, down;  // places from a tap to the next
  float per_color, per_normal, per_depth;
};

}  // namespace scumble::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

void WaveletsHere(const WaveletRun& run, std::size_t first, std::size_t count) {
  const Floats d;
  constexpr float kSpline[] = {3.0f / 8.0f, 1.0f / 4.0f, 1.0f / 16.0f};
  const auto one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  const auto biweight = [&](hn::Vec<Floats> square, float per_square) HWY_ATTR {
    const auto room = hn::Max(zero, hn::Sub(one, hn::Mul(square, hn::Set(d, per_square))));
    return hn::Mul(room, room);
  };
  for (std::size_t p = first; p < first + count; p += hn::Lanes(d)) {
    const auto at = [&](const float* plane, std::size_t q) HWY_ATTR { return hn::LoadU(d, plane + q); };
    const ColorLanes own = LoadColors(run.lightness, run.a, run.b, p);
    const auto key = at(run.key, p);
    ColorSums sums(kSpline[0] * kSpline[0]);
    for (int v = -2; v <= 2; ++v) {
      for (int u = -2; u <= 2; ++u) {
        if (u == 0 && v == 0) continue;
        const std::size_t q = std::size_t(std::ptrdiff_t(p) + v * run.down + u * run.across);
        const auto square = [&](const float* plane) HWY_ATTR {
          const auto off = hn::Sub(at(plane, q), at(plane, p));
          return hn::Mul(off, off);
        };
        const ColorLanes difference = Difference(LoadColors(run.lightness, run.a, run.b, q), own);
        auto weight = hn::Mul(hn::Set(d, kSpline[u < 0 ? -u : u] * kSpline[v < 0 ? -v : v]),
                              biweight(SquaredLength(difference), run.per_color));
        if (run.depth) {
          const auto normals = hn::Add(hn::Add(square(run.normal_x), square(run.normal_y)), square(run.normal_z));
          weight = hn::Mul(weight, biweight(normals, run.per_normal));
          // The squared difference as a share of the product of depths; 0 depth has no stop.
          const auto depths = hn::Max(hn::Mul(at(run.depth, q), at(run.depth, p)), hn::Set(d, 1e-20f));
          weight = hn::Mul(weight, biweight(hn::Div(square(run.depth), depths), run.per_depth));
        }
        sums.Add(hn::IfThenElseZero(hn::Eq(key, at(run.key, q)), weight), difference);
      }
    }
    sums.StoreMean(own, run.out_lightness, run.out_a, run.out_b, p);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {
namespace {

HWY_EXPORT(WaveletsHere);

// The spline's variance is 1, so that n levels have one of (4^n - 1) / 3: the least n that has sigma² or more. No level
// reaches beyond the picture.
int WaveletLevels(double sigma, std::size_t longer_side) {
  int levels = 1;
  while ((std::ldexp(1.0, 2 * levels) - 1.0) / 3.0 < sigma * sigma && (std::size_t{2} << levels) <= longer_side)
    ++levels;
  return levels;
}

}  // namespace

std::size_t WaveletsPad(double sigma, std::size_t longer_side) {
  return std::size_t{1} << WaveletLevels(sigma, longer_side);  // two taps of half of that
}

void WaveletsFilter(double sigma, double range, double scale, const WaveletStops& stops, SmoothPlanes& planes) {
  planes.MakeNext();
  const int levels = WaveletLevels(sigma, std::max(planes.width, planes.height));
  const bool has_stops = !stops.depth.empty();
  const auto stop = [&](const FloatPlane& plane) { return has_stops ? plane.data() : nullptr; };
  for (int level = 0; level < levels; ++level) {
    const std::ptrdiff_t apart = std::ptrdiff_t{1} << level;
    const WaveletRun run{planes.lightness.data(),
                         planes.a.data(),
                         planes.b.data(),
                         planes.key.data(),
                         stop(stops.normal_x),
                         stop(stops.normal_y),
                         stop(stops.normal_z),
                         stop(stops.depth),
                         planes.next_lightness.data(),
                         planes.next_a.data(),
                         planes.next_b.data(),
                         apart,
                         apart * std::ptrdiff_t(planes.stride),
                         BiweightPerSquare(std::ldexp(range * scale, -level)),
                         BiweightPerSquare(0.5),
                         BiweightPerSquare(0.01 * double(apart) / scale)};
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, planes.height, 16), [&](const auto& part) {
      for (std::size_t y = part.begin(); y != part.end(); ++y)
        HWY_DYNAMIC_DISPATCH(WaveletsHere)(run, planes.At(0, y), planes.width);
    });
    planes.TakeNext();
  }
}

}  // namespace scumble::internal
#endif
