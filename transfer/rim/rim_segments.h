// Places segments of the exemplar's rim along an outline.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "transfer/rim/silhouettes.h"
#include "transfer/seeds/seeds.h"

namespace scumble::internal {

// A segment of the rim laid along an outline. At `point` it shows the rim's paint in the direction `outward`. Away from
// `point` the rim turns as on the sphere.
struct RimSegment {
  glm::vec2 point{0.0f};
  glm::vec2 outward{1.0f, 0.0f};
  std::int32_t seed = -1;  // segments of one seed are equal

  // The unit direction of the rim at a point of the picture, for a sphere of that radius. On a sphere of the exemplar's
  // own size it is the direction from the sphere's centre.
  glm::vec2 DirectionAt(glm::vec2 at, float radius) const {
    const glm::vec2 v = radius * outward + (at - point);
    const float length = std::sqrt(v.x * v.x + v.y * v.y);
    return length > 0.0f ? v / length : outward;
  }
};

// Up to three segments that are blended where they meet.
struct RimSegments {
  std::array<RimSegment, 3> segment;
  std::array<float, 3> weight{};  // sum 1; from the heaviest down, 0: none
};

struct RimSegmentInput {
  const Silhouettes& silhouettes;
  std::span<const float> radii;      // by style: of the exemplar's sphere in pixels; see Silhouettes for styles
  std::span<const SeedRules> seeds;  // by style
  Region region;                     // outline pixels in it get segments
};

// The distance outside `region` in which outlines must be known, pixels: for seeds and their surroundings.
int RimSegmentMargin(int level_offset, int band);

// StyleBlit's chunks (Sýkora et al. 2019) along outlines, with the direction as the only guide. Seeds are outline
// pixels, one in each cell of a grid and object, on grids of 2^6 … 2^3 pixels, which follow the output's height. An
// outline pixel takes the segment of the nearest seed if the rim there faces as the outline does, within 0.3 rad; else
// its own. On a straight outline all seeds would take one segment. There each starts up to 0.5 rad to either side, by
// its hash; if the outline turns as strongly as the exemplar's rim, the shift is 0. By outline pixel; weights are 0
// outside the region.
std::vector<RimSegments> ChooseRimSegments(const RimSegmentInput& input);

}  // namespace scumble::internal
