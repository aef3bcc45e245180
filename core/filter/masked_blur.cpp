#include "core/filter/masked_blur.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/image/check.h"

namespace scumble::internal {
namespace {

constexpr int kPasses = 4;

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

  // Filters `in` into `out`, both of one length. Samples beyond the ends count as 0.
  void Filter(const std::vector<double>& in, std::vector<double>& out) const {
    const int count = static_cast<int>(in.size());
    const auto at = [&](int i) { return i >= 0 && i < count ? in[std::size_t(i)] : 0.0; };
    double sum = 0.0;
    for (int i = 0; i < std::min(reach, count); ++i) sum += in[std::size_t(i)];
    for (int i = 0; i < count; ++i) {
      sum += at(i + reach) - at(i - reach - 1);
      out[std::size_t(i)] = sum + ends * (at(i - reach - 1) + at(i + reach + 1));
    }
  }
};

struct Plane {
  int width = 0;
  int height = 0;
  std::vector<double> values;
};

// Blurs along x and transposes: two calls make the blur.
Plane BlurRows(const Plane& plane, const ExtendedBox& box) {
  Plane turned{plane.height, plane.width, std::vector<double>(plane.values.size())};
  const int margin = kPasses * (box.reach + 1);  // what a pass carries beyond the end another may bring back
  tbb::parallel_for(0, plane.height, [&](int y) {
    std::vector<double> row(std::size_t(plane.width) + 2 * std::size_t(margin), 0.0), other(row.size());
    std::copy_n(plane.values.begin() + std::ptrdiff_t(y) * plane.width, plane.width, row.begin() + margin);
    for (int pass = 0; pass < kPasses; ++pass) {
      box.Filter(row, other);
      row.swap(other);
    }
    for (int x = 0; x < plane.width; ++x) {
      turned.values[std::size_t(x) * plane.height + y] = row[std::size_t(margin) + x];
    }
  });
  return turned;
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
  const auto blurred = [&](const auto& value) {
    Plane plane{picture.width, picture.height, std::vector<double>(mask.size())};
    for (std::size_t i = 0; i < mask.size(); ++i) plane.values[i] = mask[i] ? value(i) : 0.0;
    return BlurRows(BlurRows(plane, box), box);
  };
  const Plane weight = blurred([](std::size_t) { return 1.0; });
  Picture result(picture.width, picture.height);
  for (int c = 0; c < 4; ++c) {
    const Plane sum = blurred([&](std::size_t i) { return double(Premultiplied(picture.rgba.data() + 4 * i, c)); });
    for (std::size_t i = 0; i < mask.size(); ++i) {
      if (!mask[i]) continue;
      const double mean = std::floor(sum.values[i] / weight.values[i] + 0.5);
      result.rgba[4 * i + c] = static_cast<std::uint16_t>(std::clamp(mean, 0.0, 65535.0));
    }
  }
  return result;
}

}  // namespace scumble::internal
