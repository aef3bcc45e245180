#include "guidegen/rays/single_ray.h"

namespace scumble {
namespace {

RTCRay MakeRay(const LightRay& from) {
  RTCRay ray = {};
  ray.org_x = float(from.origin.x);
  ray.org_y = float(from.origin.y);
  ray.org_z = float(from.origin.z);
  ray.dir_x = float(from.direction.x);
  ray.dir_y = float(from.direction.y);
  ray.dir_z = float(from.direction.z);
  ray.tfar = float(from.reach);
  ray.mask = ~0u;
  return ray;
}

bool Occluded(RTCScene scene, const LightRay& light_ray, const ShadowTarget& target) {
  CastContext context(false, RayOrder::kIncoherent);
  context.target = target;
  RTCRay ray = MakeRay(light_ray);
  Occlude(scene, context.query, ray);
  return ray.tfar < 0.0f;
}

RTCRayHit Cast(RTCScene scene, const glm::dvec3& origin, const glm::dvec3& direction) {
  CastContext context(false, RayOrder::kIncoherent);
  RTCRayHit hit = {MakeRay(EndlessLightRay(origin, direction)), {}};
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  if (scene) Intersect(scene, context.query, hit);
  return hit;
}

}  // namespace

bool IsOccluded(const EmbreeScene& scene, const LightRay& ray, const ShadowTarget& target, Blockers blockers) {
  const RTCScene among = blockers == Blockers::kAll ? scene.handle() : scene.emitters();
  return among && Occluded(among, ray, target);
}

RTCRayHit CastSingleRay(const EmbreeScene& scene, const glm::dvec3& origin, const glm::dvec3& direction) {
  return Cast(scene.handle(), origin, direction);
}

RTCRayHit CastAmongEmitters(const EmbreeScene& scene, const glm::dvec3& origin, const glm::dvec3& direction) {
  return Cast(scene.emitters(), origin, direction);
}

}  // namespace scumble
