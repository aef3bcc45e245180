// An armature, shape keys and moving objects, exported by Blender's own glTF exporter: each vertex's place at a frame
// against Blender's. tests/blender/make_animation.py makes the scene.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "guidegen/load_scene.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

glm::dvec3 Point(const nlohmann::json& list) { return {list[0], list[1], list[2]}; }

// A rest position, rounded so that float and text agree.
std::tuple<long, long, long> Key(const glm::dvec3& p) {
  return {std::lround(p.x * 1e4), std::lround(p.y * 1e4), std::lround(p.z * 1e4)};
}

const glm::vec3& Rest(const Mesh& mesh, std::size_t vertex) {
  return (mesh.rest_positions.empty() ? mesh.positions : mesh.rest_positions)[vertex];
}

TEST(BlenderAnimation, VerticesStandWhereBlenderHasThem) {
  const TemporaryFolder folder;
  const std::string log = (folder.path() / "log").string();
  const std::string command = std::string("blender -b -noaudio --factory-startup -P ") + SCUMBLE_SOURCE_DIR +
                              "/tests/blender/make_animation.py -- --output " + folder.path().string() + " > " + log +
                              " 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0) << std::ifstream(log).rdbuf();
  std::ifstream stream(folder.path() / "expected.json");
  const nlohmann::json expected = nlohmann::json::parse(stream, nullptr, false);
  ASSERT_TRUE(expected.is_object());
  const Expected<AnimatedScene> animated = AnimatedScene::Load(folder.path() / "animated.glb");
  ASSERT_TRUE(animated.ok()) << animated.error().message;
  EXPECT_NEAR(animated->duration_seconds(), 20.0 / expected["fps"].get<double>(), 1e-6);

  std::map<std::string, double> worst;
  for (const auto& [frame, at_frame] : expected["frames"].items()) {
    const Expected<Scene> scene = animated->SceneAt(std::stod(frame) / expected["fps"].get<double>());
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    EXPECT_THAT(scene->warnings, testing::IsEmpty());
    EXPECT_EQ(scene->instances.size(), at_frame["objects"].size());
    for (const Instance& instance : scene->instances) {
      ASSERT_TRUE(at_frame["objects"].contains(instance.object)) << instance.object;
      std::map<std::tuple<long, long, long>, glm::dvec3> blender;
      for (const auto& pair : at_frame["objects"][instance.object]) blender[Key(Point(pair[0]))] = Point(pair[1]);
      EXPECT_EQ(blender.size(), 88u);
      const Mesh& mesh = scene->meshes[std::size_t(instance.mesh)];
      EXPECT_GE(mesh.positions.size(), blender.size());
      for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const auto found = blender.find(Key(Rest(mesh, v)));
        ASSERT_TRUE(found != blender.end()) << instance.object << ", vertex " << v;
        const glm::dvec3 ours(instance.world_from_object * glm::dvec4(mesh.positions[v], 1.0));
        double& error = worst[instance.object];
        error = std::max(error, glm::distance(ours, found->second));
      }
    }
    ASSERT_EQ(scene->cameras.size(), 1u);
    for (int column = 0; column < 4; ++column) {
      const glm::dvec3 ours(scene->cameras[0].world_from_camera[column]);
      EXPECT_LT(glm::distance(ours, Point(at_frame["camera"][std::size_t(column)])), 1e-5) << frame << ", " << column;
    }
  }
  for (const auto& [object, error] : worst) {
    std::cout << object << ": " << error << " m\n";
    EXPECT_LT(error, 2e-5) << object;  // of objects 4 m high, 7 m from the origin; all of it float
  }
}

}  // namespace
}  // namespace scumble
