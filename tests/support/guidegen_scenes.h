// Small scenes built in memory, for the ray caster's tests and benchmark.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <string>

#include "guidegen/guidegen.h"
#include "guidegen/scene.h"

namespace scumble::testing {

// 2 × 2 m in the plane z = 0, facing +Z, UV (0, 0) at its top left corner.
inline Mesh QuadMesh() {
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.uvs[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

// 2 × 2 × 2 m about the origin, faces outward, flat normals.
inline Mesh CubeMesh() {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      const unsigned first = unsigned(mesh.positions.size());
      const int u = (axis + 1) % 3;
      const int v = (axis + 2) % 3;
      for (const auto& [a, b] : {std::pair{-1.0f, -1.0f}, {1.0f, -1.0f}, {1.0f, 1.0f}, {-1.0f, 1.0f}}) {
        glm::vec3 position;
        position[axis] = side;
        position[u] = side * a;
        position[v] = b;
        glm::vec3 normal(0.0f);
        normal[axis] = side;
        mesh.positions.push_back(position);
        mesh.normals.push_back(normal);
      }
      mesh.triangles.push_back({first, first + 1, first + 2});
      mesh.triangles.push_back({first, first + 2, first + 3});
    }
  }
  return mesh;
}

// Radius 1, smooth normals, `rings` × 2 `rings` quads.
inline Mesh BallMesh(int rings) {
  Mesh mesh;
  const int columns = 2 * rings;
  for (int ring = 0; ring <= rings; ++ring) {
    for (int column = 0; column <= columns; ++column) {
      const double polar = glm::pi<double>() * ring / rings;
      const double around = 2.0 * glm::pi<double>() * column / columns;
      const glm::dvec3 direction(std::sin(polar) * std::sin(around), std::cos(polar),
                                 std::sin(polar) * std::cos(around));
      mesh.positions.push_back(direction);
      mesh.normals.push_back(direction);
      mesh.uvs[0].push_back({float(column) / columns, float(ring) / rings});
    }
  }
  for (int ring = 0; ring < rings; ++ring) {
    for (int column = 0; column < columns; ++column) {
      const unsigned a = unsigned(ring * (columns + 1) + column);
      const unsigned b = a + columns + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  }
  return mesh;
}

inline Scene SceneOf(Mesh mesh, const glm::dmat4& placed = glm::dmat4(1.0)) {
  Scene scene;
  scene.name = "test";
  scene.materials.resize(1);
  scene.materials[0].name = "paint";
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({"thing", 0, placed});
  return scene;
}

inline void AddObject(Scene& scene, const std::string& name, Mesh mesh, const glm::dmat4& placed) {
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({name, int(scene.meshes.size()) - 1, placed});
}

inline glm::dmat4 Moved(double x, double y, double z) { return glm::translate(glm::dmat4(1.0), {x, y, z}); }

// Stands on the +Z axis and looks down it.
inline Camera FrontCamera(double distance, double yfov_degrees = 40.0) {
  Camera camera;
  camera.name = "front";
  camera.world_from_camera = Moved(0, 0, distance);
  camera.yfov_degrees = yfov_degrees;
  return camera;
}

inline Camera FlatCamera(double distance, double ymag) {
  Camera camera = FrontCamera(distance);
  camera.orthographic = true;
  camera.ymag = ymag;
  return camera;
}

// Stands at `eye`, looks at `target`, +Y up.
inline Camera LookingAt(const glm::dvec3& eye, const glm::dvec3& target, double yfov_degrees = 40.0) {
  Camera camera = FrontCamera(0.0, yfov_degrees);
  camera.world_from_camera = glm::inverse(glm::lookAt(eye, target, glm::dvec3(0, 1, 0)));
  return camera;
}

inline GuidegenOptions Sized(int width, int height, LayerSet layers = {}) {
  GuidegenOptions options;
  options.width = width;
  options.height = height;
  options.layers = layers;
  return options;
}

inline Light PointLight(const glm::dvec3& position, double intensity) {
  Light light;
  light.name = "lamp";
  light.intensity = intensity;
  light.world_from_light = Moved(position.x, position.y, position.z);
  return light;
}

}  // namespace scumble::testing
