// Materials, vertex colours, cameras and lights of glTF.
#include <cmath>

#include "tests/guidegen/load/load_gltf.h"
#include "tests/support/numbers.h"

namespace scumble {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

TEST_F(LoadGltf, MaterialsAndTextures) {
  GltfBuilder b = TexturedSquare();
  json& material = b.json["materials"][0];
  material["alphaMode"] = "MASK";
  material["alphaCutoff"] = 0.25;
  material["doubleSided"] = true;
  material["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 0;
  material["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
      {"offset", {0.5, 0.25}}, {"rotation", kPi / 2}, {"scale", {2, 3}}, {"texCoord", 1}};
  b.Append("materials", {{"alphaMode", "BLEND"}});
  const Scene scene = Load(b);
  ASSERT_EQ(scene.materials.size(), 2u);
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.name, "Paint");
  EXPECT_EQ(m.base_color, glm::vec4(0.25f, 0.5f, 0.75f, 1.0f));
  EXPECT_EQ(m.alpha_mode, AlphaMode::kMask);
  EXPECT_EQ(m.alpha_cutoff, 0.25f);
  EXPECT_TRUE(m.double_sided);
  EXPECT_EQ(m.normal_scale, 0.5f);
  EXPECT_EQ(m.base_color_texture.texture, 0);
  EXPECT_EQ(m.normal_texture.texture, 0);
  EXPECT_EQ(m.base_color_texture.uv_set, 1);
  EXPECT_EQ(m.base_color_texture.wrap_u, TextureWrap::kClamp);
  EXPECT_EQ(m.base_color_texture.wrap_v, TextureWrap::kMirror);
  EXPECT_TRUE(m.base_color_texture.nearest);
  // A quarter turn counter-clockwise in the picture takes (1, 0), right, to (0, -1), up.
  ExpectClose(m.base_color_texture.uv_transform * glm::vec3(0, 0, 1), {0.5, 0.25, 1});
  ExpectClose(m.base_color_texture.uv_transform * glm::vec3(1, 0, 1), {0.5, 0.25 - 2, 1});
  ExpectClose(m.base_color_texture.uv_transform * glm::vec3(0, 1, 1), {0.5 + 3, 0.25, 1});
  EXPECT_EQ(scene.materials[1].alpha_mode, AlphaMode::kBlend);
  EXPECT_FALSE(scene.materials[1].double_sided);
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0].rgba, (std::vector<std::uint16_t>{65535, 0, 0, 65535, 0, 65535, 0, 65535}));
  EXPECT_EQ(scene.meshes[0].uvs[1][2], glm::vec2(2, 2));
}

// The extension's own defaults: white, glossiness 1. Its metals are their specular colour, which nothing here can hold,
// so what it means is never metallic.
TEST_F(LoadGltf, SpecularGlossinessIsReadAsFarAsItGoes) {
  const char* name = "KHR_materials_pbrSpecularGlossiness";
  GltfBuilder b = TexturedSquare();
  b.json["extensionsUsed"] = {name};
  const auto add = [&](const json& extension) { b.Append("materials", {{"extensions", {{name, extension}}}}); };
  add({{"diffuseFactor", {0.25, 0.5, 0.75, 0.5}},
       {"diffuseTexture",
        {{"index", 0}, {"texCoord", 1}, {"extensions", {{"KHR_texture_transform", {{"scale", {2, 3}}}}}}}},
       {"specularFactor", {1, 0, 0}},
       {"glossinessFactor", 0.75}});
  add(json::object());
  add({{"diffuseFactor", {1, 0, 0, 1}}, {"specularGlossinessTexture", {{"index", 0}}}});
  b.json["materials"][0]["extensions"][name] = {{"diffuseFactor", {0, 0, 0, 1}}};
  const Scene scene = Load(b);
  ASSERT_EQ(scene.materials.size(), 4u);
  EXPECT_EQ(scene.materials[0].base_color, glm::vec4(0.25f, 0.5f, 0.75f, 1.0f)) << "the newer model goes first";
  EXPECT_EQ(scene.materials[0].metallic, 1.0f);
  const Material& full = scene.materials[1];
  EXPECT_EQ(full.base_color, glm::vec4(0.25f, 0.5f, 0.75f, 0.5f));
  EXPECT_EQ(full.base_color_texture.texture, 0);
  EXPECT_EQ(full.base_color_texture.uv_set, 1);
  ExpectClose(full.base_color_texture.uv_transform * glm::vec3(1, 1, 1), {2, 3, 1});
  EXPECT_EQ(full.metallic, 0.0f);
  EXPECT_EQ(full.roughness, 0.25f);
  EXPECT_EQ(scene.materials[2].base_color, glm::vec4(1.0f));
  EXPECT_EQ(scene.materials[2].roughness, 0.0f);
  EXPECT_EQ(scene.materials[3].base_color, glm::vec4(1, 0, 0, 1));
  EXPECT_EQ(scene.materials[3].roughness, 1.0f) << "its texture is not read";
  EXPECT_THAT(scene.warnings, ::testing::ElementsAre(::testing::AllOf(HasSubstr(name), HasSubstr("specular colour"),
                                                                      HasSubstr("material 1"), HasSubstr("3 in all"))));
  b.json["extensionsRequired"] = {name};
  EXPECT_EQ(Load(b).materials[1].roughness, 0.25f);
  for (const json& bad : {json{{"glossinessFactor", 1.5}}, json{{"glossinessFactor", "x"}},
                          json{{"diffuseFactor", {1, 1, 1}}}, json{{"diffuseFactor", {1, 1, -1, 1}}}}) {
    b.json["materials"][2]["extensions"][name] = bad;
    EXPECT_THAT(ErrorOf(b), HasSubstr("material 2 has ")) << bad;
  }
}

TEST_F(LoadGltf, TangentsAreKeptOrComputed) {
  GltfBuilder b = TexturedSquare();
  // The square's picture stands upright: u runs along +X, and up in the picture is +Y.
  Scene scene = Load(b);
  ASSERT_EQ(scene.meshes[0].tangents.size(), 4u);
  for (const glm::vec4& tangent : scene.meshes[0].tangents) {
    ExpectClose(glm::vec3(tangent), {1, 0, 0});
    EXPECT_EQ(tangent.w, 1.0f);
  }
  // Mirrored by the texture transform.
  b.json["materials"][0]["normalTexture"]["extensions"]["KHR_texture_transform"] = {{"scale", {-1, 1}}};
  scene = Load(b);
  for (const glm::vec4& tangent : scene.meshes[0].tangents) {
    ExpectClose(glm::vec3(tangent), {-1, 0, 0});
    EXPECT_EQ(tangent.w, -1.0f);
  }
  const int given = b.Floats({0, 2, 0, -1, 0, 2, 0, -1, 0, 2, 0, -1, 0, 2, 0, -1}, 4);
  json& attributes = b.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["TANGENT"] = given;
  EXPECT_EQ(Load(b).meshes[0].tangents[3], glm::vec4(-1, 0, 0, -1)) << "without normals they mean nothing";
  attributes["NORMAL"] = b.Floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  EXPECT_EQ(Load(b).meshes[0].tangents[3], glm::vec4(0, 1, 0, -1));
  b.json["materials"][0].erase("normalTexture");
  EXPECT_TRUE(Load(b).meshes[0].tangents.empty());
}

TEST_F(LoadGltf, VertexColors) {
  GltfBuilder b;
  b.Triangle();
  json& attributes = b.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["COLOR_0"] = b.Floats({1, 0, 0, 0, 0.5, 0, 0, 0, 2}, 3);
  EXPECT_EQ(Load(b).meshes[0].colors, (std::vector<glm::vec4>{{1, 0, 0, 1}, {0, 0.5, 0, 1}, {0, 0, 2, 1}}));
  const int view = b.View(std::vector<std::uint8_t>{255, 0, 51, 255, 0, 0, 0, 0, 255, 255, 255, 102});
  const int color = b.Accessor(view, kUbyte, 3, "VEC4");
  b.json["accessors"][color]["normalized"] = true;
  attributes["COLOR_0"] = color;
  EXPECT_EQ(Load(b).meshes[0].colors[0], glm::vec4(1, 0, 51.0f / 255.0f, 1));
  EXPECT_EQ(Load(b).meshes[0].colors[2].a, 102.0f / 255.0f);
}

TEST_F(LoadGltf, Cameras) {
  GltfBuilder b;
  b.Triangle();
  b.Append("cameras",
           {{"type", "perspective"}, {"perspective", {{"yfov", kPi / 3}, {"znear", 0.1}, {"aspectRatio", 1.5}}}});
  b.Append("cameras",
           {{"type", "orthographic"}, {"orthographic", {{"xmag", 4}, {"ymag", 2}, {"znear", 0.5}, {"zfar", 50}}}});
  const int first = b.Append("nodes", {{"name", "Eye"}, {"camera", 0}, {"translation", {0, 0, 2}}});
  b.Root({{"scale", {3, 3, 3}}, {"rotation", {0, std::sqrt(0.5), 0, std::sqrt(0.5)}}, {"children", {first}}});
  b.Root({{"name", "Eye"}, {"camera", 1}});
  const Scene scene = Load(b);
  ASSERT_EQ(scene.cameras.size(), 2u);
  const Camera& eye = scene.cameras[0];
  EXPECT_EQ(eye.name, "Eye");
  EXPECT_NEAR(eye.yfov_degrees, 60.0, 1e-12);
  EXPECT_EQ(eye.z_near, 0.1);
  EXPECT_TRUE(std::isinf(eye.z_far));
  EXPECT_EQ(eye.aspect, 1.5);
  // The scale moves the camera but does not stretch its axes: a quarter turn about +Y takes +Z to +X.
  ExpectClose(glm::vec3(eye.world_from_camera[2]), {1, 0, 0});
  ExpectClose(glm::vec3(eye.world_from_camera[3]), {6, 0, 0});
  EXPECT_NEAR(glm::determinant(glm::dmat3(eye.world_from_camera)), 1.0, 1e-12);
  EXPECT_EQ(scene.cameras[1].name, "Eye#2");
  EXPECT_TRUE(scene.cameras[1].orthographic);
  EXPECT_EQ(scene.cameras[1].ymag, 2.0);
  EXPECT_EQ(scene.cameras[1].aspect, 2.0);
  EXPECT_EQ(scene.cameras[1].z_far, 50.0);
}

TEST_F(LoadGltf, LightsBecomeRadiometric) {
  GltfBuilder b;
  b.Triangle();
  b.json["extensionsRequired"] = {"KHR_lights_punctual"};
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"intensity", 683.0}, {"color", {1, 0.5, 0.25}}},
      {{"type", "spot"}, {"intensity", 1366.0}, {"spot", {{"innerConeAngle", kPi / 12}, {"outerConeAngle", kPi / 6}}}},
      {{"type", "directional"}}};
  for (int i = 0; i < 3; ++i)
    b.Root({{"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}, {"translation", {i, 0, 0}}});
  const Scene scene = Load(b);
  ASSERT_EQ(scene.lights.size(), 3u);
  EXPECT_EQ(scene.lights[0].type, LightType::kPoint);
  EXPECT_DOUBLE_EQ(scene.lights[0].intensity, 1.0);
  EXPECT_EQ(scene.lights[0].color, glm::vec3(1, 0.5, 0.25));
  EXPECT_EQ(scene.lights[1].type, LightType::kSpot);
  EXPECT_DOUBLE_EQ(scene.lights[1].intensity, 2.0);
  EXPECT_NEAR(scene.lights[1].inner_cone_degrees, 15.0, 1e-12);
  EXPECT_NEAR(scene.lights[1].outer_cone_degrees, 30.0, 1e-12);
  EXPECT_EQ(scene.lights[1].world_from_light[3].x, 1.0);
  EXPECT_EQ(scene.lights[2].type, LightType::kSun);
  EXPECT_DOUBLE_EQ(scene.lights[2].intensity, 1.0 / 683.0);
}

TEST_F(LoadGltf, TheRangeOfLightsIsIgnoredAndSaid) {
  GltfBuilder b;
  b.Triangle();
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"range", 3.0}},
                                                           {{"type", "spot"}, {"range", 4.0}, {"spot", json::object()}},
                                                           {{"type", "directional"}, {"range", 5.0}}};
  for (const int light : {2, 0, 1, 0}) b.Root({{"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
  Scene scene = Load(b);
  EXPECT_EQ(scene.lights.size(), 4u);
  EXPECT_THAT(scene.warnings,
              ::testing::ElementsAre(::testing::AllOf(HasSubstr("range"), HasSubstr("node 2"), HasSubstr("3 in all"))));
  for (json& light : b.json["extensions"]["KHR_lights_punctual"]["lights"]) light.erase("range");
  EXPECT_THAT(Load(b).warnings, ::testing::IsEmpty());
}

TEST_F(LoadGltf, LampsAndCamerasWithoutADirectionAreRefused) {
  GltfBuilder b;
  b.Triangle();
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  b.Append("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}});
  const json parts[] = {{{"camera", 0}}, {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}};
  for (const json& part : parts) {
    GltfBuilder with = b;
    const int node = with.Root(part);
    with.json["nodes"][node]["scale"] = {1, 1, 0};
    EXPECT_THAT(ErrorOf(with), HasSubstr("no direction"));
    // Scale and shear are dropped where a direction is left.
    with.json["nodes"][node].erase("scale");
    with.json["nodes"][node]["matrix"] = {5, 1, 0, 0, 0, 2, 1, 0, 0, 0, 3, 0, 7, 8, 9, 1};
    const Scene scene = Load(with);
    const glm::dmat4 rigid =
        scene.cameras.empty() ? scene.lights.at(0).world_from_light : scene.cameras[0].world_from_camera;
    ExpectClose(glm::vec3(rigid[0]), {1, 0, 0});
    ExpectClose(glm::vec3(rigid[1]), {0, 1, 0});
    ExpectClose(glm::vec3(rigid[2]), {0, 0, 1});
    ExpectClose(glm::vec3(rigid[3]), {7, 8, 9});
  }
}

TEST_F(LoadGltf, NormalMapsAndBumpsOfBlender) {
  GltfBuilder b = TexturedSquare();
  json& material = b.json["materials"][0];
  const json texture = {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"scale", {-2, 1}}}}}}};
  material["normalTexture"] = texture;
  json& ours = material["extras"]["scumble"];
  ours["normal"] = {{"space", "TANGENT"}, {"strength", 1.5}};
  ours["bump"] = {{"strength", 0.25}, {"distance", -2.0}, {"srgb", true}, {"texture", texture}};
  b.json["meshes"][0]["extras"]["scumble"]["stretch"] = {2, 0, 0, 0, 1, 0, 0, 0, 1};
  Scene scene = Load(b);
  const Material& read = scene.materials[0];
  EXPECT_EQ(read.normal_rule, NormalMapRule::kTangent);
  EXPECT_EQ(read.normal_scale, 1.5f);
  EXPECT_EQ(read.bump.height_texture.texture, read.normal_texture.texture);
  EXPECT_EQ(read.bump.height_texture.uv_transform[0][0], -2.0f);
  EXPECT_EQ(read.bump.strength, 0.25f);
  EXPECT_EQ(read.bump.distance, -2.0f);
  EXPECT_TRUE(read.bump.srgb);
  EXPECT_EQ(scene.meshes[0].stretch[0][0], 2.0);
  ExpectClose(glm::vec3(scene.meshes[0].tangents[0]), {1, 0, 0});  // of the UV map, not of the texture's place in it
  ours["normal"] = {{"space", "BLENDER_OBJECT"}, {"strength", 1}, {"texture", texture}};
  material.erase("normalTexture");
  scene = Load(b);
  EXPECT_EQ(scene.materials[0].normal_rule, NormalMapRule::kBlenderObject);
  EXPECT_GE(scene.materials[0].normal_texture.texture, 0);
  EXPECT_TRUE(scene.meshes[0].tangents.empty());

  const json good = b.json;
  const auto expect_refused = [&](const std::string& place, const json& bad) {
    b.json = good;
    b.json[json::json_pointer(place)] = bad;
    const auto refused = LoadScene(Write("bad.glb", b.Glb()));
    ASSERT_FALSE(refused) << place << " " << bad;
    EXPECT_THAT(refused.error().message, HasSubstr("bad.glb"));
    EXPECT_THAT(refused.error().message, HasSubstr(place.substr(place.rfind('/') + 1)));
  };
  const std::string extras = "/materials/0/extras/scumble/";
  for (const json& bad : {json("UPRIGHT"), json(1), json()}) expect_refused(extras + "normal/space", bad);
  for (const json& bad : {json(-1), json("1"), json()}) {
    expect_refused(extras + "normal/strength", bad);
    expect_refused(extras + "bump/strength", bad);
  }
  expect_refused(extras + "bump/distance", "1");
  for (const json& bad : {json(1), json({1, 0, 0}), json({0, 0, 0, 0, 0, 0, 0, 0, 0}),
                          json({1, 2, 0, 0, 1, 0, 0, 0, 1}), json({1, "0", 0, 0, 1, 0, 0, 0, 1})}) {
    expect_refused("/meshes/0/extras/scumble/stretch", bad);
  }
}

}  // namespace
}  // namespace scumble
