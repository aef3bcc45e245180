#include "guidegen/light/light_visibility.h"

#include <algorithm>

namespace scumble {

LightRay RayTo(const glm::dvec3& origin, const LightDraw& draw) {
  return draw.endless ? EndlessLightRay(origin, draw.direction) : LightRayTo(origin, draw.target);
}

bool IsBlocked(const EmbreeScene& scene, const glm::dvec3& origin, const LightDraw& draw, Blockers blockers) {
  const LightRay ray = RayTo(origin, draw);
  if (draw.object == LightDraw::kNoObject) return IsOccluded(scene, ray, {}, blockers);
  const double near_end = std::max(0.0, ray.end - draw.rounding / glm::length(ray.direction));
  return IsOccluded(scene, ray, {&scene.objects()[draw.object], draw.primitive, float(near_end)}, blockers);
}

}  // namespace scumble
