// Effects that treat every pixel by itself, in Oklab.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "core/filter/oklab_rows.h"
#include "finish/finish.h"

namespace scumble::internal {

// Changes `count` colours in place, those of the pixels from `first` on. Called from several threads.
using PointEffect = std::function<void(std::size_t first, std::size_t count, OklabBlock& block)>;

// Each keeps references to the frame and its guides, which must hold the pass's layers.
// `light`: what ToonLight gives; it must outlive the effect.
PointEffect MakeToon(const ToonPass& pass, const FinishFrame& frame, std::span<const float> light);
PointEffect MakeRender(const RenderPass& pass, const FinishFrame& frame);
// `light`: by pixel its lightness 0 … 1, and must outlive the effect; empty: the paint's counts.
PointEffect MakeTones(const TonesPass& pass, std::span<const float> light = {});
// `soft`: by pixel how much of it is in shade, and must outlive the effect; empty: what ShadeOf says.
PointEffect MakeShadows(const ShadowsPass& pass, const FinishFrame& frame, std::span<const float> soft = {});
// `at`: of a sheet the background, which is infinitely far, has all the air; else as much as a surface at `far`.
PointEffect MakeDepth(const DepthPass& pass, FinishPass::Stage at, const FinishFrame& frame);
// As if all were background.
PointEffect MakeDepthOfBackground(const DepthPass& pass, FinishPass::Stage at, const FinishFrame& frame);
// The linear map of Monge and Kantorovich between two normal distributions (Pitié, Kokaram, "The linear
// Monge-Kantorovitch linear colour mapping for example-based colour transfer", 2007), A = S^-½ (S^½ T S^½)^½ S^-½, in
// Oklab. `source` are the picture's colours; the pass has a target. Eigenvalues of A end at the pass's gain; those of S
// and T begin at the square of 0.001, so that pictures of one colour are moved and no more.
PointEffect MakePalette(const PalettePass& pass, const ColorSpread& source);
PointEffect MakeGrade(const GradePass& pass);
PointEffect MakeFill(const FillPass& pass);

// How much of each pixel is in shade, 0 … 1, of `count` from `first` on: the larger of cast and form shadow.
void ShadeOf(const ShadowsPass& pass, const FinishFrame& frame, std::size_t first, std::size_t count, float* out);

// A colour as (L, a, b).
struct LabColor {
  float lightness, a, b;
};
LabColor ToOklab(const Rgb16& color);

}  // namespace scumble::internal
