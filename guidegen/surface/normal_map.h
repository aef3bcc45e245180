// Shading normals by normal maps and bumps, as Cycles 3.4 has them (its nodes Normal Map and Bump).
//
// A normal map's value m = 2c − 1 is taken in the frame of the interpolated normal n, the interpolated tangent t and
// w n × t, none of which is made unit before: MikkTSpace's definition. By glTF's rule its x and y are multiplied by the
// scale. By Cycles' rule the unit mapped normal M is mixed with the unit interpolated one N, N + (M − N) · strength. By
// that of Cycles 4 (Material::cycles4) m is (s·x, s·y, 1 + (z − 1) · min(s, 1)), where s is the strength; maps in
// object space keep the other rule.
//
// A bump measures a height h at three places, the point itself and two at the distance of a pixel's footprint in the
// triangle's plane, dx and dy, at right angles. From the normal n, mapped or interpolated,
//   det = dx · (dy × n),  g = (h(dx) − h)(dy × n) + (h(dy) − h)(n × dx),  |det| n − distance · sign(det) · g
// made unit is the normal of the risen surface, which the strength mixes with n (Mikkelsen, "Bump mapping
// unparametrized surfaces on the GPU", 2010). So it depends on the picture's size, as in Cycles. dx = (1, 1, 1) ×
// facing in the axes of Blender's world, dy = facing × dx. Behind the surface the two places are on the other side of
// the point.
#pragma once

#include <glm/glm.hpp>

#include "guidegen/surface/surface.h"

namespace scumble {

// Both are false where the mesh lacks the coordinates or tangents for it.
bool HasNormalMap(const PlacedObject& object);
bool HasBump(const PlacedObject& object);
// Whether the shading normal is more than the corners' normals, interpolated.
inline bool ChangesNormals(const PlacedObject& object) { return HasNormalMap(object) || HasBump(object); }

// The normal of the map's texel in the mesh's space, not unit and without the strength that MixedNormal applies.
glm::dvec3 MappedNormal(const PlacedObject& object, const glm::uvec3& corners, const glm::dvec2& barycentric);

// The map's strength by Cycles' rules; `mapped` and `smooth` are unit vectors in one space.
glm::dvec3 MixedNormal(const PlacedObject& object, const glm::dvec3& mapped, const glm::dvec3& smooth);

struct BumpPlace {
  glm::dvec2 barycentric;
  glm::dvec3 facing;  // SurfacePoint's
  double side;        // −1 behind the surface, 1 before it
  double width;       // of the pixel's footprint, m
};
// `triangle` and `normal` are in view space; the result is a unit vector.
glm::dvec3 BumpedNormal(const PlacedObject& object, const glm::uvec3& corners, const Triangle& triangle,
                        const BumpPlace& place, const glm::dvec3& normal);

}  // namespace scumble
