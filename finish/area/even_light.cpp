#include "finish/area/even_light.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "finish/area/even_light.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/filter/vector_lane-inl.h"

#ifndef SCUMBLE_FINISH_EVEN_LIGHT_ONCE_
#define SCUMBLE_FINISH_EVEN_LIGHT_ONCE_
namespace scumble::internal {

// A row, and the rows `step` above and below.
struct RowsAround {
  const float *above, *here, *below;
};

}  // namespace scumble::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace scumble::internal {
namespace HWY_NAMESPACE {

// A value that stands out by more than a quarter of `range` from all around it that are of its object: the nearest of
// them, if they are three or more.
template <class Values>
Values WithoutSpeckHere(const RowsAround& light, const RowsAround& object, std::size_t i, Values own, Values own_object,
                        std::ptrdiff_t step, float range) {
  const Floats d;
  auto count = hn::Zero(d);
  auto least = hn::Set(d, std::numeric_limits<float>::infinity()), most = hn::Neg(least);
  const auto look = [&](const float* row, const float* objects, std::ptrdiff_t shift) HWY_ATTR {
    const auto value = hn::LoadU(d, row + i + shift);
    const auto is_its = hn::Eq(hn::LoadU(d, objects + i + shift), own_object);
    least = hn::IfThenElse(hn::And(is_its, hn::Lt(value, least)), value, least);
    most = hn::IfThenElse(hn::And(is_its, hn::Gt(value, most)), value, most);
    count = hn::Add(count, hn::IfThenElseZero(is_its, hn::Set(d, 1.0f)));
  };
  for (const std::ptrdiff_t shift : {-step, std::ptrdiff_t(0), step}) {
    look(light.above, object.above, shift);
    look(light.below, object.below, shift);
    if (shift != 0) look(light.here, object.here, shift);
  }
  const auto slack = hn::Set(d, 0.25f * range), low = hn::Sub(least, slack), high = hn::Add(most, slack);
  const auto has_some = hn::Ge(count, hn::Set(d, 3.0f));
  own = hn::IfThenElse(hn::And(has_some, hn::Lt(own, low)), least, own);
  return hn::IfThenElse(hn::And(has_some, hn::Gt(own, high)), most, own);
}

// Sums of two pairs at a time, so that a picture that is turned or mirrored gets the same.
void EvenRowHere(const RowsAround& light, const RowsAround& object, std::ptrdiff_t step, bool is_first, float range,
                 std::size_t count, float* out) {
  const Floats d;
  const auto half = hn::Set(d, 0.5f), one = hn::Set(d, 1.0f), most = hn::Set(d, range);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    auto own = hn::LoadU(d, light.here + i);
    const auto own_object = hn::LoadU(d, object.here + i);
    if (is_first) own = WithoutSpeckHere(light, object, i, own, own_object, step, range);
    auto sum = own, weight = one;
    // Of a row and the one opposite, from `shift` pixels to the right of the place and to its left.
    struct Share {
      hn::Vec<Floats> mean, counts;
    };
    const auto share_of = [&](const float* row, const float* objects, const float* other, const float* other_objects,
                              std::ptrdiff_t shift) HWY_ATTR {
      const auto at = [&](const float* values, std::ptrdiff_t by) HWY_ATTR { return hn::LoadU(d, values + i + by); };
      const auto mean = hn::Mul(half, hn::Add(at(row, shift), at(other, -shift)));
      const auto is_its =
          hn::And(hn::Eq(at(objects, shift), own_object), hn::Eq(at(other_objects, -shift), own_object));
      const auto is_near = hn::Le(hn::Abs(hn::Sub(mean, own)), most);
      const auto takes = hn::And(is_its, is_near);
      return Share{hn::IfThenElseZero(takes, mean), hn::IfThenElseZero(takes, one)};
    };
    const auto add = [&](const Share& a, const Share& b) HWY_ATTR {
      sum = hn::Add(sum, hn::Add(a.mean, b.mean));
      weight = hn::Add(weight, hn::Add(a.counts, b.counts));
    };
    add(share_of(light.here, object.here, light.here, object.here, step),
        share_of(light.above, object.above, light.below, object.below, 0));
    add(share_of(light.above, object.above, light.below, object.below, step),
        share_of(light.above, object.above, light.below, object.below, -step));
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

constexpr std::array<int, 3> kSteps = {1, 2, 4};
constexpr int kVector = 16;  // values of a vector, which may reach so far beyond a row

// A plane with `pad` pixels more on all sides.
class PaddedPlane {
 public:
  PaddedPlane(std::span<const float> values, int width, int height, int pad, float outside)
      : pad_(pad), stride_(pad + width + pad + kVector), values_(std::size_t(stride_) * std::size_t(height + 2 * pad)) {
    tbb::parallel_for(tbb::blocked_range<int>(-pad, height + pad, 16), [&](const auto& rows) {
      for (int y = rows.begin(); y != rows.end(); ++y) {
        std::fill_n(Row(y) - pad_, stride_, outside);
        if (y >= 0 && y < height) std::copy_n(values.begin() + std::ptrdiff_t(width) * y, width, Row(y));
      }
    });
  }
  float* Row(int y) { return values_.data() + std::ptrdiff_t(stride_) * (y + pad_) + pad_; }
  const float* Row(int y) const { return values_.data() + std::ptrdiff_t(stride_) * (y + pad_) + pad_; }

 private:
  int pad_, stride_;
  FloatPlane values_;
};

}  // namespace

FloatPlane EvenedLight(std::span<const float> light, std::span<const float> object, int width, int height, float range,
                       int apart) {
  const int pad = kSteps.back() * apart;
  const PaddedPlane objects(object, width, height, pad, std::numeric_limits<float>::quiet_NaN());
  PaddedPlane from(light, width, height, pad, 0.0f), to = from;
  FloatPlane result(light.size());
  for (const int of_samples : kSteps) {
    const int step = of_samples * apart;
    tbb::parallel_for(tbb::blocked_range<int>(0, height, 16), [&](const auto& rows) {
      for (int y = rows.begin(); y != rows.end(); ++y) {
        const auto around = [&](const PaddedPlane& plane) {
          return RowsAround{plane.Row(y - step), plane.Row(y), plane.Row(y + step)};
        };
        HWY_DYNAMIC_DISPATCH(EvenRowHere)
        (around(from), around(objects), step, of_samples == 1, range, std::size_t(width), to.Row(y));
        if (step == pad) std::copy_n(to.Row(y), width, result.begin() + std::ptrdiff_t(width) * y);
      }
    });
    std::swap(from, to);
  }
  return result;
}

}  // namespace scumble::internal
#endif
