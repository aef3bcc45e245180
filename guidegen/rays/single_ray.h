// Rays that go their own way, one at a time; packets of neighbouring rays are tile_caster.cpp's. Backs of single-sided
// surfaces are there for them, as for shadow rays.
#pragma once

#include <glm/glm.hpp>

#include "guidegen/rays/embree_scene.h"
#include "guidegen/rays/ray_offset.h"

namespace scumble {

// What counts as being in a ray's way: everything, or nothing but meshes that emit.
enum class Blockers { kAll, kEmitters };
// Whether the ray meets any of `blockers` before its reach ends. `target` is left out; by default there is none.
bool IsOccluded(const EmbreeScene& scene, const LightRay& ray, const ShadowTarget& target, Blockers blockers);

// The nearest hit in a direction; its geomID is RTC_INVALID_GEOMETRY_ID where there is none.
RTCRayHit CastSingleRay(const EmbreeScene& scene, const glm::dvec3& origin, const glm::dvec3& direction);
// The same with nothing but the meshes that emit.
RTCRayHit CastAmongEmitters(const EmbreeScene& scene, const glm::dvec3& origin, const glm::dvec3& direction);

}  // namespace scumble
