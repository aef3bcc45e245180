// The exact surface point of a hit: position, normals, base colour.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>

#include "guidegen/scene.h"
#include "guidegen/scene/view_ray.h"
#include "scumble/picture.h"

namespace scumble {

// An instance placed before the camera. Borrows the scene's data, which must outlive it.
struct PlacedObject {
  const Mesh* mesh = nullptr;  // null: the unit sphere about the object's origin
  const Material* material = nullptr;
  std::span<const Picture> textures;
  glm::dmat4 view_from_object{1.0};
  std::uint32_t object_id = 0;
  std::uint32_t material_id = 0;

  // Follow from view_from_object; see Place.
  glm::dmat3 view_from_normal{1.0};  // the inverse transpose up to a positive factor, defined for flat objects too
  double winding = 1.0;              // −1 where the matrix mirrors and triangles turn their back

  // View space, of any length: the axis (1, 1, 1) of Blender's world. Cycles takes it to the plane of a triangle for
  // the first of the two directions in which it measures a bump.
  glm::dvec3 bump_axis{1.0, 1.0, -1.0};

  bool reaches_far = false;  // set by EmbreeScene, if rays of light will be cast
};

PlacedObject Place(const Mesh* mesh, const Material* material, std::span<const Picture> textures,
                   const glm::dmat4& view_from_object);

// View-space corners of a triangle, in double.
struct Triangle {
  glm::dvec3 corner[3];
};
inline Triangle ViewTriangle(const PlacedObject& object, std::uint32_t primitive) {
  const glm::uvec3& corners = object.mesh->triangles[primitive];
  const glm::dmat3 linear(object.view_from_object);
  const glm::dvec3 origin(object.view_from_object[3]);
  Triangle triangle;
  for (int i = 0; i < 3; ++i) triangle.corner[i] = linear * glm::dvec3(object.mesh->positions[corners[i]]) + origin;
  return triangle;
}

// The height over length below which a ray sees a triangle edge on, because it is a sliver or is seen from the side.
// The ray's crossing is then lost in double's rounding (2^-47 of the distance over the share), and the nearest point of
// the edges is at most half a float's step from the ray.
inline constexpr double kEdgeOn = 0x1p-24;
double LongestEdgeSquared(const Triangle& triangle);

// The height of a ray's start above a surface, for each metre of the largest coordinate C: more than the error of
// Embree's floats, for triangles up to a length of 1.39 C. Measured, it is enough for larger ones and for slivers too.
// docs/numerics.md has the derivation ("Light, and where its rays start").
inline constexpr double kRoundingPerCoordinate = 0x1.0p-20;

struct SurfacePoint {
  glm::dvec3 position{0.0};         // view space
  glm::dvec3 facing{0.0};           // unit geometric normal on the viewer's side
  glm::dvec3 normal{0.0};           // unit shading normal, view space
  glm::dvec3 smooth_normal{0.0};    // unit interpolated normal, if `normal` is another one; 0: they are equal
  glm::dvec3 rest_position{0.0};    // object space
  glm::dvec2 barycentric{0.0};      // weights of the second and third corner; of hair, x is the place along it
  double largest_coordinate = 0.0;  // of the point and its triangle: float rounding errors are relative to it
  // The longest offset of a ray's origin from the point with nothing between. It leads back along the ray that hit the
  // point, to that ray's start, or to a place before the last back of a single-sided surface that a camera ray passed.
  // 0: unknown. The caster of the ray sets it (MaxRayOffset in rays/ray_offset.h).
  glm::dvec3 max_ray_offset{0.0};
};

// Intersects the surface of Embree's hit again in double, because the hit has only a float's precision. If the exact
// ray misses a triangle, or sees it edge on, the point is the nearest one to the ray on its edges. The point always
// lies on the surface. A back face has both normals flipped, as in Cycles. If a shading normal is zero or NaN, the
// geometric one replaces it; a triangle without area faces the eye. The shading normal is not bent: see
// surface/shading_normal.h.
SurfacePoint FindSurfacePoint(const PlacedObject& object, std::uint32_t primitive, const ViewRay& ray);

// The place of a point of a mesh's triangle, view space; of hair, that of its middle line.
glm::dvec3 ViewPlace(const PlacedObject& object, std::uint32_t primitive, const glm::dvec2& barycentric);

// The place of a point of a mesh's triangle before any deformation, object space; of hair, that of its middle line.
glm::dvec3 RestPosition(const PlacedObject& object, std::uint32_t primitive, const glm::dvec2& barycentric);

// Interpolated unit normals shorter than this have cancelled out: only rounding is left.
inline constexpr double kShortestNormal = 1e-6;

// Squares of lengths between which a vector is made a unit vector without being scaled first.
inline constexpr double kLeastPlainSquare = 1e-200;
inline constexpr double kLargestPlainSquare = 1e200;

// False, and `v` unchanged, where there is no direction.
bool MakeUnit(glm::dvec3& v);

double LargestCoordinate(const glm::dvec3& v);

// Base colour × texture × vertex colour, linear, and alpha.
glm::vec4 SurfaceColor(const PlacedObject& object, std::uint32_t primitive, glm::dvec2 barycentric);

// The first set of texture coordinates, (0, 0) upper left as textures are stored; empty where the mesh has none.
std::optional<glm::vec2> SurfaceUv(const PlacedObject& object, std::uint32_t primitive, glm::dvec2 barycentric);

// A texture at a point of the surface: its stored values, or its linear colour. Empty where the use names no texture or
// the mesh lacks its UV set.
std::optional<glm::vec4> SampleSurface(const PlacedObject& object, const TextureUse& use, std::uint32_t primitive,
                                       glm::dvec2 barycentric);
std::optional<glm::vec4> SampleSurfaceColor(const PlacedObject& object, const TextureUse& use, std::uint32_t primitive,
                                            glm::dvec2 barycentric);

// Whether no object is single-sided: rays of light, which also hit backs, then pass wherever camera rays pass.
bool AllDoubleSided(std::span<const PlacedObject> objects);

// Whether rays pass here: alpha masks, and blending as a mask at kBlendCutoff.
bool IsHole(const PlacedObject& object, std::uint32_t primitive, glm::dvec2 barycentric);
bool MayHaveHoles(const Material& material);

}  // namespace scumble
