#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "finish/area/area_effects.h"
#include "finish/area/lab_planes.h"
#include "finish/area/smooth_filters.h"

namespace scumble::internal {

SmoothPlanes::SmoothPlanes(std::size_t columns, std::size_t rows, std::size_t around)
    : width(columns), height(rows), pad(around) {
  constexpr std::size_t kVector = 16;
  stride = (pad + width + kVector + pad + kVector - 1) / kVector * kVector;
  const std::size_t places = stride * (height + 2 * pad) + kVector;
  lightness.resize(places), a.resize(places), b.resize(places);
  key.resize(places, std::numeric_limits<float>::quiet_NaN());
}

float BiweightPerSquare(double half) {
  return static_cast<float>(0.2928932188134524 / (half * half));  // a half at d = 0.5412 c
}

namespace {

std::size_t SmoothPad(SmoothPass::Filter filter, double sigma, std::size_t longer_side) {
  switch (filter) {
    case SmoothPass::Filter::kBilateral:
      return BilateralPad(sigma, longer_side);
    case SmoothPass::Filter::kKuwahara:
      return KuwaharaPad(sigma, longer_side);
    case SmoothPass::Filter::kWavelets:
      return WaveletsPad(sigma, longer_side);
    case SmoothPass::Filter::kGuided:
      break;
  }
  return 0;
}

SmoothPlanes SmoothPlanesOf(const LabPlanes& given, const Picture& picture, std::span<const float> object,
                            std::size_t pad) {
  const auto width = static_cast<std::size_t>(picture.width), height = static_cast<std::size_t>(picture.height);
  SmoothPlanes planes(width, height, pad);
  for (std::size_t y = 0; y < height; ++y) {
    const std::size_t i = y * width;
    const auto at = static_cast<std::ptrdiff_t>(planes.At(0, y));
    std::copy_n(given.lightness.data() + i, width, planes.lightness.begin() + at);
    std::copy_n(given.a.data() + i, width, planes.a.begin() + at);
    std::copy_n(given.b.data() + i, width, planes.b.begin() + at);
    for (std::size_t x = 0; x < width; ++x) {
      if (picture.rgba[4 * (i + x) + 3] != 0) planes.key[std::size_t(at) + x] = object.empty() ? 0.0f : object[i + x];
    }
  }
  return planes;
}

// A plane of the guides, laid out as the planes. What is not finite, the depth of nothing, becomes 0.
std::vector<float> LaidOut(std::span<const float> plane, const SmoothPlanes& planes) {
  std::vector<float> out(planes.size());
  for (std::size_t y = 0; y < planes.height; ++y) {
    for (std::size_t x = 0; x < planes.width; ++x) {
      const float value = plane[y * planes.width + x];
      out[planes.At(x, y)] = std::isfinite(value) ? value : 0.0f;
    }
  }
  return out;
}

}  // namespace

void Smooth(const SmoothPass& pass, double strength, std::span<const std::uint8_t> only, const FinishFrame& frame,
            Picture& picture) {
  const double sigma = pass.radius * frame.scale;
  const LabPlanes given = PlanesOf(picture);
  const auto longer_side = static_cast<std::size_t>(std::max(picture.width, picture.height));
  SmoothPlanes planes =
      SmoothPlanesOf(given, picture, pass.borders ? frame.guides->Plane(Layer::kObject) : std::span<const float>(),
                     SmoothPad(pass.filter, sigma, longer_side));
  WaveletStops stops;
  if (pass.filter == SmoothPass::Filter::kWavelets && pass.borders) {
    const GuideSet& guides = *frame.guides;
    stops = {LaidOut(guides.Plane(Layer::kNormal, 0), planes), LaidOut(guides.Plane(Layer::kNormal, 1), planes),
             LaidOut(guides.Plane(Layer::kNormal, 2), planes), LaidOut(guides.Plane(Layer::kDepth), planes)};
  }
  for (int i = 0; i < pass.passes; ++i) {
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
        WaveletsFilter(sigma, pass.range, stops, planes);
        break;
    }
  }
  LabPlanes made = given;
  for (std::size_t y = 0; y < planes.height; ++y) {
    const std::size_t i = y * planes.width, at = planes.At(0, y);
    std::copy_n(planes.lightness.data() + at, planes.width, made.lightness.data() + i);
    std::copy_n(planes.a.data() + at, planes.width, made.a.data() + i);
    std::copy_n(planes.b.data() + at, planes.width, made.b.data() + i);
  }
  PutPlanes(made, given, strength, only, picture);
}

}  // namespace scumble::internal
