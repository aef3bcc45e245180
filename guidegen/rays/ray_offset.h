// Rays of light as Embree can take them: where they start and end, farther from surfaces than floats can be wrong.
#pragma once

#include <glm/glm.hpp>

#include "guidegen/scene/view_ray.h"
#include "guidegen/surface/surface.h"

namespace scumble {

// How far Embree's floats may be from a surface, for each metre of its largest coordinate C. Across the surface, in
// units of u = 2⁻²⁴: corners and the ray's origin, rounded to float, are off by √3 C each; the ray's direction by 1 for
// each metre of its length on the triangle; the corners relative to the origin, and the three products of that vector
// with the normal, by 1 and 3 for each metre of the triangle's length L, and the normal itself, which comes of two
// products of edges, by 4 L over the sine between them. That is 2√3 C + 5 L + 4 L / sine, and 16 C covers it for
// triangles up to L = 1.39 C. (Larger ones fill the view, and their errors never all have one sign: measured, 2 C is
// enough for them, and 8 C for slivers.)
inline constexpr double kRoundingPerCoordinate = 0x1.0p-20;

// How far from a light a ray ends, in metres: the most that Embree's floats put its two ends off. A nearer surface may
// be the wall that the light is mounted on. So a wall hides a light behind it if the light is farther from it than this
// gap and the wall's own rounding together: 2⁻¹⁹ of the largest coordinate of the wall's triangle, the light and the
// lit point. Analytic lights have no surface; ShadowTarget keeps an emissive mesh from shading itself.
double LightGap(const glm::dvec3& origin, const glm::dvec3& light);

// A ray of light as Embree can take it, at any distance. If it is too long for a direction, the direction is shorter,
// and `end` and `reach` are larger. If a surface lies at the end of Embree's range, the origin stays within that range.
struct LightRay {
  glm::dvec3 origin;
  glm::dvec3 direction;
  double end;    // where the light is, in lengths of the direction; infinite for an endless ray
  double reach;  // how far surfaces block it: short of the end by LightGap
};
LightRay LightRayTo(const glm::dvec3& origin, const glm::dvec3& light);
LightRay EndlessLightRay(const glm::dvec3& origin, const glm::dvec3& direction);  // a unit vector

// SurfacePoint::max_ray_offset of a point that a ray met. The ray passed nothing from `clear_from` lengths of its
// direction up to the point. 0 where float has put that place behind the point.
glm::dvec3 MaxRayOffset(const ViewRay& ray, double clear_from, const glm::dvec3& point);

// Where a shadow ray starts: above the surface, on the viewer's side, by more than Embree's floats can be wrong. If the
// point has a max_ray_offset, the origin moves along it, so that no other surface comes to lie between: beside an edge
// where surfaces meet at less than a right angle, an offset along the normal would leave the corner.
glm::dvec3 ShadowRayOrigin(const SurfacePoint& point);

}  // namespace scumble
