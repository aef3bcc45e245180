// Checks that the targets of scenes share.
#pragma once

#include <algorithm>
#include <cmath>

#include "guidegen/framing.h"
#include "guidegen/guidegen.h"
#include "guidegen/load_scene.h"
#include "tests/fuzz/fuzz_target.h"

namespace scumble::fuzz {

// The contract of guidegen/scene.h for readers of a scene.
inline void CheckScene(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes) {
    SCUMBLE_CHECK_EQ(mesh.normals.size(), mesh.IsCurves() ? 0 : mesh.positions.size());
    SCUMBLE_CHECK(mesh.triangles.empty() || !mesh.IsCurves());
    SCUMBLE_CHECK_EQ(mesh.curves.radii.size(), mesh.IsCurves() ? mesh.positions.size() : 0);
    for (const std::uint32_t first : mesh.curves.segments) SCUMBLE_CHECK_LE(first + 4, mesh.positions.size());
    SCUMBLE_CHECK(mesh.tangents.empty() || mesh.tangents.size() == mesh.positions.size());
    for (const glm::uvec3& triangle : mesh.triangles) {
      SCUMBLE_CHECK_LT(std::max({triangle.x, triangle.y, triangle.z}), mesh.positions.size());
    }
    for (const glm::vec3& normal : mesh.normals) SCUMBLE_CHECK_LT(std::abs(glm::length(normal) - 1.0f), 1e-3f);
  }
}

// Scenes that a target has time to draw.
inline bool IsSmall(const Scene& scene) {
  std::size_t triangles = 0;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    triangles += mesh.triangles.size() + mesh.curves.segments.size() + 1;
  }
  return triangles <= 10'000 && scene.lights.size() <= 100;
}

// 4 × 4 pixels of these layers, by one ray for each question.
inline GuidegenOptions SmallPicture(const LayerSet& layers) {
  GuidegenOptions options;
  options.width = options.height = 4;
  options.layers = layers;
  options.samples = options.threads = 1;
  options.max_bounces = 2;
  return options;
}

// Draws it with all its light.
inline void Draw(const Scene& scene, const Camera& camera) {
  if (!IsSmall(scene)) return;
  const LayerSet layers{Layer::kLuminance, Layer::kShadow, Layer::kAlbedo, Layer::kPosition, Layer::kLpeFull};
  CheckRefusal(RenderGuides(scene, camera, SmallPicture(layers)));
}

// Draws how far it moves until it is the next one.
inline void DrawMotion(Scene now, Scene next) {
  if (!IsSmall(now) || !IsSmall(next)) return;
  const Expected<PreparedView> view = PrepareView(now, "", std::nullopt, 1.0, false);
  const Expected<PreparedView> then = PrepareView(next, "", std::nullopt, 1.0, false);
  if (!view || !then) return;
  CheckRefusal(RenderGuides(now, view->camera, NextFrame{next, then->camera}, SmallPicture({Layer::kMotion})));
}

// Loads a scene from a file of that name, looks at it, from its own camera or else from outside, and draws it.
inline void LoadFrom(const std::string& name, Bytes input) {
  Expected<Scene> scene = LoadScene(InFile(name, input));
  CheckRefusal(scene);
  if (!scene) return;
  CheckScene(*scene);
  const Expected<PreparedView> view = PrepareView(*scene, "", std::nullopt, 1.0, true);
  CheckRefusal(view);
  if (view) Draw(*scene, view->camera);
}

inline void LoadObj(Bytes input) { LoadFrom("scene.obj", input); }
inline void LoadPly(Bytes input) { LoadFrom("scene.ply", input); }

}  // namespace scumble::fuzz
