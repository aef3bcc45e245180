#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/filter/region.h"
#include "finish/area/area_effects.h"
#include "finish/area/gaussian_rows.h"
#include "finish/area/lab_planes.h"
#include "finish/tone/depth_scale.h"

namespace scumble::internal {
namespace {

constexpr double kFinest = 1.0;    // sigma of the finest level, at most, pixels
constexpr double kSmallest = 1.0;  // sigma of a level in its own pixels, at least

// Colours times weights, and the weights.
using WeightedPlanes = std::array<FloatPlane, 4>;

// How the pixels are blurred: sigma in pixels, below 0 before the focus.
FloatPlane SigmasOf(const DepthPass& pass, double most, const FinishFrame& frame) {
  const DepthScale scale(pass, frame.measures);
  const auto depth = frame.guides->Plane(Layer::kDepth);
  FloatPlane sigmas(depth.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, depth.size(), 1 << 14), [&](const auto& part) {
    for (std::size_t i = part.begin(); i != part.end(); ++i) {
      const auto sigma = static_cast<float>(most * scale.Share(depth[i]));
      sigmas[i] = scale.IsBeforeFocus(depth[i]) ? -sigma : sigma;
    }
  });
  return sigmas;
}

// What the levels are made of.
struct BlurSource {
  const LabPlanes& colors;
  const Picture& picture;  // its alpha
  const FloatPlane& sigmas;
  float side;     // 1: beyond the focus, -1: before it
  Region region;  // that holds all pixels on that side
};

// The region under a Gaussian of `sigma`, smaller by `factor` each way. Only pixels count that are blurred by half as
// much or more, on that side of the focus.
struct BlurLevel {
  double sigma = 0.0;
  int factor = 1, left = 0, top = 0, width = 0, height = 0;
  WeightedPlanes planes;
};

void Reduce(const BlurSource& source, BlurLevel& level) {
  const Region& region = source.region;
  const int wide = region.x1 - region.x0, f = level.factor;
  // A little less, so that a pixel of just that sigma counts whatever the rounding.
  const auto least = static_cast<float>(0.499 * level.sigma);
  for (auto& plane : level.planes) plane.assign(std::size_t(level.width) * std::size_t(level.height), 0.0f);
  tbb::parallel_for(tbb::blocked_range<int>(0, level.height, 8), [&](const auto& rows) {
    std::array<std::vector<float>, 4> sums;  // of a row, by column of the picture
    for (auto& sum : sums) sum.resize(std::size_t(wide));
    for (int v = rows.begin(); v != rows.end(); ++v) {
      for (auto& sum : sums) std::fill(sum.begin(), sum.end(), 0.0f);
      for (int y = region.y0 + v * f; y < std::min(region.y1, region.y0 + v * f + f); ++y) {
        const std::size_t first = std::size_t(y) * std::size_t(source.picture.width) + std::size_t(region.x0);
        for (std::size_t x = 0; x < std::size_t(wide); ++x) {
          const std::size_t p = first + x;
          const float alpha = static_cast<float>(source.picture.rgba[4 * p + 3]) * (1.0f / 65535.0f);
          const float weight = source.sigmas[p] * source.side >= least ? alpha : 0.0f;
          sums[0][x] += weight * source.colors.lightness[p];
          sums[1][x] += weight * source.colors.a[p];
          sums[2][x] += weight * source.colors.b[p];
          sums[3][x] += weight;
        }
      }
      for (std::size_t c = 0; c < 4; ++c) {
        float* const out = level.planes[c].data() + std::size_t(v) * std::size_t(level.width);
        for (int x = 0; x < wide; ++x) out[x / f] += sums[c][std::size_t(x)];
      }
    }
  });
}

BlurLevel LevelOf(const BlurSource& source, double sigma) {
  BlurLevel level;
  level.sigma = sigma;
  while (sigma / (2 * level.factor) >= kSmallest) level.factor *= 2;
  const int f = level.factor;
  level.left = source.region.x0, level.top = source.region.y0;
  level.width = (source.region.x1 - level.left + f - 1) / f, level.height = (source.region.y1 - level.top + f - 1) / f;
  Reduce(source, level);
  // Blocks of f pixels, and straight lines between their middles, have a variance of their own.
  const double squared = double(f) * f;
  const double variance = (sigma * sigma - (squared - 1.0) / 12.0 - (f > 1 ? squared / 6.0 : 0.0)) / squared;
  for (auto& plane : level.planes) plane = Blurred(plane, level.width, level.height, std::sqrt(variance));
  return level;
}

// The level's colour at a pixel, by straight lines between its own. False: nothing counts there.
bool ColorAt(const BlurLevel& level, int x, int y, std::array<float, 3>& color) {
  std::array<float, 4> sum{};
  x -= level.left, y -= level.top;
  if (level.factor == 1) {
    const std::size_t q = std::size_t(y) * std::size_t(level.width) + std::size_t(x);
    for (std::size_t c = 0; c < 4; ++c) sum[c] = level.planes[c][q];
  } else {
    const float per_factor = 1.0f / static_cast<float>(level.factor);
    // The level's pixels whose middles lie around; half a pixel above 0 keeps conversion a floor.
    const float u = (static_cast<float>(x) + 0.5f) * per_factor + 0.5f,
                v = (static_cast<float>(y) + 0.5f) * per_factor + 0.5f;
    const int column = static_cast<int>(u), row = static_cast<int>(v);
    const float right = u - static_cast<float>(column), below = v - static_cast<float>(row);
    const std::size_t columns[2] = {std::size_t(std::max(column - 1, 0)),
                                    std::size_t(std::min(column, level.width - 1))};
    const std::size_t rows[2] = {std::size_t(std::max(row - 1, 0)) * std::size_t(level.width),
                                 std::size_t(std::min(row, level.height - 1)) * std::size_t(level.width)};
    for (std::size_t c = 0; c < 4; ++c) {
      const float* const plane = level.planes[c].data();
      const float upper = plane[rows[0] + columns[0]] * (1.0f - right) + plane[rows[0] + columns[1]] * right;
      const float lower = plane[rows[1] + columns[0]] * (1.0f - right) + plane[rows[1] + columns[1]] * right;
      sum[c] = upper * (1.0f - below) + lower * below;
    }
  }
  if (!(sum[3] > 1e-6f)) return false;
  for (std::size_t c = 0; c < 3; ++c) color[c] = sum[c] / sum[3];
  return true;
}

// Blurs the pixels on the source's side of the focus. Between two levels their shares go by variance, so that the
// mean of both has the pixel's own; the level below the first is the picture itself.
void Gather(const BlurSource& source, const std::vector<BlurLevel>& levels, LabPlanes& made) {
  const auto& [given_l, given_a, given_b] = source.colors;
  std::vector<float> variances{0.0f};
  for (const BlurLevel& level : levels) variances.push_back(static_cast<float>(level.sigma * level.sigma));
  tbb::parallel_for(tbb::blocked_range<int>(source.region.y0, source.region.y1, 8), [&](const auto& rows) {
    for (int y = rows.begin(); y != rows.end(); ++y) {
      for (int x = source.region.x0; x < source.region.x1; ++x) {
        const std::size_t p = std::size_t(y) * std::size_t(source.picture.width) + std::size_t(x);
        const float sigma = source.sigmas[p] * source.side, variance = sigma * sigma;
        if (!(sigma > 0.0f)) continue;
        std::size_t above = 1;
        while (above < levels.size() && variance > variances[above]) ++above;
        const float share =
            std::min(1.0f, (variance - variances[above - 1]) / (variances[above] - variances[above - 1]));
        std::array<float, 3> less{given_l[p], given_a[p], given_b[p]}, more;
        if (above > 1 && !ColorAt(levels[above - 2], x, y, less)) continue;
        if (!ColorAt(levels[above - 1], x, y, more)) continue;
        made.lightness[p] = less[0] + share * (more[0] - less[0]);
        made.a[p] = less[1] + share * (more[1] - less[1]);
        made.b[p] = less[2] + share * (more[2] - less[2]);
      }
    }
  });
}

// The smallest region that holds all pixels on that side of the focus.
Region RegionOf(const FloatPlane& sigmas, float side, int width, int height) {
  Region region{width, height, 0, 0};
  for (int y = 0; y < height; ++y) {
    const float* const row = sigmas.data() + std::size_t(y) * std::size_t(width);
    int left = 0, right = width;
    while (left < right && !(row[left] * side > 0.0f)) ++left;
    if (left == right) continue;
    while (!(row[right - 1] * side > 0.0f)) --right;
    region.x0 = std::min(region.x0, left), region.x1 = std::max(region.x1, right);
    region.y0 = std::min(region.y0, y), region.y1 = y + 1;
  }
  return region;
}

}  // namespace

void BlurByDepth(const DepthPass& pass, double strength, std::span<const std::uint8_t> only, const FinishFrame& frame,
                 Picture& picture) {
  const double most = pass.blur * frame.scale;
  int levels = 1;
  while (most > kFinest * double(1 << (levels - 1))) ++levels;
  const FloatPlane sigmas = SigmasOf(pass, most, frame);
  const LabPlanes given = PlanesOf(picture);
  LabPlanes made = given;
  for (const float side : {1.0f, -1.0f}) {
    const Region region = RegionOf(sigmas, side, picture.width, picture.height);
    if (region.x0 >= region.x1) continue;
    const BlurSource source{given, picture, sigmas, side, region};
    std::vector<BlurLevel> pictures;
    for (int k = 1; k <= levels; ++k) pictures.push_back(LevelOf(source, most / double(1 << (levels - k))));
    Gather(source, pictures, made);
  }
  PutPlanes(made, given, strength, only, picture);
}

}  // namespace scumble::internal
