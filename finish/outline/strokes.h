// Lines as strokes of varying width.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "finish/area/noise.h"
#include "finish/finish.h"
#include "finish/outline/line_chains.h"

namespace scumble::internal {

// A straight piece of a stroke, round at both ends.
struct StrokePiece {
  glm::vec2 from, to;
  float from_width = 0.0f, to_width = 0.0f;  // pixels
  std::uint32_t owner = 0;                   // the pixel that the line belongs to, at `from`
};

// What strokes stray by along each axis, where that sticks to surfaces. Null: it sticks to the picture.
struct Straying {
  const NoiseField *across = nullptr, *down = nullptr;
};

// One line's stroke: its widths by class, depth, light and taper, its wobble and side. Pieces are as long as they may
// be without leaving the line by a tenth of a pixel.
std::vector<StrokePiece> StrokeOf(const OutlinePass& pass, const FinishFrame& frame, const Straying& straying,
                                  const LineChain& chain);

// How much of each pixel the strokes cover, 0 … 1, and the owner of the piece that covers most of it.
struct StrokeCover {
  std::vector<float> share;
  std::vector<std::uint32_t> owner;
};

// Antialiased; a stroke thinner than a pixel is as faint as it is thin. Where strokes meet, the largest share counts.
// `with_owner`: fills in `owner`. O(pixels + strokes' area). The result does not depend on threads.
StrokeCover CoverOf(std::span<const StrokePiece> pieces, int width, int height, bool with_owner);

}  // namespace scumble::internal
