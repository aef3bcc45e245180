// Glazes: each is a scatter of wet strokes over dried layers. As they dry, pigment gathers at their edges and in the
// paper's hollows, and light passes through every layer to the paper and back.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>

#include "exemplars/paint/engine/brush.h"
#include "exemplars/paint/engine/canvas.h"
#include "exemplars/paint/engine/chance.h"
#include "exemplars/paint/engine/strokes.h"

namespace scumble::paint {

struct Glaze {
  glm::vec3 pigment;  // the transmission of one full layer
  glm::vec3 drift;    // the pigment it runs into
  float below;        // painted where the value is below this
  float ragged;       // the random shift of that border
  float spacing;      // of the strokes: below their width they flow together into a wash
  float radius;
  float density;
  float edge;             // gathering at the edges
  float wetness;          // share of the edges that bleed away
  float length = 8.0f;    // of the strokes, in radii
  float lobes = 70.0f;    // width of the random shifts
  float shortest = 2.6f;  // radii: shorter remainders at a border are left out
};

// The place and the direction of a glaze.
struct GlazePlan {
  Touch value;                               // painted where it is below the glaze's border
  std::function<Flow(Chance& chance)> flow;  // called anew for each stroke
};
// Circles around an axis; each stroke's own axis differs by that deviation.
std::function<Flow(Chance& chance)> SwayingRound(glm::vec3 axis, float deviation);

// Paints a glaze and lets it dry into the picture. `brush` has any opaque colour. Random numbers come from (seed, pass)
// alone.
void LayGlaze(Colors& picture, Brush& brush, const Field& tooth, const Glaze& glaze, const GlazePlan& plan,
              std::uint64_t seed, std::uint64_t pass);

}  // namespace scumble::paint
