// Which piece of the exemplar's rim goes where along an outline.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "transfer/outline/silhouettes.h"
#include "transfer/seeds/seeds.h"

namespace scumble::internal {

// A piece of the rim laid along an outline: at `point` it shows what the rim shows in the direction `outward`, and away
// from it the rim turns on as it does on the sphere.
struct RimSegment {
  glm::vec2 point{0.0f};
  glm::vec2 outward{1.0f, 0.0f};
  std::int32_t seed = -1;  // pieces of one seed are the same

  // The unit direction of the rim at a point of the picture, for a sphere of that radius. On a ball of the exemplar's
  // own size it is the direction from the ball's centre.
  glm::vec2 DirectionAt(glm::vec2 at, float radius) const {
    const glm::vec2 v = radius * outward + (at - point);
    const float length = std::sqrt(v.x * v.x + v.y * v.y);
    return length > 0.0f ? v / length : outward;
  }
};

// Up to three pieces melt into one another where they meet.
struct RimSegments {
  std::array<RimSegment, 3> piece;
  std::array<float, 3> weight{};  // sum 1; from the heaviest down, 0: none
};

struct RimSegmentInput {
  const Silhouettes& silhouettes;
  std::span<const float> radii;      // by style: of the exemplar's sphere in pixels; see Silhouettes for styles
  std::span<const SeedRules> seeds;  // by style
  Region region;                     // outline pixels in it get pieces
};

// How far outside `region` outlines must be known, pixels: seeds and what surrounds them.
int RimSegmentMargin(int level_offset, int band);

// StyleBlit's chunks (Sýkora et al. 2019) along outlines, with the direction as the only guide. Seeds are outline
// pixels, one in each cell of a grid and object; on 2^6 … 2^3 pixels, which follow the output's height, an outline
// pixel takes the piece of the nearest seed if the rim there faces as the outline does, within 0.3 rad; else its own.
// On a straight outline all seeds would take the same piece: there each starts up to 0.5 rad to either side, by its
// hash; a turn as strong as the exemplar's own leaves no such freedom. By outline pixel; weights are 0 outside the
// region.
std::vector<RimSegments> ChooseRimSegments(const RimSegmentInput& input);

}  // namespace scumble::internal
