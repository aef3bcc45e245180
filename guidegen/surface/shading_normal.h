// Shading normals as Cycles shades with them: bent where they would reflect the eye's ray into the surface.
//
// On a coarse mesh the interpolated normal N may turn far from the triangle's own normal G. The mirrored ray would go
// below the triangle, or N would face away from the eye. Such a normal is turned towards G until the mirrored ray is as
// high above the triangle as t = min(0.9 I·G, 0.01), I the unit direction to the eye. N stays where (2 (N·I) N − I)·G ≥
// t. Cycles 3.4 does so for every surface closure (docs/numerics.md, "The bend of a shading normal").
//
// Only surfaces that reflect have closures: a black one, and one that emits only, keep their normals. The Normal pass
// is the mean of the closures' normals, and so the turned one. All this was measured with Blender 3.4.1, closure by
// closure. In Cycles 4 diffuse closures keep N (Material::cycles4). Where a metallic-roughness surface has both lobes,
// N stays for the Normal layer and the diffuse lobe, and SurfaceBsdf turns it for the specular one.
#pragma once

#include <glm/glm.hpp>

#include "guidegen/surface/surface.h"

namespace scumble {

// The share of Iz, and the height, of which t is the smaller.
inline constexpr double kReflectionShare = 0.9;
inline constexpr double kReflectionHeight = 0.01;

// All are unit vectors; `facing` is the geometric normal on the eye's side.
glm::dvec3 BentNormal(const glm::dvec3& facing, const glm::dvec3& to_eye, const glm::dvec3& normal);

// Bends the shading normal of a point that a ray has hit, unless its material reflects nothing.
void BendShadingNormal(const PlacedObject& object, const ViewRay& ray, SurfacePoint& point);

// The share that a diffuse surface reflects in one direction, because its shading normal N is not the interpolated S:
// by a normal map, or bent. With g = (S·l) / ((N·l) (S·N)) it is 1 for g ≥ 1, 0 for g ≤ 0, and g + g² − g³ between. So
// light fades out where it sinks below S, as in Cycles 3.4 (Chiang, Li & Burley, "Taming the shadow terminator",
// SIGGRAPH 2019 Talks). `smooth_normal` is SurfacePoint's: 0 means that S is N.
double ShadingNormalShadow(const glm::dvec3& normal, const glm::dvec3& smooth_normal, const glm::dvec3& to_light);

}  // namespace scumble
