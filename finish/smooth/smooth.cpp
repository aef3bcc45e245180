#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>

#include "finish/area/oklab_blocks.h"
#include "finish/smooth/smooth_filters.h"

namespace scumble::internal {
namespace {

constexpr std::size_t kSpare = 16;  // places beyond a row that a vector may reach

// Calls row(y), from several threads.
template <class Row>
void ForEachSmoothRow(std::size_t height, const Row& row) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, height, 16), [&](const auto& part) {
    for (std::size_t y = part.begin(); y != part.end(); ++y) row(y);
  });
}

// The size of a plane laid out like these, filled by several threads.
FloatPlane FilledPlane(const SmoothPlanes& planes, float value) {
  const std::size_t rows = planes.height + 2 * planes.pad;
  FloatPlane plane(planes.stride * rows + kSpare);
  ForEachSmoothRow(rows, [&](std::size_t y) {
    std::fill_n(plane.data() + y * planes.stride, planes.stride + (y + 1 == rows ? kSpare : 0), value);
  });
  return plane;
}

// At least one place, which MixAtBorders looks at.
std::size_t SmoothPad(SmoothPass::Filter filter, double sigma, std::size_t longer_side) {
  std::size_t pad = 0;
  switch (filter) {
    case SmoothPass::Filter::kBilateral:
      pad = BilateralPad(sigma, longer_side);
      break;
    case SmoothPass::Filter::kKuwahara:
      pad = KuwaharaPad(sigma, longer_side);
      break;
    case SmoothPass::Filter::kWavelets:
      pad = WaveletsPad(sigma, longer_side);
      break;
    case SmoothPass::Filter::kGuided:
      break;
  }
  return std::max<std::size_t>(pad, 1);
}

// Calls visit(first, place, count) for the blocks of a row: the picture's pixel, the planes' place, and how many.
template <class Visit>
void ForEachBlockOf(const SmoothPlanes& planes, std::size_t y, const Visit& visit) {
  for (std::size_t x = 0; x < planes.width; x += kOklabBlock)
    visit(y * planes.width + x, planes.At(x, y), std::min(kOklabBlock, planes.width - x));
}

SmoothPlanes SmoothPlanesOf(const Picture& picture, std::span<const float> object, std::size_t pad) {
  SmoothPlanes planes(static_cast<std::size_t>(picture.width), static_cast<std::size_t>(picture.height), pad);
  ForEachSmoothRow(planes.height, [&](std::size_t y) {
    ForEachBlockOf(planes, y, [&](std::size_t first, std::size_t place, std::size_t count) {
      OklabBlock block;
      OklabFromTexels(picture.rgba.data() + 4 * first, count, block);
      std::copy_n(block.lightness.begin(), count, planes.lightness.data() + place);
      std::copy_n(block.a.begin(), count, planes.a.data() + place);
      std::copy_n(block.b.begin(), count, planes.b.data() + place);
      for (std::size_t i = 0; i < count; ++i) {
        if (picture.rgba[4 * (first + i) + 3] != 0) planes.key[place + i] = object.empty() ? 0.0f : object[first + i];
      }
    });
  });
  return planes;
}

// A plane of the guides, laid out as the planes. What is not finite, the depth of nothing, becomes 0.
FloatPlane LaidOut(std::span<const float> plane, const SmoothPlanes& planes) {
  FloatPlane out = FilledPlane(planes, 0.0f);
  ForEachSmoothRow(planes.height, [&](std::size_t y) {
    for (std::size_t x = 0; x < planes.width; ++x) {
      const float value = plane[y * planes.width + x];
      out[planes.At(x, y)] = std::isfinite(value) ? value : 0.0f;
    }
  });
  return out;
}

// Neighbours that a speck must be unlike: of two pixels by themselves neither is one.
constexpr float kLeastAround = 3.0f;

// Filters that weigh by difference leave a pixel that is unlike all of its neighbours as it is, pass after pass, and a
// pair of pixels likewise. Here they take the mean of those around. A pass may even out a pixel's like neighbours and
// so leave it alone. Colours are unlike from a distance d with d² · per_square = 1 on.
void FillLonePixels(float per_square, SmoothPlanes& planes) {
  const auto stride = static_cast<std::ptrdiff_t>(planes.stride);
  const auto color_at = [&](std::size_t p) { return glm::vec3(planes.lightness[p], planes.a[p], planes.b[p]); };
  const auto is_like = [&](const glm::vec3& one, const glm::vec3& other) {
    const glm::vec3 off = other - one;
    return glm::dot(off, off) * per_square < 1.0f;
  };
  const auto has_other_like = [&](std::size_t p, std::size_t known) {
    const glm::vec3 color = color_at(p);
    for (const std::ptrdiff_t to : {std::ptrdiff_t{1}, stride - 1, stride, stride + 1}) {
      for (const std::ptrdiff_t offset : {-to, to}) {
        const std::size_t q = std::size_t(std::ptrdiff_t(p) + offset);
        if (q != known && planes.key[q] == planes.key[p] && is_like(color, color_at(q))) return true;
      }
    }
    return false;
  };
  planes.MakeNext();
  ForEachSmoothRow(planes.height, [&](std::size_t y) {
    for (std::size_t x = 0; x < planes.width; ++x) {
      const std::size_t p = planes.At(x, y);
      glm::vec3 color = color_at(p);
      float found = 0.0f;
      int likes = 0;
      std::size_t like = p;
      // By pairs: the sum is that of the turned picture.
      const auto pair = [&](std::ptrdiff_t to) {
        glm::vec3 sum(0.0f);
        for (const std::ptrdiff_t offset : {-to, to}) {
          const std::size_t q = std::size_t(std::ptrdiff_t(p) + offset);
          if (planes.key[q] != planes.key[p]) continue;
          const glm::vec3 other = color_at(q);
          if (is_like(color, other)) {
            ++likes, like = q;
          } else {
            sum += other, found += 1.0f;
          }
        }
        return sum;
      };
      const glm::vec3 straight = pair(1) + pair(stride);
      if (likes < 2) {  // as it rarely is, the other neighbours need not be looked at
        const glm::vec3 sum = straight + (pair(stride - 1) + pair(stride + 1));
        const bool is_alone = likes == 0 || (likes == 1 && !has_other_like(like, p));
        if (is_alone && found >= kLeastAround) color = sum / found;
      }
      planes.next_lightness[p] = color.x, planes.next_a[p] = color.y, planes.next_b[p] = color.z;
    }
  });
  planes.TakeNext();
}

// A pixel at an object's border may show some of its neighbour, and what is smoothed has only its own. So it takes the
// neighbours' smoothed colour by the share that the given colour has of it, half at most. Borders are not jagged then.
void MixAtBorders(const SmoothPlanes& planes, std::size_t place, std::size_t count, const OklabBlock& given,
                  OklabBlock& block) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t p = place + i;
    float found = 0.0f;
    const auto other = [&](std::size_t q) {
      if (planes.key[q] == planes.key[p] || std::isnan(planes.key[q])) return glm::vec3(0.0f);
      found += 1.0f;
      return glm::vec3(planes.lightness[q], planes.a[q], planes.b[q]);
    };
    // By pairs: the sum is that of the turned picture.
    const glm::vec3 others = (other(p - 1) + other(p + 1)) + (other(p - planes.stride) + other(p + planes.stride));
    if (found == 0.0f) continue;
    const glm::vec3 own(block.lightness[i], block.a[i], block.b[i]), way = others / found - own;
    const float square = glm::dot(way, way);
    if (!(square > 0.0f)) continue;
    const glm::vec3 off = glm::vec3(given.lightness[i], given.a[i], given.b[i]) - own;
    const float share = std::clamp(glm::dot(off, way) / square, 0.0f, 0.5f);
    block.lightness[i] += share * way.x, block.a[i] += share * way.y, block.b[i] += share * way.z;
  }
}

// Pixels of alpha 0, those outside `only`, and those whose colour did not change keep their bits.
void PutSmoothed(const SmoothPlanes& planes, double strength, std::span<const std::uint8_t> only, Picture& picture) {
  ForEachSmoothRow(planes.height, [&](std::size_t y) {
    ForEachBlockOf(planes, y, [&](std::size_t first, std::size_t place, std::size_t count) {
      std::uint16_t* const texels = picture.rgba.data() + 4 * first;
      OklabBlock given, block;
      OklabFromTexels(texels, count, given);
      std::copy_n(planes.lightness.data() + place, count, block.lightness.begin());
      std::copy_n(planes.a.data() + place, count, block.a.begin());
      std::copy_n(planes.b.data() + place, count, block.b.begin());
      MixAtBorders(planes, place, count, given, block);
      PutBlock(given, static_cast<float>(strength), only.empty() ? nullptr : only.data() + first, count, block, texels);
    });
  });
}

}  // namespace

SmoothPlanes::SmoothPlanes(std::size_t columns, std::size_t rows, std::size_t around)
    : width(columns), height(rows), pad(around) {
  stride = (width + 2 * pad + kSpare + kSpare - 1) / kSpare * kSpare;
  for (FloatPlane* const plane : {&lightness, &a, &b}) *plane = FilledPlane(*this, 0.0f);
  key = FilledPlane(*this, std::numeric_limits<float>::quiet_NaN());
}

void SmoothPlanes::MakeNext() {
  for (FloatPlane* const plane : {&next_lightness, &next_a, &next_b}) {
    if (plane->empty()) *plane = FilledPlane(*this, 0.0f);
  }
}

void SmoothPlanes::TakeNext() { lightness.swap(next_lightness), a.swap(next_a), b.swap(next_b); }

float BiweightPerSquare(double half) {
  return static_cast<float>(0.2928932188134524 / (half * half));  // a half at d = 0.5412 c
}

void Smooth(const SmoothPass& pass, double strength, std::span<const std::uint8_t> only, const FinishFrame& frame,
            Picture& picture) {
  const double sigma = pass.radius * frame.scale;
  const auto longer_side = static_cast<std::size_t>(std::max(picture.width, picture.height));
  SmoothPlanes planes =
      SmoothPlanesOf(picture, pass.borders ? frame.guides->Plane(Layer::kObject) : std::span<const float>(),
                     SmoothPad(pass.filter, sigma, longer_side));
  WaveletStops stops;
  if (pass.filter == SmoothPass::Filter::kWavelets && pass.borders) {
    const GuideSet& guides = *frame.guides;
    stops = {LaidOut(guides.Plane(Layer::kNormal, 0), planes), LaidOut(guides.Plane(Layer::kNormal, 1), planes),
             LaidOut(guides.Plane(Layer::kNormal, 2), planes), LaidOut(guides.Plane(Layer::kDepth), planes)};
  }
  const bool weighs = pass.filter == SmoothPass::Filter::kBilateral || pass.filter == SmoothPass::Filter::kWavelets;
  for (int i = 0; i < pass.passes; ++i) {
    if (weighs) FillLonePixels(BiweightPerSquare(pass.range), planes);
    switch (pass.filter) {
      case SmoothPass::Filter::kBilateral:
        BilateralFilter(sigma, pass.range, planes);
        break;
      case SmoothPass::Filter::kKuwahara:
        KuwaharaFilter(sigma, 2.0 * frame.scale, planes);
        break;
      case SmoothPass::Filter::kGuided:
        GuidedFilter(sigma, pass.range, planes);
        break;
      case SmoothPass::Filter::kWavelets:
        WaveletsFilter(sigma, pass.range, frame.scale, stops, planes);
        break;
    }
  }
  // What is around is even now: a smaller difference shows.
  if (weighs) FillLonePixels(static_cast<float>(1.0 / (pass.range * pass.range)), planes);
  PutSmoothed(planes, strength, only, picture);
}

}  // namespace scumble::internal
