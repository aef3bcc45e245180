#include "guidegen/light/light_visibility.h"

#include <algorithm>

#include "guidegen/rays/ray_offset.h"

namespace scumble {

bool IsBlocked(const EmbreeScene& scene, const glm::dvec3& origin, const LightDraw& draw, Blockers blockers) {
  if (draw.endless) return IsOccluded(scene, EndlessLightRay(origin, draw.direction), {}, blockers);
  const LightRay ray = LightRayTo(origin, draw.target);
  if (draw.object == LightDraw::kNoObject) return IsOccluded(scene, ray, {}, blockers);
  const double near_end = std::max(0.0, ray.end - draw.rounding / glm::length(ray.direction));
  return IsOccluded(scene, ray, {&scene.objects()[draw.object], draw.primitive, float(near_end)}, blockers);
}

}  // namespace scumble
