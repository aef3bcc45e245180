#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/image/exact_math.h"
#include "finish/area/area_effects.h"
#include "finish/area/lab_planes.h"

namespace scumble::internal {
namespace {

// One direction of the filter over a block of lines that lie side by side in memory: `step` from a pixel to the next of
// its line, `lines` from one line to the next.
struct Direction {
  std::size_t step, count;  // along a line
};

// What the filter reads of a picture.
struct Source {
  const LabPlanes& colors;
  std::span<const std::uint8_t> counts;  // by pixel: 0 where there is no paint
  std::span<const float> object;         // empty: objects are mixed
};

struct FilterWeights {
  std::vector<float> of_place;  // at 0, 1, …
  float per_square;             // of a colour's squared distance: 1 / c²
};

// Filters `run` pixels from `first` on, which are one after the other in memory and each at `at` of its line.
void FilterRun(const Source& source, const FilterWeights& weights, const Direction& along, std::size_t at,
               std::size_t first, std::size_t run, LabPlanes& out) {
  constexpr std::size_t kRun = 128;
  float sum[kRun], sum_l[kRun], sum_a[kRun], sum_b[kRun];
  const auto& [l, a, b] = source.colors;
  for (std::size_t i = 0; i < run; ++i) {
    const std::size_t p = first + i;
    sum[i] = weights.of_place[0];
    sum_l[i] = weights.of_place[0] * l[p], sum_a[i] = weights.of_place[0] * a[p], sum_b[i] = weights.of_place[0] * b[p];
  }
  const auto add = [&](std::size_t k, std::ptrdiff_t offset, std::size_t from, std::size_t to) {
    const float of_place = weights.of_place[k];
    for (std::size_t i = from; i < to; ++i) {
      const std::size_t p = first + i, q = std::size_t(std::ptrdiff_t(p) + offset);
      const float dl = l[q] - l[p], da = a[q] - a[p], db = b[q] - b[p];
      const float room = std::max(0.0f, 1.0f - (dl * dl + da * da + db * db) * weights.per_square);
      const bool counts = source.counts[q] != 0 && (source.object.empty() || source.object[p] == source.object[q]);
      const float weight = counts ? of_place * room * room : 0.0f;
      sum[i] += weight;
      sum_l[i] += weight * l[q], sum_a[i] += weight * a[q], sum_b[i] += weight * b[q];
    }
  };
  const bool is_row = along.step == 1;
  for (std::size_t k = 1; k < weights.of_place.size(); ++k) {
    const auto offset = static_cast<std::ptrdiff_t>(k * along.step);
    // Along a row, a run's pixels are at different places of it.
    const std::size_t begin = is_row ? (k > at ? std::min(run, k - at) : 0) : 0;
    if (is_row || at >= k) add(k, -offset, begin, run);
    const std::size_t room = along.count > at + k ? along.count - at - k : 0;
    const std::size_t end = is_row ? std::min(run, room) : run;
    if (is_row || room > 0) add(k, offset, 0, end);
  }
  for (std::size_t i = 0; i < run; ++i) {
    const std::size_t p = first + i;
    const float per_sum = 1.0f / sum[i];
    out.lightness[p] = sum_l[i] * per_sum, out.a[p] = sum_a[i] * per_sum, out.b[p] = sum_b[i] * per_sum;
  }
}

void FilterAlong(const Source& source, const FilterWeights& weights, bool rows, std::size_t width, std::size_t height,
                 LabPlanes& out) {
  constexpr std::size_t kRun = 128;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, height, 8), [&](const auto& part) {
    for (std::size_t y = part.begin(); y != part.end(); ++y) {
      for (std::size_t x = 0; x < width; x += kRun) {
        const std::size_t run = std::min(kRun, width - x);
        const Direction along = rows ? Direction{1, width} : Direction{width, height};
        FilterRun(source, weights, along, rows ? x : y, y * width + x, run, out);
      }
    }
  });
}

}  // namespace

void Smooth(const SmoothPass& pass, double strength, std::span<const std::uint8_t> only, const FinishFrame& frame,
            Picture& picture) {
  const double sigma = pass.radius * frame.scale;
  FilterWeights weights;
  const int reach = static_cast<int>(std::ceil(2.0 * sigma));
  for (int k = 0; k <= reach; ++k)
    weights.of_place.push_back(static_cast<float>(Exp2(-0.5 * k * k / (sigma * sigma) * 1.4426950408889634)));
  // (1 - d² / c²)² is a half at d = 0.5412 c.
  weights.per_square = static_cast<float>(0.2928932188134524 / (pass.range * pass.range));
  const LabPlanes given = PlanesOf(picture);
  LabPlanes now = given, next = given;
  std::vector<std::uint8_t> counts(given.a.size());
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = picture.rgba[4 * i + 3] != 0;
  const std::span<const float> object = pass.borders ? frame.guides->Plane(Layer::kObject) : std::span<const float>();
  const auto width = static_cast<std::size_t>(picture.width), height = static_cast<std::size_t>(picture.height);
  for (int i = 0; i < pass.passes; ++i) {
    for (const bool rows : {true, false}) {
      FilterAlong({now, counts, object}, weights, rows, width, height, next);
      std::swap(now, next);
    }
  }
  PutPlanes(now, given, strength, only, picture);
}

}  // namespace scumble::internal
