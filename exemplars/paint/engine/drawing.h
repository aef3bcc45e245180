// A drawing in a dry medium with feedback: further strokes go where the tone is still too light.
#pragma once

#include <functional>
#include <span>

#include "exemplars/paint/engine/media.h"
#include "exemplars/paint/engine/paper.h"
#include "exemplars/paint/engine/strokes.h"

namespace scumble::paint {

class Drawing {
 public:
  // `media` sets how the layer settles on the ground.
  Drawing(Ground ground, const DryMedia& media);

  Canvas& canvas() { return canvas_; }

  // The current drawing.
  Colors Look() const;
  // The drawing as a ground for another medium.
  Ground AsGround() const { return {ground_.tooth, Look()}; }

  // A touch whose pressure is proportional to the darkness that the current drawing lacks against `target`, in [0, 1]:
  // `eagerness` times the difference, `heaviest` at most. It compares blurred pictures, so it reacts to tone and not to
  // single strokes. It ends slightly beyond the rim. A negative eagerness is for chalk: it presses where the drawing is
  // still too dark.
  Touch Missing(const Touch& target, float eagerness, float heaviest) const;

 private:
  Ground ground_;
  DryMedia media_;
  Canvas canvas_;
};

// One round of hatching: compares, then hatches where tone is missing.
struct Round {
  glm::vec3 axis;
  float share;     // of the target's darkness that this round reaches
  float heaviest;  // pressure
  HatchOptions hatch;
};
void HatchRound(Drawing& drawing, Brush& brush, Chance& chance, const Touch& target, const Round& round);

// Several rounds, each with a new comparison; shares and pressures grow from the first to the last.
struct Rounds {
  int count;
  std::span<const glm::vec3> axes;  // taken in turn
  glm::vec2 share;                  // first, last
  glm::vec2 heaviest;
  HatchOptions hatch;
};
// Round i draws its random numbers from (seed, first_stream + i).
void HatchRounds(Drawing& drawing, Brush& brush, std::uint64_t seed, std::uint64_t first_stream, const Touch& target,
                 const Rounds& rounds);

// Smears the drawing with a finger, or a stump: a few wide strokes along the flow around `axis`.
Status Smudge(Drawing& drawing, const Studio& studio, std::uint64_t stream, glm::vec3 axis, const Touch& touch);

// Directions of hatching, as axes of the circles that strokes follow. Their poles stay in the light or beyond the rim,
// where no full circle of the hatching is visible.
inline constexpr glm::vec3 kAlongShade{-0.62f, 0.66f, 0.42f};
inline constexpr glm::vec3 kDiagonal{-0.85f, 0.25f, 0.30f};
inline constexpr glm::vec3 kAcross{0.25f, 0.90f, 0.20f};

}  // namespace scumble::paint
