// Animations, skins and morph targets that are broken: refused by file and place, or harmless.
#include "guidegen/guidegen.h"
#include "tests/support/animation_fixtures.h"

namespace scumble {
namespace {

TEST_F(LoadAnimation, BrokenAnimationsAreRefusedByPlace) {
  GltfBuilder good;
  const int node = good.Triangle();
  good.Animate(node, "rotation", {0, 1}, {0, 0, 0, 1, 0, kHalf, 0, kHalf});
  good.json["animations"][0]["name"] = "Spin";
  Load(good);
  const auto broken = [&](auto change) {
    GltfBuilder b = good;
    json& animation = b.json["animations"][0];
    change(b, animation);
    const std::string message = ErrorOf(b);
    EXPECT_THAT(message, HasSubstr("animation 'Spin', channel 0"));
    return message;
  };
  const float nan = std::nanf("");
  const auto times = [](const std::vector<float>& values) {
    return [values](GltfBuilder& b, json& animation) { animation["samplers"][0]["input"] = b.Floats(values, 1); };
  };
  EXPECT_THAT(broken(times({0, nan})), HasSubstr("NaN or infinity at key 1"));
  EXPECT_THAT(broken(times({1, 1})), HasSubstr("does not increase at key 1"));
  EXPECT_THAT(broken(times({2, 1})), HasSubstr("does not increase at key 1"));
  EXPECT_THAT(broken(times({0, 1, 2})), HasSubstr("2 elements for 3 keys; expected 3"));
  EXPECT_THAT(broken(times({})), HasSubstr("no key"));
  const auto values = [](const std::vector<float>& list, int components) {
    return [=](GltfBuilder& b, json& animation) { animation["samplers"][0]["output"] = b.Floats(list, components); };
  };
  EXPECT_THAT(broken(values({0, 0, 0, 1, 0, nan, 0, 1}, 4)), HasSubstr("NaN or infinity at key 1"));
  EXPECT_THAT(broken(values({0, 0, 0, 1, 0, 0, 0, 0}, 4)), HasSubstr("zero length at key 1"));
  EXPECT_THAT(broken(values({0, 0, 0, 1, 0, 0}, 3)), HasSubstr("3 components; expected 4"));
  const auto set = [](const char* list, const char* key, const json& value) {
    return [=](GltfBuilder&, json& animation) { animation[list][0][key] = value; };
  };
  EXPECT_THAT(broken(set("samplers", "interpolation", "CUBICSPLINE")), HasSubstr("expected 6"));
  EXPECT_THAT(broken(set("samplers", "interpolation", "WAVY")), HasSubstr("'WAVY'"));
  EXPECT_THAT(broken(set("samplers", "output", 99)), HasSubstr("accessor 99 does not exist"));
  EXPECT_THAT(broken(set("channels", "sampler", 7)), HasSubstr("sampler 7"));
  EXPECT_THAT(broken(set("channels", "target", {{"node", 44}, {"path", "scale"}})), HasSubstr("node 44"));
  EXPECT_THAT(broken([](GltfBuilder& b, json&) {
                b.json["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
              }),
              HasSubstr("has a matrix"));
  // A scene that plays nothing does not care.
  GltfBuilder b = good;
  b.json["animations"][0]["channels"][0]["sampler"] = 7;
  EXPECT_TRUE(LoadScene(Write("scene.glb", b.Glb())).ok());
}

TEST_F(LoadAnimation, BrokenSkinsAreRefusedByPlace) {
  const auto broken = [&](auto change, const std::string& place = "skin 0 'Rig'") {
    Bar bar;
    change(bar.b);
    const std::string message = ErrorOf(bar.b);
    EXPECT_THAT(message, HasSubstr(place));
    return message;
  };
  const auto attribute = [](const char* name, int accessor, GltfBuilder& b) {
    b.json["meshes"][0]["primitives"][0]["attributes"][name] = accessor;
  };
  EXPECT_THAT(broken([](GltfBuilder& b) { b.json["skins"][0]["joints"] = json::array(); }), HasSubstr("no joints"));
  EXPECT_THAT(broken([](GltfBuilder& b) { b.json["skins"][0]["joints"] = {0, 99}; }), HasSubstr("node 99"));
  EXPECT_THAT(broken([](GltfBuilder& b) {
                b.json["skins"][0]["joints"] = {0, 1, 2};
              }),
              HasSubstr("2 inverse bind matrices for 3 joints"));
  EXPECT_THAT(broken([](GltfBuilder& b) { b.json["skins"][0]["inverseBindMatrices"] = 0; }), HasSubstr("no list of 4"));
  EXPECT_THAT(broken([](GltfBuilder& b) {
                std::vector<float> values(32, 0.0f);
                values[3] = std::nanf("");
                b.json["skins"][0]["inverseBindMatrices"] = b.Matrices(values);
              }),
              HasSubstr("NaN or infinity in matrix 0"));
  EXPECT_THAT(
      broken([](GltfBuilder& b) { b.json["skins"][0]["inverseBindMatrices"] = b.Matrices(std::vector<float>(32)); }),
      HasSubstr("projective part, for joint 0"));
  EXPECT_THAT(broken([](GltfBuilder& b) { b.json["nodes"][2]["skin"] = 5; }, "skin 5"), HasSubstr("does not exist"));
  EXPECT_THAT(broken(
                  [&](GltfBuilder& b) {
                    attribute("JOINTS_0", b.Accessor(b.View(std::vector<std::uint8_t>(24, 2)), kUbyte, 6, "VEC4"), b);
                  },
                  "JOINTS_0"),
              HasSubstr("joint 2.000000 of 2 at vertex 0"));
  EXPECT_THAT(
      broken([&](GltfBuilder& b) { attribute("JOINTS_0", b.Floats(std::vector<float>(24, 0), 4), b); }, "JOINTS_0"),
      HasSubstr("unsigned bytes or shorts"));
  EXPECT_THAT(
      broken([&](GltfBuilder& b) { attribute("WEIGHTS_0", b.Floats(std::vector<float>(20, 1), 4), b); }, "WEIGHTS_0"),
      HasSubstr("5 elements for 6 positions"));
  EXPECT_THAT(
      broken([&](GltfBuilder& b) { attribute("WEIGHTS_0", b.Floats(std::vector<float>(24, std::nanf("")), 4), b); },
             "WEIGHTS_0"),
      HasSubstr("at vertex 0"));
  EXPECT_THAT(
      broken([&](GltfBuilder& b) { attribute("WEIGHTS_0", b.Floats(std::vector<float>(24, -1), 4), b); }, "WEIGHTS_0"),
      HasSubstr("the weight -1"));
}

TEST_F(LoadAnimation, BrokenMorphsAreRefusedByPlace) {
  GltfBuilder good;
  const int node = good.Triangle("Face");
  good.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", good.Floats(std::vector<float>(9, 1), 3)}}};
  good.Animate(node, "weights", {0, 1}, {0, 1});
  Load(good);
  const auto broken = [&](auto change) {
    GltfBuilder b = good;
    change(b, b.json["meshes"][0]["primitives"][0]["targets"][0]);
    return ErrorOf(b);
  };
  EXPECT_THAT(broken([](GltfBuilder& b, json& target) { target["POSITION"] = b.Floats(std::vector<float>(6, 1), 3); }),
              HasSubstr("2 elements for 3 positions"));
  EXPECT_THAT(broken([](GltfBuilder& b, json& target) {
                target["POSITION"] = b.Floats({0, 0, 0, 0, std::nanf(""), 0, 0, 0, 0}, 3);
              }),
              HasSubstr("morph target 0, POSITION: accessor"));
  EXPECT_THAT(broken([](GltfBuilder& b, json&) {
                b.json["nodes"][0]["weights"] = {1, 2};
              }),
              HasSubstr("2 morph weights for 1 targets"));
  EXPECT_THAT(broken([](GltfBuilder& b, json&) {
                b.json["animations"][0]["samplers"][0]["output"] = b.Floats({0, 0, 1, 1}, 1);
              }),
              HasSubstr("2 morph weights a key for 1 targets"));
  EXPECT_THAT(broken([](GltfBuilder& b, json& target) {
                target["POSITION"] = b.Floats(std::vector<float>(9, 3e38f), 3);
                b.json["nodes"][0]["weights"] = {9};
              }),
              HasSubstr("deformed to infinity"));
}

TEST_F(LoadAnimation, WhatHasNoSenseAtATimeNamesTheTime) {
  GltfBuilder b;
  b.Append("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}});
  const int node = b.Root({{"name", "Eye"}, {"camera", 0}});
  b.Animate(node, "scale", {0, 1}, {1, 1, 1, 0, 0, 0});
  const AnimatedScene animated = Load(b);
  EXPECT_TRUE(animated.SceneAt(0.5).ok());
  const Expected<Scene> scene = animated.SceneAt(1.0);
  ASSERT_FALSE(scene.ok());
  EXPECT_THAT(scene.error().message, ::testing::AllOf(HasSubstr("scene.glb"), HasSubstr("1.0"), HasSubstr("camera")));
}

// Random damage must end in an error or in a scene that can be shown, never in a crash; the sanitizer build looks on.
TEST_F(LoadAnimation, DamagedFilesNeverCrash) {
  Bar bar;
  bar.b.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", bar.b.Floats(std::vector<float>(18, 1), 3)}}};
  bar.b.Animate(bar.tip, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, kHalf, kHalf});
  bar.b.Animate(bar.node, "weights", {0, 1, 2}, {0, 1, 0});
  const std::vector<unsigned char> whole = bar.b.Glb();
  std::uint32_t state = 1;
  const auto random = [&](std::size_t below) {
    state = state * 1664525u + 1013904223u;
    return std::size_t((std::uint64_t(state) * below) >> 32);
  };
  int shown = 0;
  for (int i = 0; i < 600; ++i) {
    std::vector<unsigned char> bytes = whole;
    for (std::size_t n = 1 + random(3); n-- > 0;) {
      unsigned char& byte = bytes[20 + random(bytes.size() - 20)];
      // A digit becomes another one, so that much of the damage passes the parser.
      byte =
          std::isdigit(byte) ? static_cast<unsigned char>('0' + random(10)) : static_cast<unsigned char>(random(256));
    }
    const Expected<AnimatedScene> animated = AnimatedScene::Load(Write("damaged.glb", bytes), {"*"});
    if (!animated) continue;
    const Expected<Scene> scene = animated->SceneAt(0.7);
    if (!scene) continue;
    ++shown;
    for (const Mesh& mesh : scene->meshes) {
      for (const glm::vec3& p : mesh.positions) ASSERT_TRUE(std::isfinite(p.x + p.y + p.z));
    }
  }
  EXPECT_GT(shown, 30);
}

}  // namespace
}  // namespace scumble
