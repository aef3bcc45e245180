// Rays of light within Embree's limits: their start and end, farther from surfaces than the error of floats.
#pragma once

#include <glm/glm.hpp>

#include "guidegen/scene/view_ray.h"
#include "guidegen/surface/surface.h"

namespace scumble {

// The distance in metres between a ray's end and its light: the largest error of Embree's floats at the ray's two ends.
// A nearer surface may be the wall that the light is mounted on. So a wall hides a light behind it if the light is
// farther from it than this gap plus the wall's own rounding: 2⁻¹⁹ of the largest coordinate of the wall's triangle,
// the light and the lit point. Analytic lights have no surface; ShadowTarget keeps an emissive mesh from shading
// itself.
double LightGap(const glm::dvec3& origin, const glm::dvec3& light);

// A ray of light within Embree's limits, at any distance. If the ray is too long for a direction, the direction is
// shorter, and `end` and `reach` are larger. If a surface lies at the end of Embree's range, the origin stays within
// that range.
struct LightRay {
  glm::dvec3 origin;
  glm::dvec3 direction;
  double end;    // the light's place, in lengths of the direction; infinite for an endless ray
  double reach;  // the distance up to which surfaces block it: short of the end by LightGap
};
LightRay LightRayTo(const glm::dvec3& origin, const glm::dvec3& light);
LightRay EndlessLightRay(const glm::dvec3& origin, const glm::dvec3& direction);  // a unit vector

// SurfacePoint::max_ray_offset of a hit point. The ray passed nothing from `clear_from` lengths of its direction up to
// the point. 0 where float has put that place behind the point.
glm::dvec3 MaxRayOffset(const ViewRay& ray, double clear_from, const glm::dvec3& point);

// The start of a shadow ray: above the surface, on the viewer's side, by more than the error of Embree's floats. If the
// point has a max_ray_offset, the origin moves along it, so that no other surface lies between. Near an edge whose
// surfaces meet at less than a right angle, an offset along the normal would leave the corner.
glm::dvec3 ShadowRayOrigin(const SurfacePoint& point);

}  // namespace scumble
