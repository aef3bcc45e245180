// Scenes over time that the loader's tests share.
#pragma once

#include <gmock/gmock.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "guidegen/load_scene.h"
#include "tests/support/gltf_builder.h"

namespace scumble {

using nlohmann::json;
using ::testing::HasSubstr;

inline const float kHalf = std::sqrt(0.5f);
inline constexpr double kFloatError = 1e-6;

inline double LargestDifference(const glm::dmat4& a, const glm::dmat4& b) {
  double largest = 0.0;
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) largest = std::max(largest, std::abs(a[c][r] - b[c][r]));
  }
  return largest;
}

inline glm::dmat4 RotationY(double degrees) {
  return glm::rotate(glm::dmat4(1.0), glm::radians(degrees), glm::dvec3(0, 1, 0));
}

inline glm::dvec3 WorldPosition(const Scene& scene, std::size_t instance, std::size_t vertex) {
  const Instance& shown = scene.instances[instance];
  return glm::dvec3(shown.world_from_object * glm::dvec4(scene.meshes[std::size_t(shown.mesh)].positions[vertex], 1.0));
}

class LoadAnimation : public LoaderTest {
 protected:
  AnimatedScene Load(const GltfBuilder& builder, const std::string& name = "") {
    Expected<AnimatedScene> scene = AnimatedScene::Load(Write("scene.glb", builder.Glb()), {name});
    if (!scene) throw std::runtime_error(scene.error().message);
    return std::move(*scene);
  }
  Scene At(const GltfBuilder& builder, double seconds) { return At(Load(builder), seconds); }
  Scene At(const AnimatedScene& animated, double seconds) {
    Expected<Scene> scene = animated.SceneAt(seconds);
    if (!scene) throw std::runtime_error(scene.error().message);
    return std::move(*scene);
  }
  std::string ErrorOf(const GltfBuilder& builder, ErrorKind kind = ErrorKind::kInput, const std::string& name = "") {
    const Expected<AnimatedScene> scene = AnimatedScene::Load(Write("scene.glb", builder.Glb()), {name});
    EXPECT_FALSE(scene.ok());
    if (scene) return "";
    EXPECT_EQ(scene.error().kind, kind);
    EXPECT_THAT(scene.error().message, HasSubstr("scene.glb"));
    return scene.error().message;
  }
};

// A strip in the plane z = 0, 1 m wide and 2 m high, with vertex rows at y = 0, 1 and 2, bound to two joints: the lower
// row to the root at the origin, the upper one to the tip at y = 1, the middle one to both alike.
struct Bar {
  GltfBuilder b;
  int root = 0, tip = 0, node = 0;

  explicit Bar(const std::vector<float>& weights = {1,  0,  0, 0, 1, 0, 0, 0, .5, .5, 0, 0,
                                                    .5, .5, 0, 0, 0, 1, 0, 0, 0,  1,  0, 0}) {
    const int position = b.Floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 1, 2, 0}, 3);
    const int normal = b.Floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
    std::vector<std::uint8_t> joints(24, 0);
    for (std::size_t i = 0; i < 6; ++i) joints[4 * i + 1] = 1;
    const int joint = b.Accessor(b.View(joints), kUbyte, 6, "VEC4");
    const int weight = b.Floats(weights, 4);
    const int index = b.Indices({0, 1, 2, 2, 1, 3, 2, 3, 4, 4, 3, 5});
    const int mesh = b.Mesh(
        {{{"attributes", {{"POSITION", position}, {"NORMAL", normal}, {"JOINTS_0", joint}, {"WEIGHTS_0", weight}}},
          {"indices", index}}});
    tip = b.Append("nodes", {{"name", "Tip"}, {"translation", {0, 1, 0}}});
    root = b.Root({{"name", "Root"}, {"children", {tip}}});
    const int inverse = b.Matrices({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,  //
                                    1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1});
    const int skin = b.Append("skins", {{"name", "Rig"}, {"joints", {root, tip}}, {"inverseBindMatrices", inverse}});
    // The node of a skinned mesh does not place it.
    node = b.Root({{"name", "Bar"}, {"mesh", mesh}, {"skin", skin}, {"translation", {100, 0, 0}}});
  }
};

}  // namespace scumble
