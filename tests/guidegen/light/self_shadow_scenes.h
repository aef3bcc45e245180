// Scenes for the tests of where rays of light start: meshes at any scale, place and turn, with suns and lights.
//
// A ray is decided in float. Its origin lies 16 u C above the surface, u = 2^-24 and C the largest coordinate before
// the camera; why that is enough is derived beside kRoundingPerCoordinate.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/image/hash.h"
#include "guidegen/surface/bsdf.h"
#include "tests/support/light_path_scenes.h"

namespace scumble::testing {

inline constexpr double kScales[] = {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6};  // m
inline constexpr double kPlaces[] = {0.0, 1.0, 1e3, 1e7};  // m from the world's origin
inline constexpr int kStages = 52;                         // every scale at every place
inline double ScaleOf(int stage) { return kScales[stage % 13]; }
inline constexpr double kUnit = 0x1p-24;
inline const LayerSet kLight = {Layer::kLuminance, Layer::kShadow};

inline double Chance(int a, int b) { return UnitFloat(Hash(std::uint64_t(a), std::uint64_t(b))); }

inline glm::dvec3 AnyDirection(int seed) {
  const double z = 2.0 * Chance(seed, 1) - 1.0, angle = 2.0 * kPi * Chance(seed, 2), ring = std::sqrt(1.0 - z * z);
  return {ring * std::cos(angle), ring * std::sin(angle), z};
}

inline double LongestEdge(const glm::dvec3 (&c)[3]) {
  return std::max({glm::length(c[1] - c[0]), glm::length(c[2] - c[1]), glm::length(c[0] - c[2])});
}

// Whether a triangle is higher than a float's step is long; lower ones have no inside.
inline bool IsThere(const glm::dvec3 (&c)[3]) {
  const double longest = LongestEdge(c);
  return glm::length(glm::cross(c[1] - c[0], c[2] - c[0])) > kUnit * longest * longest;
}

// Every triangle with corners and a normal of its own; those that are not there are left out.
inline Mesh Faceted(const Mesh& mesh) {
  Mesh result;
  for (const glm::uvec3& triangle : mesh.triangles) {
    glm::dvec3 c[3];
    for (int k = 0; k < 3; ++k) c[k] = mesh.positions[triangle[k]];
    if (!IsThere(c)) continue;
    const glm::dvec3 area = glm::cross(c[1] - c[0], c[2] - c[0]);
    const unsigned first = unsigned(result.positions.size());
    for (const glm::dvec3& corner : c) {
      result.positions.push_back(corner);
      result.normals.push_back(glm::normalize(area));
    }
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

inline Mesh Tetrahedron() {
  Mesh mesh;
  mesh.positions = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  return Faceted(mesh);
}

// On one thread: for thousands of small pictures, waking more takes longer than they save.
inline GuidegenOptions SmallPicture() {
  GuidegenOptions options = Sized(40, 40, kLight);
  options.threads = 1;
  return options;
}

inline Light SunFrom(const glm::dvec3& direction) {
  glm::dvec3 x, y;
  MakeFrame(direction, x, y);
  Light sun = Above(LightType::kSun, 0.0, 1.0);
  for (int row = 0; row < 3; ++row) {
    sun.world_from_light[0][row] = x[row];
    sun.world_from_light[1][row] = y[row];
    sun.world_from_light[2][row] = direction[row];
  }
  return sun;
}

inline glm::dmat4 Placed(double scale, const glm::dvec3& place, int turn) {
  const glm::dmat4 turned =
      glm::rotate(glm::translate(glm::dmat4(1.0), place), 6.0 * Chance(turn, 9), AnyDirection(turn + 100));
  return glm::scale(turned, glm::dvec3(scale));
}

inline glm::dvec3 At(const glm::dmat4& matrix, const glm::dvec3& local) {
  return glm::dvec3(matrix * glm::dvec4(local, 1.0));
}

struct Named {
  const char* name;
  Mesh mesh;
  bool is_flat = false;
};

struct Stage {
  Scene scene;
  Camera camera;
};

struct Count {
  std::size_t rays = 0;   // towards lights
  std::size_t wrong = 0;  // pixels

  void Add(const GuidegenResult& result, Layer layer) {
    rays += result.rays.shadow;
    for (const float value : result.guides.Plane(layer)) wrong += value != 0.0f;
  }
};

}  // namespace scumble::testing
