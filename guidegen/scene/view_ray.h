// A ray in view space and in double.
#pragma once

#include <glm/glm.hpp>

namespace scumble {

// Embree accepts no ray with a larger component, of its origin in metres or of its direction: built with assertions, as
// Debian's is, it ends the process. Its own limit is 1.844e18.
inline constexpr double kLargestInRay = 0x1.9p60;

// `direction.z` is exactly −1, so that the ray's parameter is the planar depth.
struct ViewRay {
  glm::dvec3 origin{0.0};
  glm::dvec3 direction{0.0, 0.0, -1.0};
  // The width of the pixel's footprint at the origin, m, and its growth for each metre: the distance over which bumps
  // are measured. 0: unknown, and bumps are flat.
  double width = 0.0;
  double spread = 0.0;
};

}  // namespace scumble
