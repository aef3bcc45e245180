#include <algorithm>
#include <array>
#include <vector>

#include "core/filter/wide_loops.h"
#include "finish/area/area_effects.h"
#include "finish/area/edges_flow.h"
#include "finish/area/gaussian_rows.h"
#include "finish/area/oklab_blocks.h"
#include "finish/tone/point_effect.h"
#include "finish/tone/sigmoid.h"
#include "finish/tone/surface_share.h"

namespace scumble::internal {
namespace {

constexpr double kWidthOfSigma = 2.055;  // of the dark side of a step's response, at half its depth
constexpr double kTensorSigma = 3.0;     // of the directions of flow, pixels at the reference height

// Calls visit(first, count, responses) for runs of up to kOklabBlock pixels, from several threads: ink is a function of
// the response.
template <class Visit>
void ForEachResponse(const EdgesPass& pass, const FinishFrame& frame, const FloatPlane& tone, int width, int height,
                     const Visit& visit) {
  const double sigma = pass.width * frame.scale / kWidthOfSigma;
  const auto sharpness = static_cast<float>(pass.sharpness), fill = static_cast<float>(pass.fill);
  const auto keys = pass.borders ? frame.guides->Plane(Layer::kObject) : std::span<const float>();
  if (keys.empty() && !(pass.flow > 0.0)) {
    const auto columns = static_cast<std::size_t>(width);
    ForEachGaussianPair(tone, width, height, sigma, fill + sharpness, -sharpness, 1.0f - fill,
                        [&](int y, const float* responses) {
                          for (std::size_t x = 0; x < columns; x += kOklabBlock)
                            visit(std::size_t(y) * columns + x, std::min(kOklabBlock, columns - x), responses + x);
                        });
    return;
  }
  if (pass.flow > 0.0) {
    const FloatPlane response =
        FlowResponse(tone, keys, width, height, {sigma, pass.flow * frame.scale, kTensorSigma * frame.scale},
                     {fill + sharpness, -sharpness, 1.0f - fill, static_cast<float>(pass.threshold)});
    ForEachOklabBlock(response.size(),
                      [&](std::size_t first, std::size_t count) { visit(first, count, response.data() + first); });
    return;
  }
  FloatPlane narrow = BlurredWithin(tone, keys, width, height, sigma);
  const FloatPlane wide = BlurredWithin(tone, keys, width, height, 1.6 * sigma);
  ForEachOklabBlock(tone.size(), [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i)
      narrow[i] = 1.0f - fill + ((fill + sharpness) * narrow[i] - sharpness * wide[i]);
    visit(first, count, narrow.data() + first);
  });
}

// Whether a value is below `limit`. No early exit, so that it vectorises.
bool AnyBelow(const float* values, std::size_t count, float limit) {
  int below = 0;
  for (std::size_t i = 0; i < count; ++i) below |= values[i] < limit ? 1 : 0;
  return below != 0;
}

// The shares of ink, or of paper, that responses mean.
struct Inking {
  float threshold, slope, strength;
  bool is_paper;
};

SCUMBLE_WIDE_LOOPS void TakeShares(const Inking& inking, const float* responses, std::size_t count, float* shares) {
  const auto [threshold, slope, strength, is_paper] = inking;
  for (std::size_t i = 0; i < count; ++i) {
    const float below = responses[i] - threshold, ink = below < 0.0f ? Sigmoid(-slope * below) : 0.0f;
    shares[i] = (is_paper ? 1.0f - ink : ink) * strength;
  }
}

}  // namespace

void DrawEdges(const EdgesPass& pass, double strength, std::span<const std::uint8_t> only, bool of_guides,
               const FinishFrame& frame, Picture& picture) {
  const FloatPlane tone = ToneOf(pass.tone, frame, picture);
  const bool on_paper = pass.draw == EdgesPass::Draw::kPaint;
  const LabColor fixed = ToOklab(on_paper ? pass.paper : pass.ink);
  const bool of_paint = !on_paper && pass.color != OutlinePass::Color::kInk;
  // As outlines have it: a third as light and half as colourful.
  const float chroma = pass.color == OutlinePass::Color::kComplement ? -0.5f : 0.5f;
  const Inking inking{static_cast<float>(pass.threshold), static_cast<float>(pass.slope), static_cast<float>(strength),
                      on_paper};
  const auto coverage =
      pass.tone != EdgesPass::Tone::kPaint ? frame.guides->Plane(Layer::kCoverage) : std::span<const float>();
  const auto draw = [&](std::size_t first, std::size_t count, const float* responses) {
    if (!on_paper && !AnyBelow(responses, count, inking.threshold)) return;
    std::array<float, kOklabBlock> shares;
    TakeShares(inking, responses, count, shares.data());
    // Few pixels have ink: these alone are mixed, side by side.
    std::uint16_t* const texels = picture.rgba.data() + 4 * first;
    if (!coverage.empty()) {  // light and base colours are the surface's, paint the whole pixel's
      std::array<float, kOklabBlock> surface;
      SurfaceShares(coverage.data() + first, texels, of_guides, count, surface.data());
      for (std::size_t i = 0; i < count; ++i) shares[i] *= surface[i];
    }
    std::array<std::uint16_t, 4 * kOklabBlock> made;
    std::array<std::uint16_t, kOklabBlock> where;
    std::array<float, kOklabBlock> share;
    std::size_t found = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (!(shares[i] > 0.0f) || texels[4 * i + 3] == 0 || (!only.empty() && !only[first + i])) continue;
      share[found] = shares[i];
      std::copy_n(texels + 4 * i, 4, made.data() + 4 * found);
      where[found++] = static_cast<std::uint16_t>(i);
    }
    OklabBlock block;
    OklabFromTexels(made.data(), found, block);
    for (std::size_t i = 0; i < found; ++i) {
      float &l = block.lightness[i], &a = block.a[i], &b = block.b[i];
      const LabColor other = of_paint ? LabColor{l / 3.0f, a * chroma, b * chroma} : fixed;
      l += (other.lightness - l) * share[i], a += (other.a - a) * share[i], b += (other.b - b) * share[i];
    }
    TexelsFromOklab(block, found, made.data());
    for (std::size_t i = 0; i < found; ++i) std::copy_n(made.data() + 4 * i, 3, texels + 4 * std::size_t(where[i]));
  };
  ForEachResponse(pass, frame, tone, picture.width, picture.height, draw);
}

}  // namespace scumble::internal
