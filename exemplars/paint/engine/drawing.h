// A drawing in a dry medium that is watched while it grows: where the tone is still too light the hand goes back.
#pragma once

#include <functional>
#include <span>

#include "exemplars/paint/engine/media.h"
#include "exemplars/paint/engine/paper.h"
#include "exemplars/paint/engine/strokes.h"

namespace scumble::paint {

class Drawing {
 public:
  // `media` says how the layer settles on the ground.
  Drawing(Ground ground, const DryMedia& media);

  Canvas& canvas() { return canvas_; }

  // The drawing as it stands.
  Colors Look() const;
  // To go on with another medium over what is drawn.
  Ground AsGround() const { return {ground_.tooth, Look()}; }

  // A touch that presses in proportion to what is missing from `target`, the darkness wanted there in [0, 1], in the
  // drawing as it stands now: `eagerness` times the difference, `heaviest` at most. Seen with half-closed eyes, that is
  // blurred, so it answers to tone and not to single strokes. Ends a little way past the rim. A negative eagerness is
  // for chalk: it presses where the drawing is still too dark.
  Touch Missing(const Touch& target, float eagerness, float heaviest) const;

 private:
  Ground ground_;
  DryMedia media_;
  Canvas canvas_;
};

// One round of hatching: look, then hatch where tone is missing.
struct Round {
  glm::vec3 axis;
  float share;     // of the target's darkness that this round works up to
  float heaviest;  // pressure
  HatchOptions hatch;
};
void HatchRound(Drawing& drawing, Brush& brush, Chance& chance, const Touch& target, const Round& round);

// Several rounds, each from a fresh look, with shares and pressures that grow from the first to the last.
struct Rounds {
  int count;
  std::span<const glm::vec3> axes;  // taken in turn
  glm::vec2 share;                  // first, last
  glm::vec2 heaviest;
  HatchOptions hatch;
};
// Round i draws its chance from (seed, first_stream + i).
void HatchRounds(Drawing& drawing, Brush& brush, std::uint64_t seed, std::uint64_t first_stream, const Touch& target,
                 const Rounds& rounds);

// A finger, or a stump, drawn over what lies there: a few wide strokes along the flow round `axis`.
Status Smudge(Drawing& drawing, const Studio& studio, std::uint64_t stream, glm::vec3 axis, const Touch& touch);

// Directions to hatch in, as axes of the circles that strokes follow. Their poles stay in the light or beyond the rim,
// where no circle of the hatching closes in sight.
inline constexpr glm::vec3 kAlongShade{-0.62f, 0.66f, 0.42f};
inline constexpr glm::vec3 kDiagonal{-0.85f, 0.25f, 0.30f};
inline constexpr glm::vec3 kAcross{0.25f, 0.90f, 0.20f};

}  // namespace scumble::paint
