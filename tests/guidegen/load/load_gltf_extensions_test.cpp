// KHR_node_visibility and EXT_mesh_gpu_instancing.
#include <gtest/gtest.h>

#include "guidegen/guidegen.h"
#include "tests/guidegen/load/load_gltf.h"

namespace scumble {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

json Visible(bool visible) { return {{"KHR_node_visibility", {{"visible", visible}}}}; }

TEST_F(LoadGltf, HiddenNodesHideWhatIsBelowButNoCamera) {
  GltfBuilder b;
  b.Triangle("Seen");
  b.json["extensionsRequired"] = {"KHR_node_visibility"};
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  b.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}}};
  const std::size_t first = b.json["nodes"].size();
  b.Append("nodes", {{"mesh", 0}, {"name", "Below"}, {"extensions", Visible(true)}});
  b.Append("nodes",
           {{"name", "Lamp"}, {"scale", {0, 0, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  b.Append("nodes", {{"name", "Eye"}, {"camera", 0}});
  b.Root({{"name", "Off"}, {"extensions", Visible(false)}, {"children", {first, first + 1, first + 2}}});
  const Scene scene = Load(b);
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].object, "Seen");
  EXPECT_TRUE(scene.lights.empty());
  EXPECT_EQ(scene.cameras.size(), 1u);
}

TEST_F(LoadGltf, HiddenNodesTakeNoNames) {
  GltfBuilder b;
  b.json["nodes"][b.Triangle("Tree")]["extensions"] = Visible(false);
  b.Root({{"name", "Tree"}, {"mesh", 0}});
  EXPECT_THAT(ObjectNames(Load(b)), ElementsAre("Tree"));
}

TEST_F(LoadGltf, AnimatedVisibilityIsLeftOut) {
  GltfBuilder b;
  const int node = b.Triangle("Seen");
  b.Animate(node, "pointer", {0, 1}, {0, 0, 0, 1, 1, 1});
  json& target = b.json["animations"][0]["channels"][0]["target"];
  target.erase("node");
  target["extensions"]["KHR_animation_pointer"]["pointer"] = "/nodes/0/extensions/KHR_node_visibility/visible";
  b.json["extensionsUsed"] = {"KHR_animation_pointer"};
  EXPECT_THAT(Load(b).warnings, Contains(HasSubstr("animation of visibility and other properties is left out")));
  EXPECT_THAT(Load(b).warnings, Not(Contains(HasSubstr("not valid glTF"))));
}

// Points that nobody sees are no reason to refuse a scene.
TEST_F(LoadGltf, HiddenPointsAreNotAskedFor) {
  GltfBuilder b;
  const int node = b.Triangle("Cloud");
  b.json["meshes"][0]["primitives"][0]["mode"] = 0;
  EXPECT_THAT(ErrorOf(b), HasSubstr("points"));
  b.json["nodes"][node]["extensions"] = Visible(false);
  EXPECT_TRUE(Load(b).instances.empty());
}

class GpuInstances : public LoadGltf {
 protected:
  // A triangle, three times, in a node that is moved by 10 along x.
  GltfBuilder Copies() {
    GltfBuilder b;
    const int node = b.Triangle("Leaf");
    b.json["nodes"][node]["translation"] = {10, 0, 0};
    const int places = b.Floats({0, 0, 0, 0, 1, 0, 0, 2, 0}, 3);
    const int turns = b.Floats({0, 0, 0, 1, 0, 0, 2, 0, 0, 0, 0, 1}, 4);  // the second by half a turn about z
    const int sizes = b.Floats({1, 1, 1, 1, 1, 1, 3, 3, 3}, 3);
    b.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    b.json["nodes"][node]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        {"TRANSLATION", places}, {"ROTATION", turns}, {"SCALE", sizes}};
    return b;
  }
};

TEST_F(GpuInstances, AreObjectsOfTheirOwn) {
  GltfBuilder b = Copies();
  b.Root({{"name", "Leaf#2"}, {"mesh", 0}});
  const Scene scene = Load(b);
  ASSERT_EQ(scene.instances.size(), 4u);
  EXPECT_EQ(scene.meshes.size(), 1u);
  const glm::dvec4 expected[] = {{11, 0, 0, 1}, {9, 1, 0, 1}, {13, 2, 0, 1}};
  const char* const names[] = {"Leaf", "Leaf#3", "Leaf#4"};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(scene.instances[i].object, names[i]);
    const glm::dvec4 place = scene.instances[i].world_from_object * glm::dvec4(1, 0, 0, 1);
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(place[k], expected[i][k], 1e-12) << i;
  }
}

TEST_F(GpuInstances, FollowTheirParents) {
  GltfBuilder b = Copies();
  const int parent = b.Append("nodes", {{"name", "Parent"}, {"children", {0}}});
  b.json["scenes"][0]["nodes"] = {parent};
  b.Animate(parent, "translation", {0, 1}, {0, 0, 0, 0, 0, 8});
  const Expected<AnimatedScene> animated = AnimatedScene::Load(Write("scene.glb", b.Glb()), {});
  ASSERT_TRUE(animated.ok()) << animated.error().message;
  const Expected<Scene> scene = animated->SceneAt(0.5);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  ASSERT_EQ(scene->instances.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(glm::dvec3(scene->instances[i].world_from_object[3]), glm::dvec3(10, i, 4)) << i;
  }
}

TEST_F(GpuInstances, WithoutPlacesAreSeenOnce) {
  GltfBuilder b = Copies();
  b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"_ID", b.Floats({0, 1, 2}, 1)}};
  const Scene scene = Load(b);
  EXPECT_EQ(scene.instances.size(), 1u);
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("without places for them are ignored, it is seen once")));
}

TEST_F(GpuInstances, ListsMustFitEachOther) {
  GltfBuilder b = Copies();
  json& attributes = b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  const json good = attributes;
  attributes["SCALE"] = b.Floats({1, 1, 1}, 3);
  EXPECT_THAT(ErrorOf(b), HasSubstr("node 0 'Leaf', EXT_mesh_gpu_instancing, SCALE has 1 entries, ROTATION has 3"));
  attributes = good, attributes["ROTATION"] = b.Floats({0, 0, 0, 0, 0, 0, 0, 0, 0}, 3);
  EXPECT_THAT(ErrorOf(b), HasSubstr("ROTATION has 3 numbers each; expected 4"));
  attributes["ROTATION"] = b.Floats(std::vector<float>(12, 0.0f), 4);
  EXPECT_THAT(ErrorOf(b), HasSubstr("entry 0 has a rotation of zero length"));
  attributes["ROTATION"] = 999;
  EXPECT_THAT(ErrorOf(b), HasSubstr("ROTATION"));
}

}  // namespace
}  // namespace scumble
