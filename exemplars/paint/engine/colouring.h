// A drawing in coloured sticks with feedback. The current drawing is blurred, and each stick goes where it brings the
// colour nearer to the target. No colour is mixed beforehand; strokes of many colours lie side by side and over one
// another.
#pragma once

#include <functional>
#include <utility>

#include "exemplars/paint/engine/media.h"
#include "exemplars/paint/engine/paper.h"
#include "exemplars/paint/engine/strokes.h"

namespace scumble::paint {

struct Stick {
  glm::vec3 color;     // sRGB-encoded; of wax the transmission of a full layer
  bool clear = false;  // chalk covers; wax is a glaze, and lower layers shine through
};

// The target colours, sRGB-encoded, at the places of decisions.
using TargetColors = Colors;
TargetColors MakeTargetColors(const std::function<glm::vec3(glm::vec2 at)>& color_at);
glm::vec3 ColorIn(const TargetColors& target_colors, glm::vec2 at);

// The pressure of a hand: from `lightest` where a stick helps little to `heaviest` where the full stick is needed. No
// stroke where the stick would bring the colour nearer by less than `least`, a distance in encoded colour.
struct Hand {
  float lightest = 0.25f;
  float heaviest = 0.7f;
  float least = 0.04f;
  float reach = 2.0f;      // the stick is not used where its own colour is farther than this from the target
  float overhang = 1.05f;  // strokes end at this many radii
};

// The touch, but lifted around the poles of the circles about `axis`, where strokes would curl.
Touch AwayFromPoles(const Touch& touch, glm::vec3 axis);

// How a stick's colour settles on the ground.
struct Settling {
  DryMedia media;
  float load = 1.0f;  // share of the colour that a firm stroke leaves: below 1 it catches on the peaks only
  float crumble =
      0.0f;  // share of the grain that belongs to the stick and not to the paper, and differs between sticks
};

// Strokes of the side of a stick of that width: its facets are `facets` lines side by side, of varying pressure.
// Strokes shorter than `shortest` are left out, as they would look like dabs.
std::vector<Stroke> Facets(Chance& chance, const std::vector<Stroke>& strokes, float width, int facets, float shortest);

class Colouring {
 public:
  explicit Colouring(Ground ground) : tooth_(std::move(ground.tooth)), picture_(std::move(ground.paper)) {}

  const Colors& picture() const { return picture_; }
  const Field& tooth() const { return tooth_; }

  // The touch of the stick, for the current drawing.
  Touch Nearer(const TargetColors& target_colors, const Stick& stick, const Hand& hand) const;

  void Draw(Brush& brush, const Stick& stick, const std::vector<Stroke>& strokes, const Settling& settling);
  // The last step of Draw: the painted strokes settle. `layer` is of the ground's sheet.
  void Settle(Layer layer, const Stick& stick, const Settling& settling);

  // Smears the colours along the strokes: a finger, a stump.
  void Rub(Brush& finger, const std::vector<Stroke>& strokes);

 private:
  Field Grain(float crumble);

  Field tooth_;
  Colors picture_;
  std::uint64_t drawn_ = 0;  // number of sticks
};

// The axis across the hatching of kAlongShade (see drawing.h).
inline constexpr glm::vec3 kAgainst{0.70f, 0.71f, 0.05f};

}  // namespace scumble::paint
