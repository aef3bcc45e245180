#include "guidegen/single_ray.h"

#include <algorithm>
#include <limits>

namespace scumble {
namespace {

RTCRay MakeRay(const glm::dvec3& origin, const glm::dvec3& way, double length) {
  RTCRay ray = {};
  ray.org_x = float(origin.x);
  ray.org_y = float(origin.y);
  ray.org_z = float(origin.z);
  ray.dir_x = float(way.x);
  ray.dir_y = float(way.y);
  ray.dir_z = float(way.z);
  ray.tfar = float(length);
  ray.mask = ~0u;
  return ray;
}

CastContext SingleRays() {
  CastContext context(false);
  context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

bool Occluded(RTCScene scene, const glm::dvec3& origin, const glm::dvec3& way, double length,
              const ShadowTarget& target) {
  CastContext context = SingleRays();
  context.target = target;
  RTCRay ray = MakeRay(origin, way, length);
  rtcOccluded1(scene, &context.embree, &ray);
  return ray.tfar < 0.0f;
}

RTCRayHit Cast(RTCScene scene, const glm::dvec3& origin, const glm::dvec3& direction) {
  CastContext context = SingleRays();
  RTCRayHit hit = {MakeRay(origin, direction, std::numeric_limits<double>::infinity()), {}};
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  if (scene) rtcIntersect1(scene, &context.embree, &hit);
  return hit;
}

}  // namespace

bool IsBlocked(const EmbreeScene& scene, const glm::dvec3& origin, const LightDraw& draw, Blockers blockers) {
  const RTCScene among = blockers == Blockers::kAll ? scene.handle() : scene.emitters();
  if (!among) return false;
  if (draw.endless) return Occluded(among, origin, draw.direction, std::numeric_limits<double>::infinity(), {});
  const glm::dvec3 way = draw.target - origin;
  if (draw.object == LightDraw::kNoObject) return Occluded(among, origin, way, kShadowReach, {});
  const double near_end = std::clamp(1.0 - draw.rounding / glm::length(way), 0.0, kShadowReach);
  return Occluded(among, origin, way, kShadowReach, {&scene.objects()[draw.object], draw.primitive, float(near_end)});
}

RTCRayHit CastSingleRay(const EmbreeScene& scene, const glm::dvec3& origin, const glm::dvec3& direction) {
  return Cast(scene.handle(), origin, direction);
}

RTCRayHit CastAmongEmitters(const EmbreeScene& scene, const glm::dvec3& origin, const glm::dvec3& direction) {
  return Cast(scene.emitters(), origin, direction);
}

}  // namespace scumble
