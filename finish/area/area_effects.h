// Filters: effects that look at the pixels around.
#pragma once

#include <cstdint>
#include <span>

#include "finish/area/float_plane.h"
#include "finish/finish.h"

namespace scumble::internal {

// `strength` and `only` as FinishPass and FinishStep have them. The frame's guides must hold the pass's layers.

// By pixel how much of it is in shade, under a Gaussian of the pass's `soften` over pixels of the same object.
// Background has no shade. O(pixels · soften).
FloatPlane SoftShade(const ShadowsPass& pass, const FinishFrame& frame);

// The light that toon cuts into bands, by pixel: direct light, whose brightest tenth is measures.bright, or wrapped
// light, 0 … 1. Without the noise of its samples (finish/area/even_light.h) where it is cut and may have any. Empty
// where toon looks at no light.
FloatPlane ToonLight(const ToonPass& pass, const FinishFrame& frame);

// The extended difference of Gaussians (Winnemöller, Kyprianidis, Olsen, "XDoG: An eXtended difference-of-Gaussians
// compendium", 2012, section 2.5): U = (1 + p) G(σ) - p G(1.6 σ) of a tone of 0 … 1. Ink is 0 where U reaches the
// threshold. Below, it is the sigmoid of slope · (threshold - U), in the place of their tanh (finish/tone/sigmoid.h). σ
// is width / 2.055: the dark side of a step is `width` wide at half its depth. With `fill` f below 1 the first term
// becomes f G(σ) + 1 - f, which keeps lines and fills less. With `flow` the difference is taken across edges and evened
// out along them (finish/area/edges_flow.h). With `borders` each Gaussian is over pixels of the same object alone, so
// that a border of two objects makes no line. Of guides, only the surface's share of a pixel has ink (SurfaceShares,
// with `of_guides`). O(pixels · (width + flow)).
void DrawEdges(const EdgesPass& pass, double strength, std::span<const std::uint8_t> only, bool of_guides,
               const FinishFrame& frame, Picture& picture);

// The blur of DepthPass: a Gaussian with a sigma of blur · u, over the pixels that are on the same side of the focus
// and blurred by half as much or more. So nothing sharp runs into what is blurred, and what is in focus keeps its
// bytes. Strokes of painted edges are blurred as their surface, but on a sheet. By levels of doubling sigma, each a
// smaller picture, blended so that the second moment is exact; alpha stays. Opaque pixels of a blurred surface that
// does not cover them show background, too, in its own blur. O(pixels · log(blur)). `step`: of a DepthPass.
void BlurByDepth(const FinishStep& step, const FinishFrame& frame, Picture& picture);

// Watercolour. A density δ of pigment is a product, 1 where nothing asks for more or less. Its factors are noise in
// clouds and in grains, what light parts have less, and 1 + edge · x e^(1-x). There x is the distance to the object's
// border over half its width. Every channel C of sRGB becomes C (1 - (1 - C)(δ - 1)) (Bousseau, Kaplan, Thollot,
// Sillion, "Interactive watercolor rendering with temporal coherence and abstraction", 2006). Then shapes tremble: the
// picture is read at places moved by noise, alpha too.
void Pigment(const PigmentPass& pass, double strength, std::span<const std::uint8_t> only, const FinishFrame& frame,
             Picture& picture);

}  // namespace scumble::internal
