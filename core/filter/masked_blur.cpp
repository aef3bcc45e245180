#include "core/filter/masked_blur.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "core/image/check.h"

namespace scumble::internal {
namespace {

constexpr int kPasses = 4;
constexpr int kLanes = 8;  // rows that are filtered side by side: each depends on its own last sum alone

// Weights 1 on 2·reach + 1 samples and `ends` on one more at either side. Unscaled, because the blur is a quotient.
struct ExtendedBox {
  int reach = 0;
  double ends = 0.0;

  explicit ExtendedBox(double sigma) {
    const double variance = sigma * sigma / kPasses;  // of one pass
    reach = static_cast<int>(std::floor(0.5 * (std::sqrt(12.0 * variance + 1.0) - 1.0)));
    const double l = reach;
    ends = (2.0 * l + 1.0) * (3.0 * variance - l * (l + 1.0)) / (6.0 * ((l + 1.0) * (l + 1.0) - variance));
  }

  // Filters `in` into `out`, both kLanes rows of `count` samples side by side, with `reach + 1` zeros before and after.
  // Each row is summed in the same order as alone.
  void Filter(const std::vector<double>& in, int count, std::vector<double>& out) const {
    const std::ptrdiff_t edge = std::ptrdiff_t(reach + 1) * kLanes, far = std::ptrdiff_t(reach) * kLanes;
    std::array<double, kLanes> sum{};
    for (int i = 0; i < std::min(reach, count); ++i) {
      for (int lane = 0; lane < kLanes; ++lane) sum[lane] += in[std::size_t(edge + i * kLanes + lane)];
    }
    const double* from = in.data() + edge;
    double* to = out.data() + edge;
    for (int i = 0; i < count; ++i, from += kLanes, to += kLanes) {
      for (int lane = 0; lane < kLanes; ++lane) {
        sum[lane] += from[far + lane] - from[lane - edge];
        to[lane] = sum[lane] + ends * (from[lane - edge] + from[lane + edge]);
      }
    }
  }
};

struct Plane {
  int width = 0;
  int height = 0;
  std::unique_ptr<double[]> values;

  Plane(int w, int h)
      : width(w), height(h), values(std::make_unique_for_overwrite<double[]>(std::size_t(w) * std::size_t(h))) {}
};

// Blurs along x and transposes into `turned`: two calls make the blur.
void BlurRows(const Plane& plane, const ExtendedBox& box, const Plane& turned) {
  const int margin = kPasses * (box.reach + 1);  // what a pass carries beyond the end another may bring back
  const int count = plane.width + 2 * margin, groups = (plane.height + kLanes - 1) / kLanes;
  tbb::parallel_for(0, groups, [&](int group) {
    const int first = group * kLanes, rows = std::min(kLanes, plane.height - first);
    std::vector<double> line((std::size_t(count) + 2 * std::size_t(box.reach + 1)) * kLanes, 0.0), other(line.size());
    const std::size_t begin = (std::size_t(box.reach + 1) + std::size_t(margin)) * kLanes;
    for (int lane = 0; lane < rows; ++lane) {
      const double* row = plane.values.get() + std::size_t(first + lane) * plane.width;
      for (int x = 0; x < plane.width; ++x) line[begin + std::size_t(x) * kLanes + lane] = row[x];
    }
    for (int pass = 0; pass < kPasses; ++pass) {
      box.Filter(line, count, other);
      line.swap(other);
    }
    const double* from = line.data() + begin;
    double* to = turned.values.get() + first;
    for (int x = 0; x < plane.width; ++x, from += kLanes, to += plane.height) {
      if (rows == kLanes) {
        std::copy_n(from, kLanes, to);
      } else {
        std::copy_n(from, rows, to);
      }
    }
  });
}

// Calls `visit` with the place of each pixel, rows in parallel.
template <class Visit>
void ForEachPixel(const Picture& picture, const Visit& visit) {
  constexpr int kRows = 64;  // of one task
  const tbb::blocked_range<int> rows(0, picture.height, kRows);
  const auto visit_rows = [&](const tbb::blocked_range<int>& some) {
    const std::size_t begin = std::size_t(some.begin()) * picture.width, end = std::size_t(some.end()) * picture.width;
    for (std::size_t i = begin; i < end; ++i) visit(i);
  };
  tbb::parallel_for(rows, visit_rows, tbb::simple_partitioner());
}

Picture MaskedMean(const Picture& picture, std::span<const std::uint8_t> mask) {
  std::uint64_t sums[4] = {0, 0, 0, 0}, count = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (!mask[i]) continue;
    for (int c = 0; c < 4; ++c) sums[c] += Premultiplied(picture.rgba.data() + 4 * i, c);
    ++count;
  }
  Picture mean(picture.width, picture.height);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (!mask[i]) continue;
    for (int c = 0; c < 4; ++c) mean.rgba[4 * i + c] = static_cast<std::uint16_t>((sums[c] + count / 2) / count);
  }
  return mean;
}

}  // namespace

Picture MaskedBlur(const Picture& picture, std::span<const std::uint8_t> mask, double sigma) {
  SCUMBLE_CHECK_EQ(mask.size(), std::size_t(picture.width) * picture.height);
  SCUMBLE_CHECK(sigma > 0.0);
  if (sigma >= std::max(picture.width, picture.height)) return MaskedMean(picture, mask);
  const ExtendedBox box(sigma);
  Plane plane(picture.width, picture.height), turned(picture.height, picture.width);
  const Plane weight(picture.width, picture.height);
  // Blurs the value of each masked pixel into `to`.
  const auto blur = [&](const auto& value, const Plane& to) {
    ForEachPixel(picture, [&](std::size_t i) { plane.values[i] = mask[i] ? value(i) : 0.0; });
    BlurRows(plane, box, turned);
    BlurRows(turned, box, to);
  };
  blur([](std::size_t) { return 1.0; }, weight);
  bool is_opaque = true;  // then so is the mean
  for (std::size_t i = 0; i < mask.size(); ++i) is_opaque = is_opaque && (!mask[i] || picture.rgba[4 * i + 3] == 65535);
  Picture result(picture.width, picture.height);
  for (int c = 0; c < 4; ++c) {
    const bool is_known = c == 3 && is_opaque;
    if (!is_known) blur([&](std::size_t i) { return double(Premultiplied(picture.rgba.data() + 4 * i, c)); }, plane);
    ForEachPixel(picture, [&](std::size_t i) {
      if (!mask[i]) return;
      const double mean = is_known ? 65535.0 : std::floor(plane.values[i] / weight.values[i] + 0.5);
      result.rgba[4 * i + c] = static_cast<std::uint16_t>(std::clamp(mean, 0.0, 65535.0));
    });
  }
  return result;
}

}  // namespace scumble::internal
