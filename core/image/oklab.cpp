#include "core/image/oklab.h"

#include <cmath>

#include "core/image/scalar_lane.h"

namespace scumble {
namespace {

float SignedCubeRoot(float x) { return std::copysign(scalar::CubeRoot(std::fabs(x)), x); }

}  // namespace

glm::vec3 OklabFromLinear(glm::vec3 rgb) {
  const scalar::LaneColor cones = scalar::ConesFromLinear({rgb.r, rgb.g, rgb.b});
  const scalar::LaneColor lab = scalar::OklabFromRoots(scalar::Each(SignedCubeRoot, cones));
  return {lab.r, lab.g, lab.b};
}

glm::vec3 LinearFromOklab(glm::vec3 lab) {
  const scalar::LaneColor rgb = scalar::LinearFromRoots(scalar::RootsFromOklab({lab.x, lab.y, lab.z}));
  return {rgb.r, rgb.g, rgb.b};
}

}  // namespace scumble
