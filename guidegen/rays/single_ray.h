// Rays that go their own way, one at a time; packets of neighbouring rays are tile_caster.cpp's. Backs of single-sided
// surfaces are there for them, as for shadow rays.
#pragma once

#include <glm/glm.hpp>

#include "guidegen/rays/embree_scene.h"
#include "guidegen/light/light_sampling.h"

namespace scumble {

// Whether anything lies between a surface and the light that was drawn from it. With kEmitters nothing but meshes that
// emit can be in the way.
enum class Blockers { kAll, kEmitters };
bool IsBlocked(const EmbreeScene& scene, const glm::dvec3& origin, const LightDraw& draw,
               Blockers blockers = Blockers::kAll);

// The nearest hit in a direction; its geomID is RTC_INVALID_GEOMETRY_ID where there is none.
RTCRayHit CastSingleRay(const EmbreeScene& scene, const glm::dvec3& origin, const glm::dvec3& direction);
// The same with nothing but the meshes that emit.
RTCRayHit CastAmongEmitters(const EmbreeScene& scene, const glm::dvec3& origin, const glm::dvec3& direction);

}  // namespace scumble
