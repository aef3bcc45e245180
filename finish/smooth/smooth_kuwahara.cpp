#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "finish/area/structure_tensor.h"
#include "finish/smooth/smooth_filters.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "finish/smooth/smooth_kuwahara.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/filter/vector_lane-inl.h"

#ifndef SCUMBLE_FINISH_SMOOTH_KUWAHARA_ONCE_
#define SCUMBLE_FINISH_SMOOTH_KUWAHARA_ONCE_
namespace scumble::internal {

struct KuwaharaRun {
  const float *lightness, *a, *b, *key;
  const float *flow_x, *flow_y, *anisotropy;  // of the first pixel
  float *out_lightness, *out_a, *out_b;
  std::ptrdiff_t stride;
  int most;  // places that may be looked at on each side
  float radius;
};

}  // namespace scumble::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

using Vector = hn::Vec<Floats>;

// What a sector holds: the weighted sum of differences to the pixel, of their squared lengths, and of weights.
struct KuwaharaSector {
  Vector l, a, b, square, weight;
};

constexpr int kHalf = 4;  // sectors; as many lie opposite
// A sector's weight is max(0, y + ζ - η x²)² along its axis: it overlaps the middle by ζ = 1/3, and its neighbours up
// to 3/16 π from its axis.
constexpr float kZeta = 1.0f / 3.0f, kEta = 3.774f;

// The weights of the eight sectors at a place of the unit circle, together those of a Gaussian of 0.4.
HWY_INLINE void SectorWeights(Lane x, Lane y, Lane square, Vector* weight) {
  const Lane slant_x = 0.70710678f * (x - y), slant_y = 0.70710678f * (x + y);
  const Lane from_x = kZeta - kEta * (x * x), from_y = kZeta - kEta * (y * y);
  const Lane from_slant_x = kZeta - kEta * (slant_x * slant_x), from_slant_y = kZeta - kEta * (slant_y * slant_y);
  const Lane height[2 * kHalf] = {from_x + y, from_slant_x + slant_y, from_y - x, from_slant_y - slant_x,
                                  from_x - y, from_slant_x - slant_y, from_y + x, from_slant_y + slant_x};
  Lane part[2 * kHalf], sum = 0.0f;
  for (int k = 0; k < 2 * kHalf; ++k) {
    const Lane above = Max(0.0f, height[k]);
    part[k] = above * above;
    sum = sum + part[k];
  }
  // exp(-x) as (1 - x / 16)^16.
  Lane fall = 1.0f - (3.125f / 16.0f) * square;
  for (int i = 0; i < 4; ++i) fall = fall * fall;
  const Lane share = fall / sum;
  for (int k = 0; k < 2 * kHalf; ++k) weight[k] = (part[k] * share).v;
}

HWY_INLINE void AddTo(KuwaharaSector& sector, Vector weight, Vector l, Vector a, Vector b, Vector square) {
  sector.l = hn::Add(sector.l, hn::Mul(weight, l));
  sector.a = hn::Add(sector.a, hn::Mul(weight, a));
  sector.b = hn::Add(sector.b, hn::Mul(weight, b));
  sector.square = hn::Add(sector.square, hn::Mul(weight, square));
  sector.weight = hn::Add(sector.weight, weight);
}

// The mean of the sectors' means, each by 1 / (1 + deviation^6), deviations being 0 … 255. One that lies outside of
// what is looked at for the most part has too little in it to be called even.
HWY_INLINE void StoreMeanOfSectors(const KuwaharaSector* sectors, const KuwaharaRun& run, std::size_t p) {
  const Floats d;
  Lane most = 0.0f, sum = 0.0f, l = 0.0f, a = 0.0f, b = 0.0f;
  for (int k = 0; k < 2 * kHalf; ++k) most = Max(most, sectors[k].weight);
  for (int k = 0; k < 2 * kHalf; ++k) {
    const Lane per_weight = Lane(1.0f) / Lane(sectors[k].weight);
    const Lane mean_l = Lane(sectors[k].l) * per_weight, mean_a = Lane(sectors[k].a) * per_weight,
               mean_b = Lane(sectors[k].b) * per_weight;
    const Lane variance =
        Max(0.0f, Lane(sectors[k].square) * per_weight - (mean_l * mean_l + mean_a * mean_a + mean_b * mean_b));
    const Lane square = variance * (255.0f * 255.0f);
    const Lane power = square * square * square;
    const Choice is_poor = Less(sectors[k].weight, most * 0.25f);
    const Lane weight = Select(is_poor, 0.0f, Lane(1.0f) / (Lane(1.0f) + power));
    sum = sum + weight;
    l = l + weight * mean_l, a = a + weight * mean_a, b = b + weight * mean_b;
  }
  hn::StoreU((Lane(hn::LoadU(d, run.lightness + p)) + l / sum).v, d, run.out_lightness + p);
  hn::StoreU((Lane(hn::LoadU(d, run.a + p)) + a / sum).v, d, run.out_a + p);
  hn::StoreU((Lane(hn::LoadU(d, run.b + p)) + b / sum).v, d, run.out_b + p);
}

HWY_INLINE int MostOf(Lane extent, int most) {
  const float largest = hn::GetLane(hn::MaxOfLanes(Floats(), extent.v));
  return largest < static_cast<float>(most) ? static_cast<int>(largest) : most;
}

void KuwaharaHere(const KuwaharaRun& run, std::size_t first, std::size_t count) {
  const Floats d;
  const Vector zero = hn::Zero(d);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const std::size_t p = first + i;
    const Vector l = hn::LoadU(d, run.lightness + p), a = hn::LoadU(d, run.a + p), b = hn::LoadU(d, run.b + p),
                 key = hn::LoadU(d, run.key + p);
    const Lane flow_x = hn::LoadU(d, run.flow_x + i), flow_y = hn::LoadU(d, run.flow_y + i);
    const Lane longer = Lane(1.0f) + Lane(hn::LoadU(d, run.anisotropy + i));
    const Lane along = longer * run.radius, across = Lane(run.radius) / longer;
    const Lane cos_along = flow_x / along, sin_along = flow_y / along;
    const Lane cos_across = flow_x / across, sin_across = flow_y / across;
    const Lane along2 = along * along, across2 = across * across, x2 = flow_x * flow_x, y2 = flow_y * flow_y;
    const int reach_x = MostOf(Sqrt(along2 * x2 + across2 * y2), run.most),
              reach_y = MostOf(Sqrt(along2 * y2 + across2 * x2), run.most);
    KuwaharaSector sectors[2 * kHalf];
    for (KuwaharaSector& sector : sectors) sector = {zero, zero, zero, zero, hn::Set(d, 0.125f)};
    // A place and the one opposite have each other's weights.
    for (int v = 0; v <= reach_y; ++v) {
      for (int u = v == 0 ? 1 : -reach_x; u <= reach_x; ++u) {
        const Lane right = static_cast<float>(u), down = static_cast<float>(v);
        const Lane x = right * cos_along + down * sin_along, y = down * cos_across - right * sin_across;
        const Lane square = x * x + y * y;
        const auto inside = hn::Le(square.v, hn::Set(d, 1.0f));
        if (hn::AllFalse(d, inside)) continue;
        Vector weight[2 * kHalf];
        SectorWeights(x, y, square, weight);
        const std::ptrdiff_t offset = v * run.stride + u;
        for (int side = 0; side < 2; ++side) {
          const std::size_t q = std::size_t(std::ptrdiff_t(p) + (side == 0 ? offset : -offset));
          const auto counts = hn::And(inside, hn::Eq(key, hn::LoadU(d, run.key + q)));
          const Vector dl = hn::Sub(hn::LoadU(d, run.lightness + q), l), da = hn::Sub(hn::LoadU(d, run.a + q), a),
                       db = hn::Sub(hn::LoadU(d, run.b + q), b);
          const Vector length = hn::Add(hn::Add(hn::Mul(dl, dl), hn::Mul(da, da)), hn::Mul(db, db));
          for (int k = 0; k < 2 * kHalf; ++k) {
            const Vector own = hn::IfThenElseZero(counts, weight[side == 0 ? k : k ^ kHalf]);
            if (!hn::AllTrue(d, hn::Eq(own, zero))) AddTo(sectors[k], own, dl, da, db, length);
          }
        }
      }
    }
    StoreMeanOfSectors(sectors, run, p);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {
namespace {

HWY_EXPORT(KuwaharaHere);

// By central differences; across a border of keys nothing changes.
StructureTensor TensorOf(const SmoothPlanes& planes) {
  StructureTensor tensor;
  for (auto* plane : {&tensor.xx, &tensor.xy, &tensor.yy}) plane->resize(planes.width * planes.height);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, planes.height, 16), [&](const auto& part) {
    for (std::size_t y = part.begin(); y != part.end(); ++y) {
      for (std::size_t x = 0; x < planes.width; ++x) {
        const std::size_t p = planes.At(x, y), i = y * planes.width + x;
        const auto beside = [&](std::size_t q) { return planes.key[q] == planes.key[p] ? q : p; };
        const std::size_t left = beside(p - 1), right = beside(p + 1), up = beside(p - planes.stride),
                          down = beside(p + planes.stride);
        float xx = 0.0f, xy = 0.0f, yy = 0.0f;
        for (const auto* plane : {&planes.lightness, &planes.a, &planes.b}) {
          const float dx = (*plane)[right] - (*plane)[left], dy = (*plane)[down] - (*plane)[up];
          xx += dx * dx, xy += dx * dy, yy += dy * dy;
        }
        tensor.xx[i] = xx, tensor.xy[i] = xy, tensor.yy[i] = yy;
      }
    }
  });
  return tensor;
}

}  // namespace

std::size_t KuwaharaPad(double sigma, std::size_t longer_side) {
  return static_cast<std::size_t>(std::min(std::ceil(2.0 * sigma), static_cast<double>(longer_side)));
}

void KuwaharaFilter(double sigma, double tensor_sigma, SmoothPlanes& planes) {
  const EdgeFlow flow =
      FlowOf(TensorOf(planes), static_cast<int>(planes.width), static_cast<int>(planes.height), tensor_sigma);
  planes.MakeNext();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, planes.height, 4), [&](const auto& part) {
    for (std::size_t y = part.begin(); y != part.end(); ++y) {
      const std::size_t row = y * planes.width;
      const KuwaharaRun run{planes.lightness.data(),
                            planes.a.data(),
                            planes.b.data(),
                            planes.key.data(),
                            flow.x.data() + row,
                            flow.y.data() + row,
                            flow.anisotropy.data() + row,
                            planes.next_lightness.data(),
                            planes.next_a.data(),
                            planes.next_b.data(),
                            std::ptrdiff_t(planes.stride),
                            static_cast<int>(planes.pad),
                            static_cast<float>(sigma)};
      HWY_DYNAMIC_DISPATCH(KuwaharaHere)(run, planes.At(0, y), planes.width);
    }
  });
  planes.TakeNext();
}

}  // namespace scumble::internal
#endif
