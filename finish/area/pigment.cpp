#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/filter/distance_transform.h"
#include "core/image/exact_math.h"
#include "core/image/hash.h"
#include "finish/area/area_effects.h"
#include "finish/area/noise.h"

namespace scumble::internal {
namespace {

// x e^(1 - x): 0 at a border, 1 at x = 1.
float Rim(double x) { return static_cast<float>(x * Exp2((1.0 - x) * kLog2OfE)); }

// From this x on Rim is below 3e-9: not even four times as much changes a density of 1.
constexpr double kRimEnd = 24.0;

// Rim of the distance over half the width, by the distance's square, which is whole.
class RimTable {
 public:
  explicit RimTable(double width) : per_half_(2.0 / width) {
    constexpr double kMost = 1 << 16;
    const double last = kRimEnd / per_half_;
    rims_.resize(static_cast<std::size_t>(std::min(last * last, kMost)) + 1);
    for (std::size_t i = 0; i < rims_.size(); ++i) rims_[i] = Exactly(static_cast<double>(i));
  }
  float At(std::int64_t square) const {
    return static_cast<std::size_t>(square) < rims_.size() ? rims_[static_cast<std::size_t>(square)]
                                                           : Exactly(static_cast<double>(square));
  }

 private:
  float Exactly(double square) const {
    const double x = (std::sqrt(square) + 0.5) * per_half_;  // the border itself lies half a pixel beyond its pixels
    return x < kRimEnd ? Rim(x) : 0.0f;
  }
  double per_half_;
  std::vector<float> rims_;
};

// By pixel of an object: how near its border is, by Rim of the distance over half the width.
FloatPlane RimsOf(double width, const GuideSet& guides) {
  const auto coverage = guides.Plane(Layer::kCoverage), object = guides.Plane(Layer::kObject);
  const int wide = guides.width(), high = guides.height();
  const auto shape_of = [&](std::size_t p) { return coverage[p] > 0.0f ? object[p] : -1.0f; };
  const auto is_border = [&](std::size_t p) {
    const int x = static_cast<int>(p % std::size_t(wide)), y = static_cast<int>(p / std::size_t(wide));
    const float shape = shape_of(p);
    return (x > 0 && shape_of(p - 1) != shape) || (x + 1 < wide && shape_of(p + 1) != shape) ||
           (y > 0 && shape_of(p - std::size_t(wide)) != shape) ||
           (y + 1 < high && shape_of(p + std::size_t(wide)) != shape);
  };
  FloatPlane rims(guides.pixel_count(), 0.0f);
  const RimTable table(width);
  ForNearestFeature(wide, high, is_border, [&](std::size_t p, int x, int y, int u, int v) {
    if (!(coverage[p] > 0.0f)) return;
    const std::int64_t across = x - u, down = y - v;
    rims[p] = table.At(across * across + down * down);
  });
  return rims;
}

// Three octaves, -1 … 1.
class Clouds {
 public:
  // `size`: of the largest.
  Clouds(double size, std::uint64_t seed, const SurfaceScale* surface, int width, int height)
      : large_(Hash(seed, 5, 0), size, surface, width, height),
        middle_(Hash(seed, 5, 1), size / 2.0, surface, width, height),
        small_(Hash(seed, 5, 2), size / 4.0, surface, width, height) {}
  float At(int x, int y) const { return (large_.At(x, y) + 0.5f * middle_.At(x, y) + 0.25f * small_.At(x, y)) / 1.75f; }

 private:
  NoiseField large_, middle_, small_;
};

// C (1 - (1 - C) (density - 1)).
std::uint16_t Pigmented(std::uint16_t code, float density) {
  const float color = static_cast<float>(code) / 65535.0f;
  const float made = color * (1.0f - (1.0f - color) * (density - 1.0f));
  return static_cast<std::uint16_t>(std::clamp(made, 0.0f, 1.0f) * 65535.0f + 0.5f);
}

void LayPigment(const PigmentPass& pass, float strength, std::span<const std::uint8_t> only, const FinishFrame& frame,
                Picture& picture) {
  const int width = picture.width, height = picture.height;
  FloatPlane rims;
  if (pass.edge > 0.0) rims = RimsOf(pass.edge_width * frame.scale, *frame.guides);
  std::optional<SurfaceScale> surface;
  if (pass.stick) surface.emplace(*frame.guides);
  const Clouds clouds(pass.turbulence_size * frame.scale, frame.seed, surface ? &*surface : nullptr, width, height);
  const NoiseField grains(Hash(frame.seed, 6), pass.grain_size * frame.scale, nullptr, width, height);
  const auto edge = static_cast<float>(pass.edge), turbulence = static_cast<float>(pass.turbulence),
             granulation = static_cast<float>(pass.granulation), thin = static_cast<float>(pass.thin);
  tbb::parallel_for(tbb::blocked_range<int>(0, height, 8), [&](const auto& rows) {
    for (int y = rows.begin(); y != rows.end(); ++y) {
      for (int x = 0; x < width; ++x) {
        const std::size_t p = std::size_t(y) * std::size_t(width) + std::size_t(x);
        std::uint16_t* const texel = picture.rgba.data() + 4 * p;
        if (texel[3] == 0 || (!only.empty() && !only[p])) continue;
        float density = 1.0f;
        if (!rims.empty()) density *= 1.0f + edge * rims[p];
        if (turbulence > 0.0f) density *= std::max(0.0f, 1.0f + turbulence * clouds.At(x, y));
        if (granulation > 0.0f) density *= std::max(0.0f, 1.0f + granulation * grains.At(x, y));
        if (thin > 0.0f) {
          const unsigned lightest = std::max({texel[0], texel[1], texel[2]});
          density *= 1.0f - thin * static_cast<float>(lightest) / 65535.0f;
        }
        density = 1.0f + (density - 1.0f) * strength;
        for (int c = 0; c < 3; ++c) texel[c] = Pigmented(texel[c], density);
      }
    }
  });
}

// std::floor, which on the least instruction set is a call. Of |x| below 2^31.
float FloorOf(float x) {
  const auto whole = static_cast<float>(static_cast<int>(x));
  return whole > x ? whole - 1.0f : whole;
}

// The picture at a place between pixels, by straight lines, alpha first. Beyond the edges its last pixels go on.
void TexelAt(const std::uint16_t* texels, int width, int height, float x, float y, std::uint16_t* texel) {
  const float left = FloorOf(x - 0.5f), top = FloorOf(y - 0.5f);
  float color[3] = {0.0f, 0.0f, 0.0f}, alpha = 0.0f;
  for (int dy = 0; dy < 2; ++dy) {
    for (int dx = 0; dx < 2; ++dx) {
      const float u = x - 0.5f - left, v = y - 0.5f - top;
      const int column = std::clamp(static_cast<int>(left) + dx, 0, width - 1);
      const int row = std::clamp(static_cast<int>(top) + dy, 0, height - 1);
      const std::uint16_t* const one = texels + 4 * (std::size_t(row) * std::size_t(width) + std::size_t(column));
      const float share = (dx ? u : 1.0f - u) * (dy ? v : 1.0f - v) * static_cast<float>(one[3]);
      alpha += share;
      for (int c = 0; c < 3; ++c) color[c] += share * static_cast<float>(one[c]);
    }
  }
  texel[3] = static_cast<std::uint16_t>(std::min(65535.0f, alpha + 0.5f));
  if (!(alpha > 0.0f)) return;
  for (int c = 0; c < 3; ++c) texel[c] = static_cast<std::uint16_t>(std::min(65535.0f, color[c] / alpha + 0.5f));
}

void Tremble(const PigmentPass& pass, float strength, std::span<const std::uint8_t> only, const FinishFrame& frame,
             Picture& picture) {
  std::vector<std::uint16_t, PlaneAllocator<std::uint16_t>> still(picture.rgba.size());
  std::copy(picture.rgba.begin(), picture.rgba.end(), still.begin());
  const int width = picture.width, height = picture.height;
  const double size = pass.tremor_size * frame.scale;
  const NoiseField across(Hash(frame.seed, 7, 0), size, nullptr, width, height);
  const NoiseField down(Hash(frame.seed, 7, 1), size, nullptr, width, height);
  const float reach = static_cast<float>(pass.tremor * frame.scale) * strength;
  tbb::parallel_for(tbb::blocked_range<int>(0, height, 8), [&](const auto& rows) {
    for (int y = rows.begin(); y != rows.end(); ++y) {
      for (int x = 0; x < width; ++x) {
        if (!only.empty() && !only[std::size_t(y) * std::size_t(width) + std::size_t(x)]) continue;
        TexelAt(still.data(), width, height, static_cast<float>(x) + 0.5f + reach * across.At(x, y),
                static_cast<float>(y) + 0.5f + reach * down.At(x, y), picture.At(x, y));
      }
    }
  });
}

}  // namespace

void Pigment(const PigmentPass& pass, double strength, std::span<const std::uint8_t> only, const FinishFrame& frame,
             Picture& picture) {
  LayPigment(pass, static_cast<float>(strength), only, frame, picture);
  if (pass.tremor > 0.0) Tremble(pass, static_cast<float>(strength), only, frame, picture);
}

}  // namespace scumble::internal
