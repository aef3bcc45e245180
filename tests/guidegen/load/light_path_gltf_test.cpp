// glTF's data on how materials reflect and emit light.
#include <gtest/gtest.h>

#include <string>

#include "guidegen/load_scene.h"
#include "tests/support/gltf_builder.h"

namespace scumble {
namespace {

using GltfLight = LoaderTest;

TEST_F(GltfLight, FactorsAndStrengthAreRead) {
  GltfBuilder gltf;
  gltf.Triangle();
  gltf.Append("materials", {{"pbrMetallicRoughness", {{"metallicFactor", 0.25}, {"roughnessFactor", 0.75}}},
                            {"emissiveFactor", {0.5, 0.25, 1.0}},
                            {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4.0}}}}}});
  gltf.Append("materials", {{"name", "plain"}});
  gltf.json["extensionsUsed"] = {"KHR_materials_emissive_strength"};
  const auto scene = LoadScene(Write("a.glb", gltf.Glb()));
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->materials[0].bsdf, Bsdf::kMetallicRoughness);
  EXPECT_FLOAT_EQ(scene->materials[0].metallic, 0.25f);
  EXPECT_FLOAT_EQ(scene->materials[0].roughness, 0.75f);
  EXPECT_EQ(scene->materials[0].emission, glm::vec3(2.0f, 1.0f, 4.0f));
  // glTF's own defaults: a rough metal that does not glow.
  EXPECT_EQ(scene->materials[1].metallic, 1.0f);
  EXPECT_EQ(scene->materials[1].roughness, 1.0f);
  EXPECT_EQ(scene->materials[1].emission, glm::vec3(0.0f));
  EXPECT_EQ(scene->materials[1].metallic_roughness_texture.texture, -1);
}

TEST_F(GltfLight, DiffuseRoughnessOfABlendFileIsRead) {
  const auto load = [&](const nlohmann::json& bsdf) {
    GltfBuilder gltf;
    gltf.Triangle();
    gltf.Append("materials", {{"name", "Clay"}, {"extras", {{"scumble", {{"bsdf", bsdf}}}}}});
    return LoadScene(Write("a.glb", gltf.Glb()));
  };
  const nlohmann::json lambert = {{"type", "DIFFUSE"}, {"color", {0.5, 0.5, 0.5}}};
  nlohmann::json rough = lambert, broken = lambert;
  rough["roughness"] = 0.75;
  broken["roughness"] = 1.5;
  ASSERT_TRUE(load(lambert)) << "written by an earlier version";
  EXPECT_EQ(load(lambert)->materials[0].diffuse_roughness, 0.0f);
  EXPECT_EQ(load(rough)->materials[0].diffuse_roughness, 0.75f);
  ASSERT_FALSE(load(broken));
  EXPECT_NE(load(broken).error().message.find("'roughness' is 1.5"), std::string::npos) << load(broken).error().message;
}

TEST_F(GltfLight, TheVersionOfBlenderSaysWhatSurfacesAndSpotsMean) {
  const auto load = [&](const nlohmann::json& extras, const nlohmann::json& cosine) {
    GltfBuilder gltf;
    gltf.Triangle();
    gltf.Append("materials", {{"name", "Clay"}});
    nlohmann::json lamp = {{"type", "SPOT"}, {"color", {1, 1, 1}}, {"energy", 10.0},
                           {"radius", 0.0},  {"spot_size", 1.0},   {"spot_blend", 0.5}};
    if (!cosine.is_null()) lamp["cosine"] = cosine;
    gltf.Root({{"name", "Lamp"}, {"extras", {{"scumble", {{"lamp", lamp}}}}}});
    gltf.json["scenes"][0]["extras"] = extras;
    auto scene = LoadScene(Write("a.glb", gltf.Glb()));
    EXPECT_TRUE(scene) << scene.error().message;
    return scene ? *scene : Scene();
  };
  const Scene old = load({{"scumble", {{"blender", "3.4.1"}}}}, nullptr);
  EXPECT_FALSE(old.materials.at(0).cycles4);
  EXPECT_TRUE(old.lights.at(0).spot_cosine);
  const Scene recent = load({{"scumble", {{"blender", "4.3.2"}}}}, false);
  EXPECT_TRUE(recent.materials.at(0).cycles4);
  EXPECT_FALSE(recent.lights.at(0).spot_cosine);
  EXPECT_FALSE(load({{"scumble", {{"blender", "of mine"}}}}, true).materials.at(0).cycles4);
}

TEST_F(GltfLight, ValuesOutOfRangeAreRefusedByName) {
  const auto refuse = [&](const nlohmann::json& material, const std::string& what) {
    GltfBuilder gltf;
    gltf.Triangle();
    gltf.Append("materials", material);
    const auto scene = LoadScene(Write("bad.glb", gltf.Glb()));
    ASSERT_FALSE(scene) << what;
    EXPECT_EQ(scene.error().kind, ErrorKind::kInput);
    EXPECT_NE(scene.error().message.find("bad.glb"), std::string::npos) << scene.error().message;
    EXPECT_NE(scene.error().message.find(what), std::string::npos) << scene.error().message;
  };
  refuse({{"pbrMetallicRoughness", {{"roughnessFactor", 1.5}}}}, "roughness");
  refuse({{"pbrMetallicRoughness", {{"metallicFactor", -0.1}}}}, "metallic");
  refuse({{"emissiveFactor", {-1.0, 0.0, 0.0}}}, "emissive");
  refuse({{"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", -2.0}}}}}}, "emissive strength");
}

}  // namespace
}  // namespace scumble
