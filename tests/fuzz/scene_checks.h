// What the targets of scenes share.
#pragma once

#include <algorithm>
#include <cmath>

#include "guidegen/load_scene.h"
#include "tests/fuzz/fuzz_target.h"

namespace scumble::fuzz {

// What guidegen/scene.h promises to those who read a scene.
inline void CheckScene(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes) {
    SCUMBLE_CHECK_EQ(mesh.normals.size(), mesh.positions.size());
    SCUMBLE_CHECK(mesh.tangents.empty() || mesh.tangents.size() == mesh.positions.size());
    for (const glm::uvec3& triangle : mesh.triangles) {
      SCUMBLE_CHECK_LT(std::max({triangle.x, triangle.y, triangle.z}), mesh.positions.size());
    }
    for (const glm::vec3& normal : mesh.normals) SCUMBLE_CHECK_LT(std::abs(glm::length(normal) - 1.0f), 1e-3f);
  }
}

// Loads a scene from a file of that name, and looks at it from outside.
inline void LoadFrom(const std::string& name, Bytes input) {
  Expected<Scene> scene = LoadScene(InFile(name, input));
  CheckRefusal(scene);
  if (!scene) return;
  CheckScene(*scene);
  CheckRefusal(PrepareView(*scene, "", std::nullopt, 1.5, true));
}

inline void LoadObj(Bytes input) { LoadFrom("scene.obj", input); }
inline void LoadPly(Bytes input) { LoadFrom("scene.ply", input); }

}  // namespace scumble::fuzz
