#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/image/exact_math.h"
#include "finish/area/area_effects.h"
#include "finish/area/edges_flow.h"
#include "finish/area/gaussian_rows.h"
#include "finish/area/oklab_blocks.h"
#include "finish/tone/point_effect.h"

namespace scumble::internal {
namespace {

constexpr double kWidthOfSigma = 2.055;  // of the dark side of a step's response, at half its depth
constexpr double kTensorSigma = 3.0;     // of the directions of flow, pixels at the reference height

// What ink is a function of, by pixel.
FloatPlane ResponseOf(const EdgesPass& pass, const FinishFrame& frame, const FloatPlane& tone, int width, int height) {
  const double sigma = pass.width * frame.scale / kWidthOfSigma;
  const auto sharpness = static_cast<float>(pass.sharpness), fill = static_cast<float>(pass.fill);
  const auto keys = pass.borders ? frame.guides->Plane(Layer::kObject) : std::span<const float>();
  if (pass.flow > 0.0) {
    return FlowResponse(tone, keys, width, height, {sigma, pass.flow * frame.scale, kTensorSigma * frame.scale},
                        {fill + sharpness, -sharpness, 1.0f - fill, static_cast<float>(pass.threshold)});
  }
  if (keys.empty()) return GaussianPair(tone, width, height, sigma, fill + sharpness, -sharpness, 1.0f - fill);
  FloatPlane narrow = BlurredWithin(tone, keys, width, height, sigma);
  const FloatPlane wide = BlurredWithin(tone, keys, width, height, 1.6 * sigma);
  ForEachOklabBlock(tone.size(), [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i)
      narrow[i] = 1.0f - fill + ((fill + sharpness) * narrow[i] - sharpness * wide[i]);
  });
  return narrow;
}

float Tanh(float x) {
  const double e = Exp2(2.0 * double(std::max(x, -20.0f)) * kLog2OfE);
  return static_cast<float>((e - 1.0) / (e + 1.0));
}

// The share of ink, or of paper; whether there is any.
bool SharesOf(const EdgesPass& pass, const float* response, std::size_t count, float* share) {
  const auto threshold = static_cast<float>(pass.threshold), slope = static_cast<float>(pass.slope);
  const bool on_paper = pass.draw == EdgesPass::Draw::kPaint;
  if (!on_paper && *std::min_element(response, response + count) >= threshold) return false;
  for (std::size_t i = 0; i < count; ++i) {
    const float ink = response[i] >= threshold ? 0.0f : -Tanh(slope * (response[i] - threshold));
    share[i] = on_paper ? 1.0f - ink : ink;
  }
  return true;
}

}  // namespace

void DrawEdges(const EdgesPass& pass, double strength, std::span<const std::uint8_t> only, const FinishFrame& frame,
               Picture& picture) {
  const FloatPlane tone = ToneOf(pass.tone, frame, picture);
  const FloatPlane response = ResponseOf(pass, frame, tone, picture.width, picture.height);
  const bool on_paper = pass.draw == EdgesPass::Draw::kPaint;
  const LabColor fixed = ToOklab(on_paper ? pass.paper : pass.ink);
  const bool of_paint = !on_paper && pass.color != OutlinePass::Color::kInk;
  // As outlines have it: a third as light and half as colourful.
  const float chroma = pass.color == OutlinePass::Color::kComplement ? -0.5f : 0.5f;
  ForEachOklabBlock(tone.size(), [&](std::size_t first, std::size_t count) {
    std::array<float, kOklabBlock> share;
    if (!SharesOf(pass, response.data() + first, count, share.data())) return;
    std::uint16_t* const texels = picture.rgba.data() + 4 * first;
    std::uint16_t made[4 * kOklabBlock];
    std::copy_n(texels, 4 * count, made);
    OklabBlock block;
    OklabFromTexels(texels, count, block);
    for (std::size_t i = 0; i < count; ++i) {
      float &l = block.lightness[i], &a = block.a[i], &b = block.b[i];
      const LabColor other = of_paint ? LabColor{l / 3.0f, a * chroma, b * chroma} : fixed;
      const float part = share[i] * static_cast<float>(strength);
      l += (other.lightness - l) * part, a += (other.a - a) * part, b += (other.b - b) * part;
    }
    TexelsFromOklab(block, count, made);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t p = first + i;
      if (share[i] > 0.0f && texels[4 * i + 3] != 0 && (only.empty() || only[p]))
        std::copy_n(made + 4 * i, 3, texels + 4 * i);
    }
  });
}

}  // namespace scumble::internal
