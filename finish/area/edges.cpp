#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/filter/oklab_rows.h"
#include "core/image/exact_math.h"
#include "finish/area/area_effects.h"
#include "finish/area/lab_planes.h"
#include "finish/tone/point_effect.h"

namespace scumble::internal {
namespace {

constexpr double kWider = 1.6;           // of the second Gaussian
constexpr double kWidthOfSigma = 2.055;  // of the dark side of a step's response, at half its depth

std::vector<float> GaussianWeights(double sigma) {
  const int reach = static_cast<int>(std::ceil(3.0 * sigma));
  std::vector<double> exact;
  double sum = 0.0;
  for (int k = 0; k <= reach; ++k) {
    exact.push_back(Exp2(-0.5 * k * k / (sigma * sigma) * kLog2OfE));
    sum += k == 0 ? exact.back() : 2.0 * exact.back();
  }
  std::vector<float> weights;
  for (const double weight : exact) weights.push_back(static_cast<float>(weight / sum));
  return weights;
}

// Rows, then columns, by several threads and in floats, unlike core/filter/gaussian_blur.h. Beyond its edges the plane
// goes on with its last values.
Plane Blurred(const Plane& plane, int width, int height, double sigma) {
  const std::vector<float> weights = GaussianWeights(sigma);
  const int reach = static_cast<int>(weights.size()) - 1;
  Plane half(plane.size()), whole(plane.size());
  tbb::parallel_for(tbb::blocked_range<int>(0, height, 8), [&](const auto& rows) {
    std::vector<float> padded(std::size_t(width + 2 * reach));
    for (int y = rows.begin(); y != rows.end(); ++y) {
      const float* const row = plane.data() + std::size_t(y) * std::size_t(width);
      for (int x = -reach; x < width + reach; ++x) padded[std::size_t(x + reach)] = row[std::clamp(x, 0, width - 1)];
      float* const out = half.data() + std::size_t(y) * std::size_t(width);
      const float* const at = padded.data() + reach;
      for (int x = 0; x < width; ++x) out[x] = weights[0] * at[x];
      for (int k = 1; k <= reach; ++k) {
        const float weight = weights[std::size_t(k)];
        for (int x = 0; x < width; ++x) out[x] += weight * (at[x - k] + at[x + k]);
      }
    }
  });
  tbb::parallel_for(tbb::blocked_range<int>(0, height, 8), [&](const auto& rows) {
    for (int y = rows.begin(); y != rows.end(); ++y) {
      const auto row = [&](int v) {
        return half.data() + std::size_t(std::clamp(v, 0, height - 1)) * std::size_t(width);
      };
      float* const out = whole.data() + std::size_t(y) * std::size_t(width);
      for (int x = 0; x < width; ++x) out[x] = weights[0] * row(y)[x];
      for (int k = 1; k <= reach; ++k) {
        const float weight = weights[std::size_t(k)];
        const float *const above = row(y - k), *const below = row(y + k);
        for (int x = 0; x < width; ++x) out[x] += weight * (above[x] + below[x]);
      }
    }
  });
  return whole;
}

Plane ToneOf(const EdgesPass& pass, const FinishFrame& frame, const LabPlanes& paint) {
  if (pass.tone == EdgesPass::Tone::kPaint) return paint.lightness;
  const bool of_light = pass.tone == EdgesPass::Tone::kLight;
  const std::size_t pixels = paint.lightness.size();
  std::array<const float*, 3> planes{};
  Plane light;
  if (of_light) {
    const auto plane = frame.guides->Plane(Layer::kLuminance);
    const auto per_bright = static_cast<float>(1.0 / frame.measures.bright);
    light.resize(pixels);
    for (std::size_t i = 0; i < pixels; ++i) light[i] = plane[i] * per_bright;
    planes.fill(light.data());
  } else {
    for (int c = 0; c < 3; ++c) planes[std::size_t(c)] = frame.guides->Plane(Layer::kAlbedo, c).data();
  }
  Plane tone(pixels);
  const auto coverage = frame.guides->Plane(Layer::kCoverage);
  tbb::parallel_for(std::size_t(0), (pixels + kOklabBlock - 1) / kOklabBlock, [&](std::size_t one) {
    const std::size_t first = one * kOklabBlock, count = std::min(kOklabBlock, pixels - first);
    OklabBlock block;
    OklabFromPlanes({planes[0] + first, planes[1] + first, planes[2] + first}, count, block);
    // Background has no tone: it counts as bare paper.
    for (std::size_t i = 0; i < count; ++i) tone[first + i] = coverage[first + i] > 0.0f ? block.lightness[i] : 1.0f;
  });
  return tone;
}

float Tanh(float x) {
  const double e = Exp2(2.0 * double(std::max(x, -20.0f)) * kLog2OfE);
  return static_cast<float>((e - 1.0) / (e + 1.0));
}

}  // namespace

void DrawEdges(const EdgesPass& pass, double strength, std::span<const std::uint8_t> only, const FinishFrame& frame,
               Picture& picture) {
  const LabPlanes given = PlanesOf(picture);
  const Plane tone = ToneOf(pass, frame, given);
  const double sigma = pass.width * frame.scale / kWidthOfSigma;
  const Plane narrow = Blurred(tone, picture.width, picture.height, sigma);
  const Plane wide = Blurred(tone, picture.width, picture.height, kWider * sigma);
  const auto sharpness = static_cast<float>(pass.sharpness), fill = static_cast<float>(pass.fill),
             threshold = static_cast<float>(pass.threshold), slope = static_cast<float>(pass.slope);
  const bool on_paper = pass.draw == EdgesPass::Draw::kPaint;
  const LabColor other = ToOklab(on_paper ? pass.paper : pass.ink);
  LabPlanes made = given;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tone.size(), 1 << 14), [&](const auto& part) {
    for (std::size_t i = part.begin(); i != part.end(); ++i) {
      const float response = fill * narrow[i] + (1.0f - fill) + sharpness * (narrow[i] - wide[i]);
      const float ink = response >= threshold ? 0.0f : -Tanh(slope * (response - threshold));
      const float share = on_paper ? 1.0f - ink : ink;
      if (!(share > 0.0f)) continue;
      made.lightness[i] += (other.lightness - made.lightness[i]) * share;
      made.a[i] += (other.a - made.a[i]) * share, made.b[i] += (other.b - made.b[i]) * share;
    }
  });
  PutPlanes(made, given, strength, only, picture);
}

}  // namespace scumble::internal
