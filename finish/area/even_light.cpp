#include "finish/area/even_light.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <utility>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "finish/area/even_light.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/filter/vector_lane-inl.h"

#ifndef SCUMBLE_FINISH_EVEN_LIGHT_ONCE_
#define SCUMBLE_FINISH_EVEN_LIGHT_ONCE_
namespace scumble::internal {

// What a pixel is part of: its object, folded to 16 bits, below them the normal's x and y, 8 bits each.
using SurfaceKey = std::uint32_t;
constexpr long kNormalSteps = 127;
// Of normals that may be of one surface, x and y each: up to 14 degrees where they face the eye.
constexpr SurfaceKey kMostNormalSteps = 30;

// A row, and the rows `step` above and below.
template <class Value>
struct RowsAround {
  const Value *above, *here, *below;
};

}  // namespace scumble::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

// Whether keys are of one surface.
HWY_INLINE Choice AreOfOne(hn::Vec<Words> a, hn::Vec<Words> b) {
  const Words d;
#if HWY_TARGET == HWY_SCALAR  // has no vectors of bytes
  const auto are_apart = [&](int low) {
    const int of_a = int(hn::GetLane(a) >> low & 255u), of_b = int(hn::GetLane(b) >> low & 255u);
    return std::abs(of_a - of_b) > int(kMostNormalSteps);
  };
  const bool is_one = (hn::GetLane(a) ^ hn::GetLane(b)) >> 16 == 0 && !are_apart(0) && !are_apart(8);
  const auto beyond = hn::Set(d, is_one ? 0u : 1u);
#else
  const hn::Repartition<std::uint8_t, Words> bytes;
  const auto of_a = hn::BitCast(bytes, a), of_b = hn::BitCast(bytes, b);
  const auto apart = hn::Or(hn::SaturatedSub(of_a, of_b), hn::SaturatedSub(of_b, of_a));
  const auto most = hn::BitCast(bytes, hn::Set(d, kMostNormalSteps << 8 | kMostNormalSteps));
  const auto beyond = hn::BitCast(d, hn::SaturatedSub(apart, most));
#endif
  return hn::RebindMask(Floats(), hn::Eq(beyond, hn::Zero(d)));
}

// A value that stands out by more than a quarter of `range` from all around it that are of its surface: the nearest of
// them, if they are three or more.
template <class Values>
HWY_INLINE Values WithoutSpeckHere(const RowsAround<float>& light, const RowsAround<SurfaceKey>& surface, std::size_t i,
                                   Values own, std::ptrdiff_t step, float range) {
  const Floats d;
  const auto own_key = hn::LoadU(Words(), surface.here + i);
  auto count = hn::Zero(d);
  auto least = hn::Set(d, std::numeric_limits<float>::infinity()), most = hn::Neg(least);
  const auto look = [&](const float* row, const SurfaceKey* keys, std::ptrdiff_t shift) HWY_ATTR {
    const auto value = hn::LoadU(d, row + i + shift);
    // Outside of the picture there is no number, and it is equal to none.
    const auto is_its = hn::And(AreOfOne(hn::LoadU(Words(), keys + i + shift), own_key), hn::Eq(value, value));
    least = hn::IfThenElse(hn::And(is_its, hn::Lt(value, least)), value, least);
    most = hn::IfThenElse(hn::And(is_its, hn::Gt(value, most)), value, most);
    count = hn::Add(count, hn::IfThenElseZero(is_its, hn::Set(d, 1.0f)));
  };
  for (const std::ptrdiff_t shift : {-step, std::ptrdiff_t(0), step}) {
    look(light.above, surface.above, shift);
    look(light.below, surface.below, shift);
    if (shift != 0) look(light.here, surface.here, shift);
  }
  const auto slack = hn::Set(d, 0.25f * range), low = hn::Sub(least, slack), high = hn::Add(most, slack);
  const auto has_some = hn::Ge(count, hn::Set(d, 3.0f));
  own = hn::IfThenElse(hn::And(has_some, hn::Lt(own, low)), least, own);
  return hn::IfThenElse(hn::And(has_some, hn::Gt(own, high)), most, own);
}

// Sums of two pairs at a time, so that a picture that is turned or mirrored gets the same.
void EvenRowHere(const RowsAround<float>& light, const RowsAround<SurfaceKey>& surface, std::ptrdiff_t step,
                 bool is_first, float range, std::size_t count, float* out) {
  const Floats d;
  const Words words;
  const auto half = hn::Set(d, 0.5f), one = hn::Set(d, 1.0f), most = hn::Set(d, range);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    auto own = hn::LoadU(d, light.here + i);
    const auto own_key = hn::LoadU(words, surface.here + i);
    if (is_first) own = WithoutSpeckHere(light, surface, i, own, step, range);
    auto sum = own, weight = one;  // of the pixel, as of a pair beside it
    // Of a row and the one opposite, from `shift` pixels to the right of the place and to its left.
    struct Share {
      hn::Vec<Floats> mean, counts;
    };
    const auto share_of = [&](const float* row, const SurfaceKey* keys, const float* other,
                              const SurfaceKey* other_keys, std::ptrdiff_t shift) HWY_ATTR {
      const auto mean = hn::Mul(half, hn::Add(hn::LoadU(d, row + i + shift), hn::LoadU(d, other + i - shift)));
      const auto is_its = hn::And(AreOfOne(hn::LoadU(words, keys + i + shift), own_key),
                                  AreOfOne(hn::LoadU(words, other_keys + i - shift), own_key));
      const auto takes = hn::And(is_its, hn::Le(hn::Abs(hn::Sub(mean, own)), most));
      return Share{hn::IfThenElseZero(takes, mean), hn::IfThenElseZero(takes, one)};
    };
    const auto add = [&](float each, const Share& a, const Share& b) HWY_ATTR {
      sum = hn::Add(sum, hn::Mul(hn::Set(d, each), hn::Add(a.mean, b.mean)));
      weight = hn::Add(weight, hn::Mul(hn::Set(d, each), hn::Add(a.counts, b.counts)));
    };
    add(1.0f, share_of(light.here, surface.here, light.here, surface.here, step),
        share_of(light.above, surface.above, light.below, surface.below, 0));
    add(0.5f, share_of(light.above, surface.above, light.below, surface.below, step),
        share_of(light.above, surface.above, light.below, surface.below, -step));
    hn::StoreU(hn::Div(sum, weight), d, out + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace scumble::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scumble::internal {
namespace {

HWY_EXPORT(EvenRowHere);

constexpr std::array<int, 5> kSteps = {1, 2, 4, 8, 16};
constexpr int kNear = 4;     // steps up to this one have the whole range
constexpr int kVector = 16;  // values of a vector, which may reach so far beyond a row

// Calls row(y) from several threads.
template <class Row>
void ForEachEvenRow(int first, int last, const Row& row) {
  tbb::parallel_for(tbb::blocked_range<int>(first, last, 16), [&](const auto& rows) {
    for (int y = rows.begin(); y != rows.end(); ++y) row(y);
  });
}

// A plane with `pad` pixels more on all sides.
template <class Value>
class PaddedPlane {
 public:
  // `fill` writes a row of the picture.
  template <class Fill>
  PaddedPlane(int width, int height, int pad, Value outside, const Fill& fill)
      : pad_(pad), stride_(pad + width + pad + kVector), values_(std::size_t(stride_) * std::size_t(height + 2 * pad)) {
    ForEachEvenRow(-pad, height + pad, [&](int y) {
      std::fill_n(Row(y) - pad_, stride_, outside);
      if (y >= 0 && y < height) fill(y, Row(y));
    });
  }
  Value* Row(int y) { return values_.data() + std::ptrdiff_t(stride_) * (y + pad_) + pad_; }
  const Value* Row(int y) const { return values_.data() + std::ptrdiff_t(stride_) * (y + pad_) + pad_; }
  RowsAround<Value> Around(int y, int step) const { return {Row(y - step), Row(y), Row(y + step)}; }

 private:
  int pad_, stride_;
  std::vector<Value, PlaneAllocator<Value>> values_;
};

SurfaceKey KeyOf(float object, float normal_x, float normal_y) {
  const auto bits = std::bit_cast<std::uint32_t>(object) * 2654435761u;  // Knuth's multiplicative hash
  const auto steps = [](float x) {
    const float inside = std::isfinite(x) ? std::clamp(x, -1.0f, 1.0f) : 0.0f;
    return static_cast<SurfaceKey>(kNormalSteps + std::lround(inside * float(kNormalSteps)));  // mirrored alike
  };
  return (bits >> 16) << 16 | steps(normal_x) << 8 | steps(normal_y);
}

}  // namespace

FloatPlane EvenedLight(std::span<const float> light, const LitSurface& surface, int width, int height, float range,
                       int apart) {
  const int pad = kSteps.back() * apart;
  const auto columns = static_cast<std::size_t>(width);
  const PaddedPlane<SurfaceKey> keys(width, height, pad, 0, [&](int y, SurfaceKey* row) {
    const std::size_t first = std::size_t(y) * columns;
    for (std::size_t x = 0; x < columns; ++x) {
      const bool has_normals = !surface.normal_x.empty();
      row[x] = KeyOf(surface.object[first + x], has_normals ? surface.normal_x[first + x] : 0.0f,
                     has_normals ? surface.normal_y[first + x] : 0.0f);
    }
  });
  constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
  const auto given = [&](int y, float* row) { std::copy_n(light.begin() + std::ptrdiff_t(columns) * y, columns, row); };
  PaddedPlane<float> from(width, height, pad, kNothing, given), to(width, height, pad, kNothing, [](int, float*) {});
  FloatPlane result(light.size());
  for (const int of_samples : kSteps) {
    const int step = of_samples * apart;
    ForEachEvenRow(0, height, [&](int y) {
      HWY_DYNAMIC_DISPATCH(EvenRowHere)
      (from.Around(y, step), keys.Around(y, step), step, of_samples == 1,
       of_samples > kNear ? range / static_cast<float>(of_samples) : range, columns, to.Row(y));
      std::fill_n(to.Row(y) + columns, kVector, kNothing);  // what a vector has written beyond the row
      if (step == pad) std::copy_n(to.Row(y), columns, result.begin() + std::ptrdiff_t(columns) * y);
    });
    std::swap(from, to);
  }
  return result;
}

float LightNoiseOf(const GuideSet& guides) {
  return std::clamp(3.0f * static_cast<float>(LightErrorOf(guides)), kLightNoise, kMostLightNoise);
}

LitSurface LitSurfaceOf(const GuideSet& guides) {
  return {guides.Plane(Layer::kObject), guides.Plane(Layer::kNormal, 0), guides.Plane(Layer::kNormal, 1)};
}

}  // namespace scumble::internal
#endif
