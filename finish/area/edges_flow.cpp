#include "finish/area/edges_flow.h"

#include <tbb/blocked_range.h>
#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "finish/area/gaussian_rows.h"
#include "finish/area/structure_tensor.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "finish/area/edges_flow.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/filter/vector_lane-inl.h"

#ifndef SCUMBLE_FINISH_EDGES_FLOW_ONCE_
#define SCUMBLE_FINISH_EDGES_FLOW_ONCE_
namespace scumble::internal {

constexpr int kFlowSide = 32;  // of the squares of pixels that are treated together

// A plane between its pixels, by bilinear interpolation; beyond its edges it goes on with its last values.
struct FlowPlane {
  const float* values;
  const float* keys;  // by pixel; null: all are equal
  int width, height;
};

// Of pixels of one row: from (x, y) on, up to kFlowSide of them. Values behind the last one may be anything finite.
struct FlowRun {
  int x = 0, y = 0, count = 0;
  alignas(64) float flow_x[kFlowSide], flow_y[kFlowSide], value[kFlowSide], key[kFlowSide], out[kFlowSide];
};

// By distance from the pixel.
struct AcrossWeights {
  std::vector<float> narrow, wide;  // equally many
  float of_narrow, of_wide, level;  // their factors, and what is added
};

struct AlongWeights {
  std::vector<float> weights;
  const float *flow_x, *flow_y;  // planes
};

}  // namespace scumble::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

using IntVector = hn::Vec<Ints>;

HWY_INLINE Lane Gathered(const float* plane, IntVector at) { return hn::GatherIndex(Floats(), plane, at); }

HWY_INLINE Lane Clamped(Lane x, int most) { return Min(Max(x, 0.0f), static_cast<float>(most)); }

// A place's value, as a share of 1; of places of the key alone.
struct FlowSample {
  Lane value, share;
};

template <bool kKeyed>
HWY_INLINE FlowSample SampleAt(const FlowPlane& plane, Lane x, Lane y, Lane key) {
  const Ints di;
  x = Clamped(x, plane.width - 1), y = Clamped(y, plane.height - 1);
  const IntVector x0 = hn::ConvertTo(di, x.v), y0 = hn::ConvertTo(di, y.v), one = hn::Set(di, 1);
  const Lane u = x - Lane(hn::ConvertTo(Floats(), x0)), v = y - Lane(hn::ConvertTo(Floats(), y0));
  const IntVector right = hn::Min(one, hn::Sub(hn::Set(di, plane.width - 1), x0));
  const IntVector below = hn::IfThenElseZero(hn::Lt(y0, hn::Set(di, plane.height - 1)), hn::Set(di, plane.width));
  const IntVector at = hn::Add(hn::Mul(y0, hn::Set(di, plane.width)), x0);
  const IntVector places[4] = {at, hn::Add(at, right), hn::Add(at, below), hn::Add(hn::Add(at, below), right)};
  if constexpr (!kKeyed) {
    const Lane corner[4] = {Gathered(plane.values, places[0]), Gathered(plane.values, places[1]),
                            Gathered(plane.values, places[2]), Gathered(plane.values, places[3])};
    const Lane upper = corner[0] + u * (corner[1] - corner[0]), lower = corner[2] + u * (corner[3] - corner[2]);
    return {upper + v * (lower - upper), 1.0f};
  } else {
    const Lane left = 1.0f - u, above = 1.0f - v;
    const Lane shares[4] = {left * above, u * above, left * v, u * v};
    FlowSample sample{0.0f, 0.0f};
    for (int c = 0; c < 4; ++c) {
      const auto is_one = hn::Eq(Gathered(plane.keys, places[c]).v, key.v);
      const Lane share = hn::IfThenElseZero(is_one, shares[c].v);
      sample.value = sample.value + share * Gathered(plane.values, places[c]);
      sample.share = sample.share + share;
    }
    return sample;
  }
}

HWY_INLINE Lane FirstX(const FlowRun& run, int i) { return hn::Iota(Floats(), static_cast<float>(run.x + i)); }

template <bool kKeyed>
HWY_INLINE void AcrossOf(const FlowPlane& plane, const AcrossWeights& by, FlowRun& run) {
  const Floats d;
  const std::size_t taps = by.wide.size();
  for (int i = 0; i < run.count; i += static_cast<int>(hn::Lanes(d))) {
    const Lane x = FirstX(run, i), y = static_cast<float>(run.y), key = hn::Load(d, run.key + i),
               here = hn::Load(d, run.value + i);
    const Lane step_x = hn::Load(d, run.flow_y + i), step_y = Lane(0.0f) - Lane(hn::Load(d, run.flow_x + i));
    Lane narrow = by.narrow[0] * here, wide = by.wide[0] * here, narrow_share = by.narrow[0], wide_share = by.wide[0];
    for (std::size_t k = 1; k < taps; ++k) {
      const Lane off_x = static_cast<float>(k) * step_x, off_y = static_cast<float>(k) * step_y;
      const FlowSample one = SampleAt<kKeyed>(plane, x + off_x, y + off_y, key),
                       other = SampleAt<kKeyed>(plane, x - off_x, y - off_y, key);
      const Lane both = one.value + other.value;
      narrow = narrow + by.narrow[k] * both, wide = wide + by.wide[k] * both;
      if constexpr (kKeyed) {
        const Lane share = one.share + other.share;
        narrow_share = narrow_share + by.narrow[k] * share, wide_share = wide_share + by.wide[k] * share;
      }
    }
    if constexpr (kKeyed) narrow = narrow / narrow_share, wide = wide / wide_share;
    hn::Store((by.level + (by.of_narrow * narrow + by.of_wide * wide)).v, d, run.out + i);
  }
}

// A Gaussian over the curve through a pixel, as far as the weights go.
template <bool kKeyed>
HWY_INLINE void AlongOf(const FlowPlane& plane, const AlongWeights& by, FlowRun& run) {
  const Floats d;
  const Ints di;
  for (int i = 0; i < run.count; i += static_cast<int>(hn::Lanes(d))) {
    const Lane key = hn::Load(d, run.key + i);
    Lane sum = by.weights[0] * Lane(hn::Load(d, run.value + i)), share = by.weights[0];
    for (const float sign : {1.0f, -1.0f}) {
      Lane x = FirstX(run, i), y = static_cast<float>(run.y);
      Lane step_x = sign * Lane(hn::Load(d, run.flow_x + i)), step_y = sign * Lane(hn::Load(d, run.flow_y + i));
      for (std::size_t k = 1; k < by.weights.size(); ++k) {
        x = Clamped(x + step_x, plane.width - 1), y = Clamped(y + step_y, plane.height - 1);
        const FlowSample sample = SampleAt<kKeyed>(plane, x, y, key);
        sum = sum + by.weights[k] * sample.value;
        if constexpr (kKeyed) share = share + by.weights[k] * sample.share;
        if (k + 1 == by.weights.size()) break;
        const IntVector nearest = hn::Add(hn::Mul(hn::ConvertTo(di, (y + 0.5f).v), hn::Set(di, plane.width)),
                                          hn::ConvertTo(di, (x + 0.5f).v));
        const Lane next_x = Gathered(by.flow_x, nearest), next_y = Gathered(by.flow_y, nearest);
        const Choice turns = Less(next_x * step_x + next_y * step_y, 0.0f);
        step_x = Select(turns, 0.0f - next_x, next_x), step_y = Select(turns, 0.0f - next_y, next_y);
      }
    }
    if constexpr (kKeyed) sum = sum / share;
    hn::Store(sum.v, d, run.out + i);
  }
}

void AcrossHere(const FlowPlane& plane, const AcrossWeights& by, FlowRun& run) {
  plane.keys ? AcrossOf<true>(plane, by, run) : AcrossOf<false>(plane, by, run);
}

void AlongHere(const FlowPlane& plane, const AlongWeights& by, FlowRun& run) {
  plane.keys ? AlongOf<true>(plane, by, run) : AlongOf<false>(plane, by, run);
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {
namespace {

HWY_EXPORT(AcrossHere);
HWY_EXPORT(AlongHere);

// By central differences; across a border of keys nothing changes.
EdgeFlow FlowOfTone(const FlowPlane& plane, double sigma) {
  const int width = plane.width, height = plane.height;
  StructureTensor tensor;
  for (auto* one : {&tensor.xx, &tensor.xy, &tensor.yy}) one->resize(std::size_t(width) * std::size_t(height));
  tbb::parallel_for(tbb::blocked_range<int>(0, height, 16), [&](const auto& rows) {
    for (int y = rows.begin(); y != rows.end(); ++y) {
      const auto row = [&](int v) { return std::ptrdiff_t(std::clamp(v, 0, height - 1)) * width; };
      const std::ptrdiff_t own = row(y), above = row(y - 1), below = row(y + 1);
      const auto put = [&](int x, int before, int after) {
        const auto beside = [&](std::ptrdiff_t q) {
          return plane.values[!plane.keys || plane.keys[q] == plane.keys[own + x] ? q : own + x];
        };
        const float dx = beside(own + after) - beside(own + before), dy = beside(below + x) - beside(above + x);
        const auto i = std::size_t(own + x);
        tensor.xx[i] = dx * dx, tensor.xy[i] = dx * dy, tensor.yy[i] = dy * dy;
      };
      put(0, 0, std::min(1, width - 1));
      if (width > 1) put(width - 1, width - 2, width - 1);
      for (int x = 1; x < width - 1; ++x) put(x, x - 1, x + 1);
    }
  });
  return FlowOf(tensor, width, height, sigma);
}

// Calls visit(run) for parts of rows, square by square, from several threads, and puts its results into `out`. Squares
// for which skip(x, y) holds are left out.
template <class Skip, class Visit>
void ForEachRun(const FlowPlane& plane, const EdgeFlow& flow, FloatPlane& out, const Skip& skip, const Visit& visit) {
  const int columns = (plane.width + kFlowSide - 1) / kFlowSide, rows = (plane.height + kFlowSide - 1) / kFlowSide;
  tbb::parallel_for(tbb::blocked_range2d<int>(0, rows, 1, 0, columns, 4), [&](const auto& part) {
    FlowRun run{};
    for (int row = part.rows().begin(); row != part.rows().end(); ++row) {
      for (int column = part.cols().begin(); column != part.cols().end(); ++column) {
        run.x = column * kFlowSide, run.count = std::min(kFlowSide, plane.width - run.x);
        if (skip(run.x, row * kFlowSide)) continue;
        for (run.y = row * kFlowSide; run.y < std::min(plane.height, row * kFlowSide + kFlowSide); ++run.y) {
          const std::size_t first = std::size_t(run.y) * std::size_t(plane.width) + std::size_t(run.x);
          std::copy_n(flow.x.data() + first, run.count, run.flow_x);
          std::copy_n(flow.y.data() + first, run.count, run.flow_y);
          std::copy_n(plane.values + first, run.count, run.value);
          if (plane.keys) std::copy_n(plane.keys + first, run.count, run.key);
          visit(run);
          std::copy_n(run.out, run.count, out.data() + first);
        }
      }
    }
  });
}

// Whether holds(value) is true of all places of a square of ForEachRun and of `reach` around.
template <class Holds>
bool AllAround(const FlowPlane& plane, int x, int y, int reach, const Holds& holds) {
  const int left = std::max(0, x - reach), right = std::min(plane.width, x + kFlowSide + reach);
  for (int v = std::max(0, y - reach); v < std::min(plane.height, y + kFlowSide + reach); ++v) {
    const float* const row = plane.values + std::ptrdiff_t(v) * plane.width;
    int fails = 0;
    for (int u = left; u < right; ++u) fails |= holds(row[u]) ? 0 : 1;
    if (fails != 0) return false;
  }
  return true;
}

}  // namespace

FloatPlane FlowResponse(const FloatPlane& tone, std::span<const float> keys, int width, int height,
                        const FlowLengths& lengths, const FlowFactors& factors) {
  const FlowPlane of_tone{tone.data(), keys.empty() ? nullptr : keys.data(), width, height};
  const EdgeFlow flow = FlowOfTone(of_tone, lengths.tensor_sigma);
  AcrossWeights across{GaussianWeights(lengths.sigma), GaussianWeights(1.6 * lengths.sigma), factors.narrow,
                       factors.wide, factors.level};
  across.narrow.resize(across.wide.size(), 0.0f);
  const AlongWeights along{GaussianWeights(lengths.along), flow.x.data(), flow.y.data()};
  FloatPlane between(tone.size());
  // Where all is of one tone there is no edge.
  const auto is_even_around = [&](int x, int y) {
    const float here = tone[std::size_t(y) * std::size_t(width) + std::size_t(x)];
    const auto is_here = [&](float value) { return value == here; };
    if (!AllAround(of_tone, x, y, static_cast<int>(across.wide.size()) + 1, is_here)) return false;
    const float even = factors.level + (factors.narrow + factors.wide) * here;
    for (int v = y; v < std::min(height, y + kFlowSide); ++v) {
      const auto row = between.begin() + std::ptrdiff_t(v) * width;
      std::fill(row + x, row + std::min(width, x + kFlowSide), even);
    }
    return true;
  };
  ForEachRun(of_tone, flow, between, is_even_around, [&](FlowRun& run) {
    HWY_DYNAMIC_DISPATCH(AcrossHere)
    (of_tone, across, run);
  });

  FloatPlane out = between;
  const FlowPlane of_between{between.data(), of_tone.keys, width, height};
  const int reach = static_cast<int>(along.weights.size());
  const auto is_enough_around = [&](int x, int y) {
    return AllAround(of_between, x, y, reach, [&](float value) { return value >= factors.enough; });
  };
  ForEachRun(of_between, flow, out, is_enough_around, [&](FlowRun& run) {
    HWY_DYNAMIC_DISPATCH(AlongHere)(of_between, along, run);
  });
  return out;
}

}  // namespace scumble::internal
#endif
