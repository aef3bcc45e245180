// The pure material that replaces each glTF material.
#include "guidegen/pure_materials.h"

#include <gtest/gtest.h>

namespace scumble {
namespace {

Scene OneMaterial(const Material& material) {
  Scene scene;
  scene.materials = {material};
  scene.meshes.emplace_back();
  scene.instances.push_back({"object", 0, glm::dmat4(1.0)});
  return scene;
}

TEST(PureMaterials, MetalnessDecidesAndATextureMeansDiffuse) {
  const auto pure = [](float metallic, int texture) {
    Material material;
    material.name = "paint";
    material.metallic = metallic;
    material.metallic_roughness_texture.texture = texture;
    Scene scene = OneMaterial(material);
    EXPECT_EQ(UsePureMaterials(scene), std::vector<std::string>{"paint"});
    return scene.materials[0].bsdf;
  };
  EXPECT_EQ(pure(0.0f, -1), Bsdf::kDiffuse);
  EXPECT_EQ(pure(0.49f, -1), Bsdf::kDiffuse);
  EXPECT_EQ(pure(0.5f, -1), Bsdf::kGlossy);
  EXPECT_EQ(pure(1.0f, -1), Bsdf::kGlossy);
  EXPECT_EQ(pure(1.0f, 0), Bsdf::kDiffuse);
}

TEST(PureMaterials, EverythingElseStaysAndPureOnesAreLeftAlone) {
  Material material;
  material.name = "metal";
  material.base_color = {0.1f, 0.2f, 0.3f, 0.4f};
  material.metallic = 1.0f;
  material.roughness = 0.3f;
  material.emission = glm::vec3(2.0f);
  material.normal_texture.texture = 3;
  Scene scene = OneMaterial(material);
  UsePureMaterials(scene);
  EXPECT_EQ(scene.materials[0].base_color, material.base_color);
  EXPECT_EQ(scene.materials[0].roughness, 0.3f);
  EXPECT_EQ(scene.materials[0].emission, glm::vec3(2.0f));
  EXPECT_EQ(scene.materials[0].normal_texture.texture, 3);
  for (const Bsdf bsdf : {Bsdf::kDiffuse, Bsdf::kGlossy, Bsdf::kEmission}) {
    material.bsdf = bsdf;
    Scene already = OneMaterial(material);
    EXPECT_TRUE(UsePureMaterials(already).empty());
    EXPECT_EQ(already.materials[0].bsdf, bsdf);
  }
}

TEST(PureMaterials, MaterialsThatNothingWearsAreReplacedAndNotNamed) {
  Material worn, spare;
  worn.name = "worn", spare.name = "spare", spare.metallic = 1.0f;
  Scene scene = OneMaterial(worn);
  scene.materials.push_back(spare);
  EXPECT_EQ(UsePureMaterials(scene), std::vector<std::string>{"worn"});
  EXPECT_EQ(scene.materials[1].bsdf, Bsdf::kGlossy);
}

}  // namespace
}  // namespace scumble
