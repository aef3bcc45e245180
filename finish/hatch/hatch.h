// The effect `hatch`.
#pragma once

#include <cstdint>
#include <span>

#include "finish/finish.h"

namespace scumble::internal {

// Draws strokes in patches of one direction (finish/hatch/patches.h). Of light, only the surface's share of a pixel has
// ink (SurfaceShares, with `of_guides`). `strength` and `only` as FinishPass and FinishStep have them. The frame's
// guides must hold the pass's layers.
//
// A patch's direction is the main axis of its structure tensor of normals, J = Σ ∇n ∇nᵀ, or of light or depth. The axis
// has no sign, so all directions occur.
//
// The strokes of a layer are antialiased, and as wide as the share of ink asks. Layers fill one after the other. Where
// strokes cross, ink counts once. The mean share of ink is 1 - tone / from.
void DrawHatch(const HatchPass& pass, double strength, std::span<const std::uint8_t> only, bool of_guides,
               const FinishFrame& frame, Picture& picture);

}  // namespace scumble::internal
