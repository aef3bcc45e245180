// Lines as strokes of varying width.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "finish/area/float_plane.h"
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

// Null: there is none of it.
struct LineNoise {
  const NoiseField *across = nullptr, *down = nullptr;  // what strokes stray by, where that sticks to surfaces
  const NoiseField* gaps = nullptr;                     // where they are left out
};

// How wide a line is by its class, depth, light and gaps, in pixels. Keeps references.
class LineWidth {
 public:
  LineWidth(const OutlinePass& pass, const FinishFrame& frame, const NoiseField* gaps);
  // `owner`: the pixel that the line belongs to.
  float At(std::size_t owner, LineClass line) const;

 private:
  const OutlinePass& pass_;
  double scale_, bright_, thin_at_, gap_from_ = -2.0;  // noise below that is a gap
  std::span<const float> depth_, light_;
  const NoiseField* gaps_;
  std::size_t width_;
};

// One line's stroke: its widths by class, depth, light and taper, its wobble and side. Pieces are as long as they may
// be without leaving the line by a tenth of a pixel.
std::vector<StrokePiece> StrokeOf(const OutlinePass& pass, const FinishFrame& frame, const LineNoise& noise,
                                  LineChain chain);

// How much of each pixel the strokes cover, 0 … 1, and the owner of the piece that covers most of it.
struct StrokeCover {
  FloatPlane share;
  std::vector<std::uint32_t, PlaneAllocator<std::uint32_t>> owner;
};

// Antialiased; a stroke thinner than a pixel is as faint as it is thin. Where strokes meet, the largest share counts.
// `with_owner`: fills in `owner`. O(pixels + strokes' area). The result does not depend on threads.
StrokeCover CoverOf(std::span<const StrokePiece> pieces, int width, int height, bool with_owner);

// Added to what a border is: it belongs to the pixel to the right or below.
constexpr std::uint8_t kSecondOwns = 0x40;

// Lines without strokes. A pixel whose nearest pixel beside a border is d pixels away lies d + 1/2 from that line. It
// is covered as far as the line is wide. Of a pixel with several borders the widest line counts. `borders`: with
// kSecondOwns. O(pixels), whatever the width.
StrokeCover CoverByDistance(const OutlinePass& pass, const FinishFrame& frame, const NoiseField* gaps,
                            const BorderMap& borders, bool with_owner);

}  // namespace scumble::internal
