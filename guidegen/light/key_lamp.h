// The lamp that the layer `cosine` is measured to.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "guidegen/scene.h"

namespace scumble {

// World space, or that of a view.
struct KeyLamp {
  bool endless = false;  // a sun
  glm::dvec3 at{0.0};    // the lamp's centre; of a sun the unit vector towards it

  // The unit vector from a point to the lamp; 0 at its centre.
  glm::dvec3 Towards(const glm::dvec3& point) const;
};

// The lamp of the largest irradiance at the centre of the sphere around the scene, if nothing blocked its light and all
// lamps shone to all sides: suns E, points and spots I/d², area lights and each instance of a mesh that emits radiance
// · area / d². Luminances count, textures of emission do not. Of equal ones the first, lights before meshes. None where
// nothing but the world shines. The lights have passed PlaceLights. O(vertices).
std::optional<KeyLamp> FindKeyLamp(const Scene& scene);

}  // namespace scumble
