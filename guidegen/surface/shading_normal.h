// Shading normals as Cycles shades with them: bent where they would reflect the eye's ray into the surface.
//
// On a coarse mesh the interpolated normal may turn so far from a triangle that the mirrored ray would go below it, or
// face away from the eye. Cycles 3.4 (ensure_valid_reflection, which every surface closure applies) turns
// such a normal N towards the triangle's own normal G until the mirrored ray is as high above the triangle as
//   t = min(0.9 I·G, 0.01),  I the unit direction to the eye.
// N stays where (2 (N·I) N − I)·G ≥ t. With x the unit direction of N's part across G, and the turned normal
// x·sin θ + G·cos θ, the height is Ix·sin 2θ + Iz·cos 2θ, where Ix = I·x and Iz = I·G. It equals t at
//   cos 2θ = (Iz t − Ix √(a² − t²)) / a²,  a² = Ix² + Iz².
// The other sign of the root belongs to a normal on the other side of G. Cycles does not tell the two apart; if the
// wrong one leaves the mirrored ray at a height between 1e-5 and t, it is taken, and so it is here. This happens where
// I is nearly at right angles to x, and turns the normal up to 2° further.
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
// by a normal map, or bent. With g = (S·l) / ((N·l) (S·N)) it is 1 for g ≥ 1, 0 for g ≤ 0, and g + g² − g³ between, so
// that light fades out where it sinks below S (Chiang, Li & Burley, "Taming the shadow terminator", SIGGRAPH 2019
// Talks), as in Cycles 3.4. `smooth_normal` is SurfacePoint's: 0 means that S is N.
double ShadingNormalShadow(const glm::dvec3& normal, const glm::dvec3& smooth_normal, const glm::dvec3& to_light);

}  // namespace scumble
