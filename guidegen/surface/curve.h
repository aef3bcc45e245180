// The surface of hair: points of Catmull–Rom curves that a ray meets.
//
// Flat curves are turned to the ray, and their normals are rounded as if they were round: Cycles' "rounded ribbons".
// With T the curve's tangent, D the ray's direction and B = T × −D, both unit, and s in [−1, 1] the place across the
// ribbon, N = s B − √(1 − s²) T × B. Round curves have the normal from their middle line to the point. Both as Cycles
// 3.4 has them (intern/cycles/kernel/geom/curve_intersect.h, curve_shader_setup), without its code.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "guidegen/surface/surface.h"

namespace scumble {

// Control points of a segment in view space, in double, and their radii.
struct CurveSegment {
  glm::dvec3 points[4];
  double radii[4];

  // The middle line at u in [0, 1], its first and its second derivative, and the radius.
  glm::dvec3 At(double u) const;
  glm::dvec3 Tangent(double u) const;
  glm::dvec3 Bend(double u) const;
  double RadiusAt(double u) const;
};
CurveSegment ViewSegment(const PlacedObject& object, std::uint32_t segment);

// The object's radii in view space are those of the file times this.
double RadiusScale(const PlacedObject& object);

// The point of a segment's surface that the ray meets, where Embree said that it does: with the barycentric.x of the
// place along the segment. The position of a ribbon is on the plane that it turns to the viewer. Rays of light start a
// radius away, so that the ribbon, which then turns to them, does not shade itself.
SurfacePoint FindCurvePoint(const PlacedObject& object, std::uint32_t segment, const ViewRay& ray);

// The place at u of a segment's middle line before any deformation, object space.
glm::dvec3 RestPlaceOfCurve(const PlacedObject& object, std::uint32_t segment, double u);

}  // namespace scumble
