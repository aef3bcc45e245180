// Plans strokes on the sphere. Nothing here uses a canvas.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "exemplars/paint/engine/brush.h"
#include "exemplars/paint/engine/chance.h"

namespace scumble::paint {

// The direction of a stroke at a place: the picture of a unit tangent of the sphere, so it is shorter where the surface
// turns away and strokes shorten with it.
using Flow = std::function<glm::vec2(glm::vec2 at)>;
// The target pressure at a place; 0 or less lifts the tool.
using Touch = std::function<float(glm::vec2 at)>;

// Circles of latitude about an axis: along the terminator when the axis is the light.
Flow AroundAxis(glm::vec3 axis);
// Meridians that run towards the axis: across the form when the axis is the light.
Flow TowardsAxis(glm::vec3 axis);

// A line of the flow through `middle` in both directions, `length` units long before foreshortening; `offset` shifts it
// sideways. Pressures are 1.
Stroke TraceStroke(const Flow& flow, glm::vec2 middle, float length, float offset = 0.0f);

// The place `offset` units beside the stroke's point `i`, to the right of its direction.
glm::vec2 Beside(const Stroke& stroke, std::size_t i, float offset);

// Multiplies the pressures by the touch under them and by a soft start and end, and cuts the stroke where the tool
// lifts.
std::vector<Stroke> Press(const Stroke& stroke, const Touch& touch, float gain = 1.0f, float taper = 0.22f);

// Hatching in patches, like a hand's: a few strokes side by side, then another place.
struct HatchOptions {
  int patches = 600;
  int strokes_min = 5;  // in a patch
  int strokes_max = 11;
  float spacing = 7.0f;  // between neighbours of a patch
  float length_min = 50.0f;
  float length_max = 110.0f;
  float sway = 0.16f;        // deviation of a patch's axis from the flow's, in its components
  float unevenness = 0.25f;  // of spacing, pressure and ends
};
// Patches are denser where the touch is heavier. `flow_of(axis)` makes a flow, AroundAxis for instance.
std::vector<Stroke> PlanHatching(Chance& chance, Flow (*flow_of)(glm::vec3), glm::vec3 axis, const Touch& touch,
                                 const HatchOptions& options);

// Places all over a square of that side, and past its edge by `margin`: one in each cell of a grid of that spacing,
// shifted randomly, in random order. Even cover without a pattern.
std::vector<glm::vec2> SowEvenly(Chance& chance, float spacing, float side = kSide, float margin = 24.0f);

// Broken, searching lines along the rim, `inset` ± deviation units inside it.
struct RimOptions {
  int lines = 14;
  float inset = 7.0f;
  float deviation = 4.0f;
  float length_min = 0.5f;  // radians
  float length_max = 1.3f;
};
std::vector<Stroke> PlanRim(Chance& chance, const Touch& touch, const RimOptions& options);

}  // namespace scumble::paint
