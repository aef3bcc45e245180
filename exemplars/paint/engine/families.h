// Families of lines: circles of latitude about one axis, side by side all over the sphere, each broken into strokes of
// a hand. Nothing here uses a canvas.
#pragma once

#include <cstdint>
#include <vector>

#include "exemplars/paint/engine/brush.h"
#include "exemplars/paint/engine/chance.h"
#include "exemplars/paint/engine/strokes.h"

namespace scumble::paint {

struct FamilyOptions {
  float spacing = 16.0f;      // units between neighbours, where the surface faces the viewer
  float unevenness = 0.18f;   // deviation of the spacing, as a share of it
  float length_min = 120.0f;  // of a stroke, before the touch cuts it
  float length_max = 320.0f;
  float overlap = 6.0f;    // units by which a stroke begins before the last one's end; negative leaves gaps
  float wander = 3.0f;     // units by which neighbours bend together
  float drift = 1.5f;      // deviation in units by which one stroke leaves its line from end to end
  float pressure = 0.15f;  // deviation of the pressure from stroke to stroke, as a share of it
  float taper = 0.22f;     // share of a stroke in which it begins, and in which it ends
  float cap = 0.05f;       // radians round the axis that stay empty: smaller rings would be dots
  float overhang = 26.0f;  // units past the rim, straight on
};

// One family about `axis`. Where it is nearly in the picture's plane, lines are shallow arcs of one direction; the
// nearer it is to the viewer, the more they bulge.
std::vector<Stroke> PlanFamily(Chance& chance, glm::vec3 axis, const Touch& touch, const FamilyOptions& options);

// A family whose pressure follows the target darkness: lifted below `begins`, from there on between `lightest` and
// `heaviest`, which is reached at `full`. Darkness is in [0, 1].
struct Swelling {
  glm::vec3 axis;
  float spacing;
  float begins, full;
  float lightest, heaviest;
};
struct SwellingHand {
  float ragged = 0.1f;  // random error of the darkness from place to place: ends of lines are uneven
  float cloud = 40.0f;  // units over which that error is of one sign
  FamilyOptions family;
};
// Draws its random numbers from (seed, stream). Lines fade out on the rim.
std::vector<Stroke> PlanSwelling(std::uint64_t seed, std::uint64_t stream, const Touch& darkness,
                                 const Swelling& swelling, const SwellingHand& hand);

// Short touches along the flow where the tool is to be set down only: one every `spacing` units at most, with the
// likelihood `density(at)` in [0, 1].
struct DotOptions {
  float spacing = 14.0f;
  float length_min = 3.0f;
  float length_max = 9.0f;
  float pressure_min = 0.3f;
  float pressure_max = 0.6f;
};
std::vector<Stroke> PlanDots(Chance& chance, const Flow& flow, const Touch& density, const DotOptions& options);

}  // namespace scumble::paint
