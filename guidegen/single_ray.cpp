#include "guidegen/single_ray.h"

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

}  // namespace

bool IsBlocked(const EmbreeScene& scene, const glm::dvec3& origin, const glm::dvec3& way, double length) {
  CastContext context = SingleRays();
  RTCRay ray = MakeRay(origin, way, length);
  rtcOccluded1(scene.handle(), &context.embree, &ray);
  return ray.tfar < 0.0f;
}

RTCRayHit CastSingleRay(const EmbreeScene& scene, const glm::dvec3& origin, const glm::dvec3& direction) {
  CastContext context = SingleRays();
  RTCRayHit hit = {MakeRay(origin, direction, std::numeric_limits<double>::infinity()), {}};
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene.handle(), &context.embree, &hit);
  return hit;
}

}  // namespace scumble
