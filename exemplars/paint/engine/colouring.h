// A drawing in coloured sticks that is watched while it grows: seen with half-closed eyes, each stick goes where it
// brings the colour nearer to the one wanted. No colour is mixed beforehand; strokes of many lie side by side and over
// one another.
#pragma once

#include <functional>
#include <utility>

#include "exemplars/paint/engine/media.h"
#include "exemplars/paint/engine/paper.h"
#include "exemplars/paint/engine/strokes.h"

namespace scumble::paint {

struct Stick {
  glm::vec3 color;     // sRGB-encoded; of wax what a full layer lets through
  bool clear = false;  // chalk covers; wax is a glaze, and what lies below shines through
};

// The colours wanted, sRGB-encoded, at the places where the hand decides.
using Wish = Colors;
Wish MakeWish(const std::function<glm::vec3(glm::vec2 at)>& color_at);
glm::vec3 ColorIn(const Wish& wish, glm::vec2 at);

// How a hand presses: from `lightest` where a stick helps a little to `heaviest` where all of it is wanted; not at all
// where it would bring the colour nearer by less than `least`, a distance in encoded colour.
struct Hand {
  float lightest = 0.25f;
  float heaviest = 0.7f;
  float least = 0.04f;
  float reach = 2.0f;      // the stick stays away where its own colour is farther than this from the one wanted
  float overhang = 1.05f;  // strokes end at this many radii
};

// The same touch, but lifted round the poles of the circles about `axis`, where strokes would curl up.
Touch AwayFromPoles(const Touch& touch, glm::vec3 axis);

// How a stick's colour settles on the ground.
struct Settling {
  DryMedia media;
  float load = 1.0f;     // share of the colour that a firm stroke leaves: below 1 it catches on the peaks even there
  float crumble = 0.0f;  // share of the grain that is the stick's and not the paper's, and other with each stick
};

// Strokes as the side of a stick of that width leaves them: its facets are `facets` lines side by side, each pressed
// harder or less. Strokes shorter than `shortest` are left out, as they would read as dabs.
std::vector<Stroke> Facets(Chance& chance, const std::vector<Stroke>& strokes, float width, int facets, float shortest);

class Colouring {
 public:
  explicit Colouring(Ground ground) : tooth_(std::move(ground.tooth)), picture_(std::move(ground.paper)) {}

  const Colors& picture() const { return picture_; }
  const Field& tooth() const { return tooth_; }

  // Where to press with the stick, as the drawing stands now.
  Touch Nearer(const Wish& wish, const Stick& stick, const Hand& hand) const;

  void Draw(Brush& brush, const Stick& stick, const std::vector<Stroke>& strokes, const Settling& settling);
  // What Draw does with the strokes once they are painted: `layer` is of the ground's sheet.
  void Settle(Layer layer, const Stick& stick, const Settling& settling);

  // Drags what lies there along the strokes: a finger, a stump.
  void Rub(Brush& finger, const std::vector<Stroke>& strokes);

 private:
  Field Grain(float crumble);

  Field tooth_;
  Colors picture_;
  std::uint64_t drawn_ = 0;  // how many sticks
};

// Across what kAlongShade hatches (see drawing.h).
inline constexpr glm::vec3 kAgainst{0.70f, 0.71f, 0.05f};

}  // namespace scumble::paint
