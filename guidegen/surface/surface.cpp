#include "guidegen/surface/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "guidegen/surface/curve.h"
#include "guidegen/surface/interpolate.h"
#include "guidegen/surface/normal_map.h"
#include "guidegen/surface/texture.h"
#include "guidegen/surface/work_counters.h"

namespace scumble {
namespace {

// The vertices between which a mesh's attributes are interpolated. Those of hair are the same all along each curve.
glm::uvec3 CornersOf(const Mesh& mesh, std::uint32_t primitive) {
  return mesh.IsCurves() ? glm::uvec3(mesh.curves.segments[primitive]) : mesh.triangles[primitive];
}

glm::dvec3 DirectionToEye(const ViewRay& ray) { return glm::normalize(-ray.direction); }

// The point of a triangle's edge with the least distance from the ray's line.
struct EdgePlace {
  glm::dvec2 barycentric;
  double miss;   // squared distance
  double along;  // from the ray's origin, in lengths of its direction
  bool behind;   // the origin, by more than rounding: an eye on an edge sees that edge
};

EdgePlace NearestOnEdge(const Triangle& triangle, int i, const ViewRay& ray, double summands) {
  constexpr glm::dvec2 kCorners[] = {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}};
  const int next = (i + 1) % 3;
  const double squared = glm::dot(ray.direction, ray.direction);
  const auto along = [&](const glm::dvec3& v) { return glm::dot(v, ray.direction) / squared; };
  const glm::dvec3 corner = triangle.corner[i] - ray.origin;
  const glm::dvec3 edge = triangle.corner[next] - triangle.corner[i];
  const glm::dvec3 from = corner - ray.direction * along(corner);
  const glm::dvec3 across = edge - ray.direction * along(edge);
  const double length = glm::dot(across, across);
  const double share = length > 0.0 ? glm::clamp(-glm::dot(from, across) / length, 0.0, 1.0) : 0.0;
  const glm::dvec3 miss = from + across * share;
  const double reach = along(corner + edge * share);
  constexpr double kRounding = 0x1p-48;  // several rounding steps of a double, relative to the summands
  const bool behind = reach < 0.0 && reach * reach * squared >
                                         kRounding * kRounding *
                                             (glm::dot(corner, corner) + glm::dot(edge, edge) + summands * summands);
  return {glm::mix(kCorners[i], kCorners[next], share), glm::dot(miss, miss), reach, behind};
}

// The barycentrics of the point on a triangle's edges with the least distance from the ray. A triangle seen edge on
// shows two of its edges there. Of points before the ray's origin that lie on the ray, to a float's step of their
// distance, it is the first.
glm::dvec2 NearestOnEdges(const Triangle& triangle, const ViewRay& ray, double summands) {
  EdgePlace places[3];
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    places[i] = NearestOnEdge(triangle, i, ray, summands);
    if (places[i].behind) places[i].miss += kLargestPlainSquare;  // no point lies before the origin
    least = std::min(least, places[i].miss);
  }
  const double step_squared = kEdgeOn * kEdgeOn * glm::dot(ray.direction, ray.direction);
  glm::dvec2 first(0.0);
  double first_along = std::numeric_limits<double>::infinity();
  for (const EdgePlace& place : places) {
    const bool on_ray = place.miss <= std::max(least, step_squared * place.along * place.along);
    if (!on_ray || !(place.along < first_along)) continue;
    first_along = place.along;
    first = place.barycentric;
  }
  return first;
}

// Möller & Trumbore 1997, in double; `area` is the cross product of the triangle's edges. Embree rounds corners to
// float, so a ray may just miss the triangle. Such rays get the nearest point of its edges, in space. In barycentrics a
// triangle's height is 1 at any angle, and a micrometre may seem to be a thousand triangles. `summands` is the largest
// summand of the corners and the origin, which bounds their rounding.
glm::dvec2 MeetTriangle(const Triangle& triangle, const glm::dvec3& area, const ViewRay& ray, double summands) {
  const glm::dvec3 moment = glm::cross(ray.origin - triangle.corner[0], ray.direction);
  const double seen = glm::dot(area, ray.direction);
  const double scale = -1.0 / seen;
  const glm::dvec2 result(glm::dot(triangle.corner[2] - triangle.corner[0], moment) * scale,
                          glm::dot(triangle.corner[0] - triangle.corner[1], moment) * scale);
  const bool inside = result.x >= 0.0 && result.y >= 0.0 && result.x + result.y <= 1.0;  // false for NaN
  const bool steady = std::abs(seen) > kEdgeOn * LongestEdgeSquared(triangle) * glm::length(ray.direction);
  return inside && steady ? result : NearestOnEdges(triangle, ray, summands);
}

glm::dvec3 Mix(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec2& barycentric) {
  return a + (b - a) * barycentric.x + (c - a) * barycentric.y;
}

// Object space, not normalised.
glm::dvec3 ObjectNormal(const PlacedObject& object, const glm::uvec3& triangle, const glm::dvec2& barycentric) {
  if (object.mesh->normals.empty()) return glm::dvec3(0.0);
  return Interpolate(object.mesh->normals, triangle, barycentric);
}

// False for NaN.
bool IsLongEnough(const glm::dvec3& normal) { return glm::dot(normal, normal) > kShortestNormal * kShortestNormal; }

SurfacePoint FindTrianglePoint(const PlacedObject& object, std::uint32_t primitive, const ViewRay& ray) {
  const glm::uvec3& corners = object.mesh->triangles[primitive];
  const Triangle triangle = ViewTriangle(object, primitive);
  const glm::dvec3 area = glm::cross(triangle.corner[1] - triangle.corner[0], triangle.corner[2] - triangle.corner[0]);
  SurfacePoint point;
  const double summands = LargestCoordinate(glm::dvec3(object.view_from_object[3])) + LargestCoordinate(ray.origin);
  point.barycentric = MeetTriangle(triangle, area, ray, summands);
  point.position = Mix(triangle.corner[0], triangle.corner[1], triangle.corner[2], point.barycentric);
  point.rest_position = RestPosition(object, primitive, point.barycentric);
  point.largest_coordinate = LargestCoordinate(point.position);
  for (const glm::dvec3& corner : triangle.corner) {
    point.largest_coordinate = std::max(point.largest_coordinate, LargestCoordinate(corner));
  }

  const double side = glm::dot(area, ray.direction) * object.winding > 0.0 ? -1.0 : 1.0;
  point.facing = area * (object.winding * side);
  if (!MakeUnit(point.facing)) point.facing = DirectionToEye(ray);
  const auto shading = [&](const glm::dvec3& normal) {
    glm::dvec3 result = object.view_from_normal * normal * side;
    return IsLongEnough(normal) && MakeUnit(result) ? result : point.facing;
  };
  const glm::dvec3 normal = ObjectNormal(object, corners, point.barycentric);
  point.normal = shading(normal);
  if (!ChangesNormals(object) || !IsLongEnough(normal)) return point;
  glm::dvec3 mapped = point.normal;
  if (HasNormalMap(object)) {
    mapped = MixedNormal(object, shading(MappedNormal(object, corners, point.barycentric)), point.normal);
  }
  if (HasBump(object)) {
    const double width = ray.width + ray.spread * glm::length(point.position - ray.origin);
    mapped = BumpedNormal(object, corners, triangle, {point.barycentric, point.facing, side, width}, mapped);
  }
  if (mapped == point.normal) return point;
  point.smooth_normal = point.normal;
  point.normal = mapped;
  return point;
}

// The object's matrix must be rigid. If the exact ray misses the sphere that Embree's rounded one hit, the point is the
// nearest one of the silhouette.
SurfacePoint FindSpherePoint(const PlacedObject& object, const ViewRay& ray) {
  const glm::dvec3 centre(object.view_from_object[3]);
  const double length = glm::length(ray.direction);
  const glm::dvec3 direction = ray.direction / length;
  const glm::dvec3 to_origin = ray.origin - centre;
  const double middle = -glm::dot(to_origin, direction);
  const glm::dvec3 off_axis = to_origin + direction * middle;
  const double half_chord = std::sqrt(std::max(0.0, 1.0 - glm::dot(off_axis, off_axis)));
  const bool inside = middle < half_chord;
  const glm::dvec3 outward = glm::normalize(off_axis + direction * (inside ? half_chord : -half_chord));
  SurfacePoint point;
  point.position = centre + outward;
  point.rest_position = glm::transpose(glm::dmat3(object.view_from_object)) * outward;
  point.facing = point.normal = inside ? -outward : outward;
  point.largest_coordinate = LargestCoordinate(centre) + 1.0;
  return point;
}

}  // namespace

double LargestCoordinate(const glm::dvec3& v) {
  return std::max(std::max(std::abs(v.x), std::abs(v.y)), std::abs(v.z));
}

// Vectors whose square would exceed a double's range are scaled first.
bool MakeUnit(glm::dvec3& v) {
  const double squared = glm::dot(v, v);
  if (squared > kLeastPlainSquare && squared < kLargestPlainSquare) {
    v *= 1.0 / std::sqrt(squared);
    return true;
  }
  const double largest = LargestCoordinate(v);
  if (!std::isfinite(v.x + v.y + v.z) || !(largest > 0.0)) return false;
  v = glm::normalize(v / largest);
  return true;
}

glm::dvec3 RestPosition(const PlacedObject& object, std::uint32_t primitive, const glm::dvec2& barycentric) {
  if (object.mesh->IsCurves()) return RestPlaceOfCurve(object, primitive, barycentric.x);
  const glm::uvec3& corners = object.mesh->triangles[primitive];
  const auto& positions = object.mesh->rest_positions.empty() ? object.mesh->positions : object.mesh->rest_positions;
  return Mix(positions[corners.x], positions[corners.y], positions[corners.z], barycentric);
}

PlacedObject Place(const Mesh* mesh, const Material* material, std::span<const Picture> textures,
                   const glm::dmat4& view_from_object) {
  PlacedObject object;
  object.mesh = mesh;
  object.material = material;
  object.textures = textures;
  object.view_from_object = view_from_object;
  const glm::dmat3 linear(view_from_object);
  object.winding = glm::determinant(linear) < 0.0 ? -1.0 : 1.0;
  // The matrix of cofactors is the inverse transpose times the determinant, and needs no division.
  object.view_from_normal =
      object.winding *
      glm::dmat3(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]), glm::cross(linear[0], linear[1]));
  return object;
}

double LongestEdgeSquared(const Triangle& triangle) {
  double longest = 0.0;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 edge = triangle.corner[(i + 1) % 3] - triangle.corner[i];
    longest = std::max(longest, glm::dot(edge, edge));
  }
  return longest;
}

bool AllDoubleSided(std::span<const PlacedObject> objects) {
  return std::all_of(objects.begin(), objects.end(),
                     [](const PlacedObject& object) { return object.material->double_sided; });
}

glm::dvec3 ViewPlace(const PlacedObject& object, std::uint32_t primitive, const glm::dvec2& barycentric) {
  if (object.mesh->IsCurves()) return ViewSegment(object, primitive).At(barycentric.x);
  const Triangle triangle = ViewTriangle(object, primitive);
  return triangle.corner[0] + (triangle.corner[1] - triangle.corner[0]) * barycentric.x +
         (triangle.corner[2] - triangle.corner[0]) * barycentric.y;
}

SurfacePoint FindSurfacePoint(const PlacedObject& object, std::uint32_t primitive, const ViewRay& ray) {
  if (!object.mesh) return FindSpherePoint(object, ray);
  return object.mesh->IsCurves() ? FindCurvePoint(object, primitive, ray) : FindTrianglePoint(object, primitive, ray);
}

glm::vec4 SurfaceColor(const PlacedObject& object, std::uint32_t primitive, glm::dvec2 barycentric) {
  ++thread_counters.materials;
  glm::vec4 color = object.material->base_color;
  if (!object.mesh) return color;
  const Mesh& mesh = *object.mesh;
  const glm::uvec3 corners = CornersOf(mesh, primitive);
  if (!mesh.colors.empty()) color *= Interpolate(mesh.colors, corners, barycentric);
  const TextureUse& use = object.material->base_color_texture;
  if (const Picture* picture = FindTexture(object, use)) {
    color *= SampleColor(*picture, use, Interpolate(mesh.uvs[use.uv_set], corners, barycentric));
  }
  return color;
}

std::optional<glm::vec2> SurfaceUv(const PlacedObject& object, std::uint32_t primitive, glm::dvec2 barycentric) {
  if (!object.mesh || object.mesh->uvs[0].empty()) return std::nullopt;
  return Interpolate(object.mesh->uvs[0], CornersOf(*object.mesh, primitive), barycentric);
}

std::optional<glm::vec4> SampleSurface(const PlacedObject& object, const TextureUse& use, std::uint32_t primitive,
                                       glm::dvec2 barycentric) {
  const Picture* picture = FindTexture(object, use);
  if (!picture) return std::nullopt;
  const Mesh& mesh = *object.mesh;
  return SampleRaw(*picture, use, Interpolate(mesh.uvs[use.uv_set], CornersOf(mesh, primitive), barycentric));
}

std::optional<glm::vec4> SampleSurfaceColor(const PlacedObject& object, const TextureUse& use, std::uint32_t primitive,
                                            glm::dvec2 barycentric) {
  const Picture* picture = FindTexture(object, use);
  if (!picture) return std::nullopt;
  const Mesh& mesh = *object.mesh;
  return SampleColor(*picture, use, Interpolate(mesh.uvs[use.uv_set], CornersOf(mesh, primitive), barycentric));
}

bool MayHaveHoles(const Material& material) { return material.alpha_mode != AlphaMode::kOpaque; }

bool IsHole(const PlacedObject& object, std::uint32_t primitive, glm::dvec2 barycentric) {
  if (!MayHaveHoles(*object.material)) return false;
  const float cutoff = object.material->alpha_mode == AlphaMode::kMask ? object.material->alpha_cutoff : kBlendCutoff;
  return SurfaceColor(object, primitive, barycentric).a < cutoff;
}

}  // namespace scumble
