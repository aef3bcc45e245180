// Whether a light is visible from a surface.
#pragma once

#include <glm/glm.hpp>

#include "guidegen/light/light_sampling.h"
#include "guidegen/rays/ray_offset.h"
#include "guidegen/rays/single_ray.h"

namespace scumble {

// The ray from a surface to the light that was drawn from it.
LightRay RayTo(const glm::dvec3& origin, const LightDraw& draw);

// Whether any of `blockers` lies between a surface and the light that was drawn from it.
bool IsBlocked(const EmbreeScene& scene, const glm::dvec3& origin, const LightDraw& draw,
               Blockers blockers = Blockers::kAll);

}  // namespace scumble
