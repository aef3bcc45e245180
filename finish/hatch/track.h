// Strokes that stick to surfaces.
//
// In the space of the layer pref they lie where planes cut the surface, so they go with it.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "finish/hatch/axis.h"

namespace scumble::internal {

// Strokes on a surface, by layer. Their distance in pref is a power of two, `step`, at most the one that is wanted; by
// `coarser` of 0 … 1, its double is nearer to that.
struct Track {
  struct OfLayer {
    glm::vec3 along, across;     // unit vectors
    float pixel, step, coarser;  // pixel: how far pref goes across the strokes in one
    Axis axis;                   // of the strokes in the picture
  };
  std::array<OfLayer, kMostLayers> layers = {};
  bool is_there = false;
};

// The directions that such strokes have: so few that those of neighbouring patches join, and a smaller picture or the
// next frame repeats them.
std::vector<glm::vec3> AllWays();

// `per_x`, `per_y`: how far pref goes in a pixel along a row and a column. `axis`: of the strokes in the picture.
// Nothing is there where the surface is seen from its edge.
Track TrackOf(const HatchPass& pass, float spacing, glm::vec3 per_x, glm::vec3 per_y, Axis axis,
              const std::vector<glm::vec3>& ways);

}  // namespace scumble::internal
