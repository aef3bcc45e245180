// A slow and plain ray caster in double, the reference of the real one: every triangle is tried for every pixel. It
// shares no code with the engine; it only takes the data of a scene.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <string>
#include <vector>

#include "guidegen/guidegen.h"
#include "tests/support/guidegen_checks.h"
#include "tests/support/guidegen_scenes.h"

namespace scumble::testing {

// World axes, the eye at the origin. The direction's part along the view is 1, so that a ray's parameter is the depth.
struct ExactRay {
  glm::dvec3 origin{0.0};
  glm::dvec3 direction{0.0};
  glm::dvec3 At(double depth) const { return origin + direction * depth; }
  double DistanceTo(const glm::dvec3& point) const {
    return glm::length(glm::cross(point - origin, direction)) / glm::length(direction);
  }
};

// Through the centre of a pixel. The camera's matrix must be rigid, its extent vertical and its picture not shifted.
inline ExactRay PixelRay(const Camera& camera, int width, int height, double x, double y) {
  const glm::dvec3 right(camera.world_from_camera[0]), up(camera.world_from_camera[1]);
  const double half = camera.orthographic ? camera.ymag : std::tan(glm::radians(camera.yfov_degrees / 2.0));
  const glm::dvec3 aside =
      right * (half * (2.0 * (x + 0.5) - width) / height) + up * (half * (1.0 - 2.0 * (y + 0.5) / height));
  ExactRay ray{glm::dvec3(0.0), -glm::dvec3(camera.world_from_camera[2])};
  (camera.orthographic ? ray.origin : ray.direction) += aside;
  return ray;
}

inline glm::dvec3 FromEye(const Camera& camera, const glm::dmat4& world_from_object, const glm::vec3& place) {
  const glm::dvec3 to_object = glm::dvec3(world_from_object[3]) - glm::dvec3(camera.world_from_camera[3]);
  return glm::dmat3(world_from_object) * glm::dvec3(place) + to_object;
}

// A triangle's corners, from the eye.
inline std::array<glm::dvec3, 3> CornersFromEye(const Scene& scene, const Camera& camera, const Instance& instance,
                                                std::size_t triangle) {
  const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
  std::array<glm::dvec3, 3> corners;
  for (int k = 0; k < 3; ++k) {
    const glm::vec3& place = mesh.positions[mesh.triangles[triangle][k]];
    corners[std::size_t(k)] = FromEye(camera, instance.world_from_object, place);
  }
  return corners;
}

// Embree decides in float which triangle a ray meets. That decision is as good as if the ray passed this share of the
// largest distance in play (of a corner, or along the ray) beside its place. In units of u = 2^-24: a corner's rounding
// to float moves it by √3 u; the ray's direction by √2 u and the corner's place relative to the ray by √3 u more; an
// edge's side is the sum of three products of such differences, each rounded twice and summed in two steps, 5 u of the
// edge's length times the distance; Embree's robust test widens a triangle by 2 u of its own height. Together less
// than 13 u; 16 u is 2^-20.
inline constexpr double kFloatSight = 1.0 / (1 << 20);

// What rounding a unit vector's components to float once moves it by, and no more: √3 · 2^-24, 1.03e-7. A normal that
// is read, turned and written is rounded twice, one that is made unit in between three times.
inline constexpr double kRounded = 0x1.bb67aep-24;

struct ExactHit {
  int instance = -1;  // -1: background
  std::size_t triangle = 0;
  double depth = std::numeric_limits<double>::infinity();
  double next_depth = std::numeric_limits<double>::infinity();  // of the surface behind
  double facing = 1.0;                                          // cosine between the ray and the surface's normal
  double clearance = std::numeric_limits<double>::infinity();   // m to the nearest edge of any triangle
  double farthest = 0.0;                                        // corner from the eye, m

  // Whether float's rounding may change which surface is met.
  bool Undecided() const {
    const double blur = farthest * kFloatSight;
    return clearance <= blur || next_depth - depth <= blur / facing;
  }
};

inline double DistanceToSegment(const ExactRay& ray, const glm::dvec3& a, const glm::dvec3& b) {
  // In the plane across the ray, where the ray is a point.
  const glm::dvec3 w = glm::normalize(ray.direction);
  const glm::dvec3 helper = std::abs(w.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(w, helper)), v = glm::cross(w, u);
  const glm::dvec2 p(glm::dot(a - ray.origin, u), glm::dot(a - ray.origin, v));
  const glm::dvec2 q(glm::dot(b - ray.origin, u), glm::dot(b - ray.origin, v));
  const double length = glm::distance(p, q);
  const double along = length > 0.0 ? std::min(std::max(glm::dot(-p, q - p) / length, 0.0), length) : 0.0;
  return length > 0.0 ? glm::length(p + (q - p) * (along / length)) : glm::length(p);
}

// Surfaces count from the near to the far plane, from both sides.
inline ExactHit MeetExactly(const Scene& scene, const Camera& camera, const ExactRay& ray) {
  ExactHit hit;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    for (std::size_t t = 0; t < scene.meshes[std::size_t(instance.mesh)].triangles.size(); ++t) {
      const std::array<glm::dvec3, 3> c = CornersFromEye(scene, camera, instance, t);
      double side[3];
      for (std::size_t k = 0; k < 3; ++k) {
        hit.farthest = std::max(hit.farthest, glm::length(c[k]));
        hit.clearance = std::min(hit.clearance, DistanceToSegment(ray, c[k], c[(k + 1) % 3]));
        side[k] = glm::dot(ray.direction, glm::cross(c[k] - ray.origin, c[(k + 1) % 3] - ray.origin));
      }
      const bool inside = (side[0] > 0 && side[1] > 0 && side[2] > 0) || (side[0] < 0 && side[1] < 0 && side[2] < 0);
      const glm::dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
      const double depth = glm::dot(normal, c[0] - ray.origin) / glm::dot(normal, ray.direction);
      if (!inside || !(depth >= camera.z_near && depth <= camera.z_far)) continue;
      hit.next_depth = std::min(hit.next_depth, std::max(depth, hit.depth));
      if (depth >= hit.depth) continue;
      hit.depth = depth;
      hit.instance = int(i);
      hit.triangle = t;
      hit.facing = std::abs(glm::dot(normal, ray.direction)) / (glm::length(normal) * glm::length(ray.direction));
    }
  }
  return hit;
}

// What the surface shows for a normal where it is hit, and how far from it the engine's may be.
struct ExactNormal {
  glm::dvec3 unit{0.0};  // view space, on the ray's side
  double tolerance = 0.0;
};

// The corners' normals in the shares of the place, or the triangle's own where the mesh has none. In units of u =
// 2^-24, of normals no longer than 1: the shares of two corners are rounded to float, which moves the sum by 2 u where
// the normals are opposed, and that of the first is what two more roundings leave of 1, 2 u; three products are off by
// 1 u of the sum, their two sums by 2 u. Together 7 u, over the sum's length; the result is rounded once more, as
// kRounded has it. What double leaves of the place, 2^-49 of the farthest corner over the cosine, moves a share by that
// over the triangle's height as the ray sees it. Of a surface that is decided this is more than 2^-19 of the farthest
// corner, or an edge would be in sight: so two shares move by 2^-30 over the cosine each, which counts for no more than
// the corners' normals differ, and a triangle's own normal by twice 2^-30.
inline ExactNormal NormalAt(const Scene& scene, const Camera& camera, const ExactRay& ray, const ExactHit& hit) {
  const Instance& instance = scene.instances[std::size_t(hit.instance)];
  const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
  const glm::uvec3& corners = mesh.triangles[hit.triangle];
  const std::array<glm::dvec3, 3> c = CornersFromEye(scene, camera, instance, hit.triangle);
  const glm::dvec3 first = c[1] - c[0], second = c[2] - c[0], place = ray.At(hit.depth) - c[0];
  const glm::dvec3 area = glm::cross(first, second);
  const double v = glm::dot(glm::cross(place, second), area) / glm::dot(area, area);
  const double w = glm::dot(glm::cross(first, place), area) / glm::dot(area, area);
  const double share[3] = {1.0 - v - w, v, w};
  const glm::dvec3 p[3] = {mesh.positions[corners.x], mesh.positions[corners.y], mesh.positions[corners.z]};
  const glm::dvec3 own = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
  glm::dvec3 normals[3], sum(0.0);
  double differ = 0.0;
  for (int k = 0; k < 3; ++k) {
    normals[k] = mesh.normals.empty() ? own : glm::dvec3(mesh.normals[corners[k]]);
    sum += normals[k] * share[k];
    differ = std::max(differ, glm::distance(normals[k], normals[0]));
  }
  const glm::dmat3 turned = glm::transpose(glm::inverse(glm::dmat3(instance.world_from_object)));
  const double side = glm::dot(turned * own, ray.direction) > 0.0 ? -1.0 : 1.0;
  const glm::dmat3 view_from_world = glm::transpose(glm::dmat3(camera.world_from_camera));
  return {view_from_world * glm::normalize(turned * sum) * side,
          (7.0 * 0x1p-24 + 0x1p-29 * (1.0 + differ / hit.facing)) / glm::length(sum) + kRounded};
}

// Where float may choose the surface, what is shown still lies on the pixel's ray, to float's sight, with a unit
// normal. The guides must have positions.
inline void ExpectOnRay(const Camera& camera, const GuideSet& guides, std::size_t i, const ExactRay& ray,
                        const ExactHit& hit) {
  if (guides.Plane(Layer::kCoverage)[i] == 0.0f) return;
  EXPECT_NEAR(glm::length(glm::dvec3(guides.Vec3(Layer::kNormal, i))), 1.0, kRounded);
  const glm::dvec3 place(guides.Vec3(Layer::kPosition, i));
  const double stored = 0x1p-24 * glm::length(place);
  EXPECT_LE(ray.DistanceTo(place - glm::dvec3(camera.world_from_camera[3])), hit.farthest * kFloatSight + stored);
}

// A depth is the truth rounded to float once, half a unit of 2^-23, plus what double leaves: 2^-49 of the farthest
// corner over the cosine. So is each coordinate of a place in the world, where double leaves 2^-50 of the eye's place
// more: corners are brought before the eye, and places back into the world, by sums of what may be as large as that, in
// the engine and here.
inline void ExpectTruth(const Scene& scene, const Camera& camera, const GuideSet& guides, std::size_t i,
                        const ExactRay& ray, const ExactHit& hit) {
  const double left = std::ldexp(hit.farthest, -49) / hit.facing;
  EXPECT_NEAR(guides.Plane(Layer::kDepth)[i], hit.depth, std::ldexp(hit.depth, -24) + left);
  const ExactNormal normal = NormalAt(scene, camera, ray, hit);
  EXPECT_LE(glm::distance(glm::dvec3(guides.Vec3(Layer::kNormal, i)), normal.unit), normal.tolerance);
  if (!guides.Has(Layer::kPosition)) return;
  const glm::dvec3 eye(camera.world_from_camera[3]), place = ray.At(hit.depth) + eye;
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(guides.Plane(Layer::kPosition, axis)[i], place[axis],
                std::ldexp(std::abs(place[axis]), -24) + left + std::ldexp(glm::length(eye), -50))
        << "axis " << axis;
  }
}

struct ExactCount {
  int decided = 0;    // pixels whose surface was checked
  int undecided = 0;  // where float may choose
  int covered = 0;    // of those decided
};

// The guides' coverage, object, depth, normal and position against the plain caster, of a scene without normal maps
// whose matrices move, turn and stretch evenly. The guides must have positions where any pixel is undecided.
inline ExactCount ExpectExact(const Scene& scene, const Camera& camera, const GuideSet& guides) {
  std::vector<std::string> names;
  for (const Instance& instance : scene.instances) names.push_back(instance.object);
  const std::vector<std::uint32_t> ids = IdsForNames(names);
  ExactCount count;
  const bool failed_before = ::testing::Test::HasFailure();
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x < guides.width(); ++x) {
      SCOPED_TRACE("pixel " + std::to_string(x) + ", " + std::to_string(y));
      const std::size_t i = guides.Index(x, y);
      const ExactRay ray = PixelRay(camera, guides.width(), guides.height(), x, y);
      const ExactHit hit = MeetExactly(scene, camera, ray);
      if (hit.Undecided()) {
        ++count.undecided;
        ExpectOnRay(camera, guides, i, ray, hit);
        continue;
      }
      ++count.decided;
      const bool covered = guides.Plane(Layer::kCoverage)[i] == 1.0f;
      EXPECT_EQ(covered, hit.instance >= 0) << "depth " << hit.depth << ", clearance " << hit.clearance;
      if (!covered || hit.instance < 0) continue;
      ++count.covered;
      EXPECT_EQ(guides.Plane(Layer::kObject)[i], float(ids[std::size_t(hit.instance)]));
      ExpectTruth(scene, camera, guides, i, ray, hit);
      if (!failed_before && ::testing::Test::HasFailure()) return count;  // one pixel's fault is enough to read
    }
  }
  return count;
}

// Renders what ExpectExact looks at, and looks at it.
inline ExactCount ExpectExactGuides(const Scene& scene, const Camera& camera, int width, int height) {
  return ExpectExact(scene, camera, Render(scene, camera, Sized(width, height, {Layer::kPosition})).guides);
}

}  // namespace scumble::testing
