// A drawing in a dry medium that is watched while it grows: where the tone is still too light the hand goes back.
#pragma once

#include <functional>

#include "exemplars/paint/media.h"
#include "exemplars/paint/strokes.h"

namespace scumble::paint {

class Drawing {
 public:
  // `ground` is the bare paper with the given tooth; `media` says how the layer settles on it.
  Drawing(Colors ground, Field tooth, const DryMedia& media);

  Canvas& canvas() { return canvas_; }

  // The drawing as it stands.
  Colors Look() const;

  // A touch that presses in proportion to what is missing from `target`, the darkness wanted there in [0, 1], in the
  // drawing as it stands now: `eagerness` times the difference, `heaviest` at most. Seen with half-closed eyes, that is
  // blurred, so it answers to tone and not to single strokes. Ends a little way past the rim. A negative eagerness is
  // for chalk: it presses where the drawing is still too dark.
  Touch Missing(const Touch& target, float eagerness, float heaviest) const;

 private:
  Colors ground_;
  Field tooth_;
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

}  // namespace scumble::paint
