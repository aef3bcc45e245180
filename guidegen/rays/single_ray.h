// Incoherent rays, cast one at a time. Like shadow rays they hit the backs of single-sided surfaces.
#pragma once

#include <glm/glm.hpp>

#include "guidegen/rays/embree_scene.h"
#include "guidegen/rays/ray_offset.h"

namespace scumble {

// What can block a ray: all objects, or only meshes that emit.
enum class Blockers { kAll, kEmitters };
// Whether the ray hits any of `blockers` within its reach. `target`, if it names an object, does not count.
bool IsOccluded(const EmbreeScene& scene, const LightRay& ray, const ShadowTarget& target, Blockers blockers);

// The nearest hit in a direction; its geomID is RTC_INVALID_GEOMETRY_ID where there is none.
RTCRayHit CastSingleRay(const EmbreeScene& scene, const glm::dvec3& origin, const glm::dvec3& direction);
// CastSingleRay among the meshes that emit.
RTCRayHit CastAmongEmitters(const EmbreeScene& scene, const glm::dvec3& origin, const glm::dvec3& direction);

}  // namespace scumble
