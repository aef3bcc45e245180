// Rays that go their own way, one at a time; packets of neighbouring rays are tile_caster.cpp's. Backs of single-sided
// surfaces are there for them, as for shadow rays.
#pragma once

#include <glm/glm.hpp>

#include "guidegen/embree_scene.h"
#include "guidegen/light_sampling.h"

namespace scumble {

// Whether anything lies within `length` lengths of `way`, but for the place that the ray goes to.
bool IsBlocked(const EmbreeScene& scene, const glm::dvec3& origin, const glm::dvec3& way, double length,
               const ShadowTarget& target = {});

// Whether anything lies between a surface and the light that was drawn from it.
bool IsBlocked(const EmbreeScene& scene, const glm::dvec3& origin, const LightDraw& draw);

// The nearest hit in a direction; its geomID is RTC_INVALID_GEOMETRY_ID where there is none.
RTCRayHit CastSingleRay(const EmbreeScene& scene, const glm::dvec3& origin, const glm::dvec3& direction);

}  // namespace scumble
