#include "finish/points/point_block.h"

#include <algorithm>
#include <variant>

#include "core/filter/oklab_rows.h"
#include "core/filter/wide_loops.h"
#include "finish/area/oklab_blocks.h"
#include "finish/tone/surface_share.h"

namespace scumble::internal {
namespace {

// From one colour to the other, as far as the share says.
SCUMBLE_WIDE_LOOPS void Mix(const float* shares, const float* from, std::size_t count, float* to) {
  for (std::size_t i = 0; i < count; ++i) {
    const float mixed = from[i] + (to[i] - from[i]) * shares[i];
    to[i] = shares[i] >= 1.0f ? to[i] : mixed;
  }
}

void MixColors(const float* shares, std::size_t count, const OklabBlock& from, OklabBlock& to) {
  Mix(shares, from.lightness.data(), count, to.lightness.data());
  Mix(shares, from.a.data(), count, to.a.data());
  Mix(shares, from.b.data(), count, to.b.data());
}

// Whether the step does the same to a colour wherever it is.
bool IsOfColors(const FinishStep& step) {
  const auto* const tones = std::get_if<TonesPass>(&step.pass.effect);
  return (tones && tones->tone == TonesPass::Tone::kPaint) || std::holds_alternative<PalettePass>(step.pass.effect) ||
         std::holds_alternative<GradePass>(step.pass.effect) || std::holds_alternative<FillPass>(step.pass.effect);
}

void Copy(const OklabBlock& from, std::size_t first, std::size_t count, std::size_t place, OklabBlock& to) {
  std::copy_n(from.lightness.begin() + std::ptrdiff_t(first), count, to.lightness.begin() + std::ptrdiff_t(place));
  std::copy_n(from.a.begin() + std::ptrdiff_t(first), count, to.a.begin() + std::ptrdiff_t(place));
  std::copy_n(from.b.begin() + std::ptrdiff_t(first), count, to.b.begin() + std::ptrdiff_t(place));
}

// `effect` is one of the step's.
void ApplyEffect(const PointEffect& effect, const FinishStep& step, const Pixels& pixels, OklabBlock& block) {
  if (!pixels.parts || IsOfColors(step)) return effect(pixels.first, pixels.count, block);
  OklabBlock run;  // of neighbours
  for (std::size_t i = 0, end = 0; i < pixels.count; i = end) {
    const std::size_t like = pixels.parts[i].like;
    while (end < pixels.count && pixels.parts[end].like == like + (end - i)) ++end;
    Copy(block, i, end - i, 0, run);
    effect(like, end - i, run);
    Copy(run, 0, end - i, i, block);
  }
}

// How much of each pixel of a block is the surface: made once, for all steps that ask.
class Surface {
 public:
  using Shares = std::array<float, kOklabBlock>;

  // The same coverage and stage for all steps of a loop.
  const Shares& Of(const PointStep& one, const Pixels& pixels) {
    if (!is_made_) {
      const float* coverage = one.coverage.data() + pixels.first;
      Shares of_parts;
      for (std::size_t i = 0; i < pixels.count && pixels.parts; ++i)
        of_parts[i] = pixels.parts[i].is_stroke ? 1.0f : one.coverage[pixels.parts[i].pixel];
      if (pixels.parts) coverage = of_parts.data();
      kinds_ = SurfaceShares(coverage, pixels.texels, IsOfGuides(*one.step), pixels.count, shares_.data());
      is_made_ = true;
    }
    return shares_;
  }
  const ShareKinds& kinds() const { return kinds_; }

 private:
  Shares shares_;
  ShareKinds kinds_;
  bool is_made_ = false;
};

// How much of each pixel's change stays.
enum class Weight { kNothing, kParts, kAll };

Weight WeightsOf(const PointStep& one, const Pixels& pixels, Surface& surface, float* shares) {
  const std::size_t count = pixels.count;
  const FinishStep& step = *one.step;
  const auto strength = static_cast<float>(step.pass.strength);
  Weight weight = strength < 1.0f || !step.share.empty() || !step.only.empty() ? Weight::kParts : Weight::kAll;
  const bool has_coverage = !one.coverage.empty() && !one.behind;
  if (has_coverage) {
    surface.Of(one, pixels);
    if (surface.kinds().all_zero) return Weight::kNothing;
    if (!surface.kinds().all_one) weight = Weight::kParts;
  }
  if (weight == Weight::kAll) return weight;
  std::fill_n(shares, count, strength);
  for (std::size_t i = 0; i < count && !step.share.empty(); ++i)
    shares[i] = strength * (static_cast<float>(step.share[pixels.Of(i)]) / 65535.0f);
  for (std::size_t i = 0; i < count && !step.only.empty(); ++i) shares[i] = step.only[pixels.Of(i)] ? shares[i] : 0.0f;
  if (has_coverage) {
    const Surface::Shares& of_surface = surface.Of(one, pixels);
    for (std::size_t i = 0; i < count; ++i) shares[i] *= of_surface[i];
  }
  return weight;
}

// The part of mixed pixels that is background takes what the step does to that.
void MixBehind(const PointStep& one, const Pixels& pixels, Surface& surface, const OklabBlock& before,
               OklabBlock& block) {
  Surface::Shares shares = surface.Of(one, pixels);
  OklabBlock behind = before;
  ApplyEffect(one.behind, *one.step, pixels, behind);
  for (std::size_t i = 0; i < pixels.count; ++i) shares[i] = shares[i] > 0.0f ? shares[i] : 1.0f;
  MixColors(shares.data(), pixels.count, behind, block);
}

}  // namespace

bool HidesPaint(const FinishStep& step) {
  return std::holds_alternative<FillPass>(step.pass.effect) && step.pass.at == FinishPass::Stage::kSheet &&
         step.pass.strength >= 1.0 && step.only.empty() && step.share.empty();
}

bool IsOfGuides(const FinishStep& step) { return step.pass.at == FinishPass::Stage::kGuides; }

void PaintBlock(std::span<const PointStep> steps, const Pixels& pixels, std::uint16_t* texels) {
  const std::size_t count = pixels.count;
  OklabBlock given, block, before;
  OklabFromTexels(texels, count, given);
  block = given;
  Surface surface;
  for (const PointStep& one : steps) {
    Surface::Shares shares;
    const Weight weight = WeightsOf(one, pixels, surface, shares.data());
    if (weight == Weight::kNothing) continue;
    if (one.behind) surface.Of(one, pixels);
    const bool mixes_behind = one.behind && surface.kinds().is_mixed;
    if (weight == Weight::kParts || mixes_behind) before = block;
    ApplyEffect(one.apply, *one.step, pixels, block);
    if (mixes_behind) MixBehind(one, pixels, surface, before, block);
    if (weight == Weight::kParts) MixColors(shares.data(), count, before, block);
  }
  PutBlock(given, 1.0f, nullptr, count, block, texels);
}

std::vector<Texel> PaintParts(std::span<const PointStep> steps, const Batch& batch) {
  const std::size_t count = batch.parts.size();
  std::vector<Texel> made = batch.paint, alphas(count);
  for (std::size_t i = 0; i < count; ++i) alphas[i][3] = batch.parts[i].alpha;
  for (std::size_t i = 0; i < count; i += kOklabBlock) {
    const Pixels some{0, std::min(kOklabBlock, count - i), alphas[i].data(), batch.parts.data() + i};
    PaintBlock(steps, some, made[i].data());
  }
  return made;
}

}  // namespace scumble::internal
