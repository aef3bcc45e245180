#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "finish/smooth/smooth_filters.h"

namespace scumble::internal {
namespace {

using FourFloats = std::array<float, 4>;
using FourPlane = std::vector<FourFloats, PlaneAllocator<FourFloats>>;
using FourSums = std::array<double, 4>;

// How far each pixel's window goes, in its row and in its column.
struct GuidedWindows {
  std::size_t width, height;
  std::vector<std::uint16_t, PlaneAllocator<std::uint16_t>> left, right, up, down;
  FloatPlane per_count;  // 1 / pixels of the window
};

// One more than beside, up to `most`, where the key goes on.
std::uint16_t CountOn(float key, float beside, std::uint16_t count, std::uint16_t most) {
  return key == beside ? std::min(most, static_cast<std::uint16_t>(count + 1)) : std::uint16_t{0};
}

constexpr std::size_t kStrip = 32;  // columns that are counted side by side

GuidedWindows WindowsOf(const SmoothPlanes& planes, std::uint16_t most) {
  const std::size_t width = planes.width, height = planes.height, pixels = width * height;
  GuidedWindows windows{width, height, {}, {}, {}, {}, {}};
  for (auto* side : {&windows.left, &windows.right, &windows.up, &windows.down}) side->resize(pixels);
  windows.per_count.resize(pixels);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, height, 16), [&](const auto& part) {
    for (std::size_t y = part.begin(); y != part.end(); ++y) {
      const float* const key = planes.key.data() + planes.At(0, y);
      std::uint16_t *const left = windows.left.data() + y * width, *const right = windows.right.data() + y * width;
      left[0] = right[width - 1] = 0;
      for (std::size_t x = 1; x < width; ++x) left[x] = CountOn(key[x], key[x - 1], left[x - 1], most);
      for (std::size_t x = width - 1; x-- > 0;) right[x] = CountOn(key[x], key[x + 1], right[x + 1], most);
    }
  });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, (width + kStrip - 1) / kStrip), [&](const auto& part) {
    std::vector<std::uint32_t> sum((height + 1) * kStrip);
    for (std::size_t strip = part.begin(); strip != part.end(); ++strip) {
      const std::size_t first = strip * kStrip, count = std::min(kStrip, width - first);
      for (std::size_t y = 0; y < height; ++y) {
        const std::size_t i = y * width + first, p = planes.At(first, y);
        for (std::size_t c = 0; c < count; ++c) {
          windows.up[i + c] =
              y == 0 ? std::uint16_t{0}
                     : CountOn(planes.key[p + c], planes.key[p + c - planes.stride], windows.up[i + c - width], most);
          sum[(y + 1) * kStrip + c] = sum[y * kStrip + c] + windows.left[i + c] + windows.right[i + c] + 1u;
        }
      }
      for (std::size_t y = height; y-- > 0;) {
        const std::size_t i = y * width + first, p = planes.At(first, y);
        for (std::size_t c = 0; c < count; ++c) {
          const std::uint16_t down = y + 1 == height ? std::uint16_t{0}
                                                     : CountOn(planes.key[p + c], planes.key[p + c + planes.stride],
                                                               windows.down[i + c + width], most);
          windows.down[i + c] = down;
          windows.per_count[i + c] =
              1.0f / static_cast<float>(sum[(y + down + 1) * kStrip + c] - sum[(y - windows.up[i + c]) * kStrip + c]);
        }
      }
    }
  });
  return windows;
}

constexpr std::size_t kColumns = 4;  // side by side, so that whole cache lines are read

FourFloats Difference(const FourSums& to, const FourSums& from) {
  FourFloats out;
  for (std::size_t c = 0; c < 4; ++c) out[c] = static_cast<float>(to[c] - from[c]);
  return out;
}

void Accumulate(const FourSums& before, const FourFloats& value, FourSums& sum) {
  for (std::size_t c = 0; c < 4; ++c) sum[c] = before[c] + static_cast<double>(value[c]);
}

// The means of four channels over the windows, by sums from the start of each line in doubles: their rounding is far
// below a float's. `value(x, y)` gives the channels of a pixel, `put(x, y, mean)` takes
// the mean.
template <class Value, class Put>
void WindowMeans(const GuidedWindows& windows, FourPlane& by_row, const Value& value, const Put& put) {
  const std::size_t width = windows.width, height = windows.height;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, height, 16), [&](const auto& part) {
    std::vector<FourSums> sum(width + 1);
    for (std::size_t y = part.begin(); y != part.end(); ++y) {
      const std::size_t row = y * width;
      for (std::size_t x = 0; x < width; ++x) Accumulate(sum[x], value(x, y), sum[x + 1]);
      for (std::size_t x = 0; x < width; ++x)
        by_row[row + x] = Difference(sum[x + windows.right[row + x] + 1], sum[x - windows.left[row + x]]);
    }
  });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, (width + kColumns - 1) / kColumns, 8), [&](const auto& part) {
    std::vector<FourSums> sum((height + 1) * kColumns);
    for (std::size_t strip = part.begin(); strip != part.end(); ++strip) {
      const std::size_t first = strip * kColumns, count = std::min(kColumns, width - first);
      for (std::size_t y = 0; y < height; ++y) {
        for (std::size_t c = 0; c < count; ++c)
          Accumulate(sum[y * kColumns + c], by_row[y * width + first + c], sum[(y + 1) * kColumns + c]);
      }
      for (std::size_t y = 0; y < height; ++y) {
        for (std::size_t c = 0; c < count; ++c) {
          const std::size_t i = y * width + first + c;
          FourFloats mean =
              Difference(sum[(y + windows.down[i] + 1) * kColumns + c], sum[(y - windows.up[i]) * kColumns + c]);
          for (float& channel : mean) channel *= windows.per_count[i];
          put(first + c, y, mean);
        }
      }
    }
  });
}

}  // namespace

void GuidedFilter(double sigma, double range, SmoothPlanes& planes) {
  const auto radius = static_cast<std::uint16_t>(std::clamp(std::floor(sigma + 0.5), 1.0, 32767.0));
  const GuidedWindows windows = WindowsOf(planes, radius);
  const auto flat = static_cast<float>(0.25 * range * range);  // the variance of two halves that lie `range` apart
  FourPlane by_row(planes.width * planes.height), line(by_row.size());
  const auto squares = [](float l, float a, float b) { return l * l + a * a + b * b; };
  WindowMeans(
      windows, by_row,
      [&](std::size_t x, std::size_t y) {
        const std::size_t p = planes.At(x, y);
        const float l = planes.lightness[p], a = planes.a[p], b = planes.b[p];
        return FourFloats{l, a, b, squares(l, a, b)};
      },
      [&](std::size_t x, std::size_t y, const FourFloats& mean) {
        const float variance = std::max(0.0f, mean[3] - squares(mean[0], mean[1], mean[2]));
        const float gain = variance / (variance + flat), rest = 1.0f - gain;
        line[y * planes.width + x] = {mean[0] * rest, mean[1] * rest, mean[2] * rest, gain};
      });
  WindowMeans(
      windows, by_row, [&](std::size_t x, std::size_t y) { return line[y * planes.width + x]; },
      [&](std::size_t x, std::size_t y, const FourFloats& mean) {
        const std::size_t p = planes.At(x, y);
        planes.lightness[p] = mean[3] * planes.lightness[p] + mean[0];
        planes.a[p] = mean[3] * planes.a[p] + mean[1];
        planes.b[p] = mean[3] * planes.b[p] + mean[2];
      });
}

}  // namespace scumble::internal
