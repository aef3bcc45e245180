// Scenes over time: node animation, skins and morph targets of small glTF files against numbers worked out by hand.
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "guidegen/guidegen.h"
#include "tests/support/animation_fixtures.h"

namespace scumble {
namespace {

TEST_F(LoadAnimation, ATurningNode) {
  GltfBuilder b;
  const int node = b.Triangle();
  b.json["nodes"][node]["translation"] = {1, 2, 3};
  b.json["nodes"][node]["scale"] = {2, 2, 2};
  b.Animate(node, "rotation", {1, 2}, {0, 0, 0, 1, 0, kHalf, 0, kHalf});
  const AnimatedScene animated = Load(b);
  EXPECT_TRUE(animated.moves());
  EXPECT_EQ(animated.duration_seconds(), 2.0);
  const glm::dmat4 move = glm::translate(glm::dmat4(1.0), glm::dvec3(1, 2, 3));
  for (const auto& [seconds, degrees] :
       {std::pair{-5.0, 0.0}, {0.0, 0.0}, {1.0, 0.0}, {1.5, 45.0}, {1.9, 81.0}, {2.0, 90.0}, {99.0, 90.0}}) {
    const Scene scene = At(animated, seconds);
    const glm::dmat4 expected = glm::scale(move * RotationY(degrees), glm::dvec3(2.0));
    EXPECT_LT(LargestDifference(scene.instances[0].world_from_object, expected), kFloatError) << seconds;
  }
  EXPECT_THAT(At(animated, 0.0).warnings, ::testing::IsEmpty());
}

TEST_F(LoadAnimation, RotationsTakeTheShorterWay) {
  GltfBuilder b;
  const int node = b.Triangle();
  b.Animate(node, "rotation", {0, 1}, {0, 0, 0, 1, 0, -kHalf, 0, -kHalf});  // the same 90°, written negated
  EXPECT_LT(LargestDifference(At(b, 0.5).instances[0].world_from_object, RotationY(45)), kFloatError);
}

TEST_F(LoadAnimation, RotationsAsNormalizedShorts) {
  GltfBuilder b;
  const int node = b.Triangle();
  b.Animate(node, "rotation", {0, 1}, {0, 0, 0, 1, 0, 1, 0, 0});
  const int output = b.Accessor(b.View(std::vector<std::int16_t>{0, 0, 0, 32767, 0, 32767, 0, 0}), kShort, 2, "VEC4");
  b.json["accessors"][output]["normalized"] = true;
  b.json["animations"][0]["samplers"][0]["output"] = output;
  EXPECT_LT(LargestDifference(At(b, 0.5).instances[0].world_from_object, RotationY(90)), kFloatError);
}

TEST_F(LoadAnimation, StepsAndLines) {
  GltfBuilder b;
  const int node = b.Triangle();
  b.Animate(node, "translation", {0, 1, 2}, {0, 0, 0, 5, 0, 0, 7, 0, 0}, "STEP");
  b.Animate(node, "scale", {0, 2}, {1, 1, 1, 3, 5, 7});
  const AnimatedScene animated = Load(b);
  const double expected[][2] = {{0.0, 0.0}, {0.999, 0.0}, {1.0, 5.0}, {1.999, 5.0}, {2.0, 7.0}};
  for (const auto& [seconds, x] : expected) {
    EXPECT_EQ(At(animated, seconds).instances[0].world_from_object[3].x, x) << seconds;
  }
  const glm::dmat4 middle = At(animated, 1.0).instances[0].world_from_object;
  EXPECT_EQ(glm::dvec3(middle[0].x, middle[1].y, middle[2].z), glm::dvec3(2, 3, 4));
}

TEST_F(LoadAnimation, CubicSplines) {
  GltfBuilder b;
  const int node = b.Triangle();
  // In-tangent, value, out-tangent; 2 s between the keys.
  b.Animate(node, "translation", {1, 3}, {9, 9, 9, 1, 0, 0, 4, 1, 0, -2, 0, 3, 5, 2, 0, 9, 9, 9}, "CUBICSPLINE");
  const AnimatedScene animated = Load(b);
  EXPECT_EQ(glm::dvec3(At(animated, 0.0).instances[0].world_from_object[3]), glm::dvec3(1, 0, 0));
  EXPECT_EQ(glm::dvec3(At(animated, 3.0).instances[0].world_from_object[3]), glm::dvec3(5, 2, 0));
  // At a quarter: h00 = 0.84375, h10 = 0.140625, h01 = 0.15625, h11 = -0.046875, tangents times 2 s.
  const glm::dvec3 quarter(At(animated, 1.5).instances[0].world_from_object[3]);
  EXPECT_NEAR(quarter.x, 0.84375 * 1 + 0.28125 * 4 + 0.15625 * 5 - 0.09375 * -2, 1e-12);
  EXPECT_NEAR(quarter.y, 0.28125 * 1 + 0.15625 * 2, 1e-12);
  EXPECT_NEAR(quarter.z, -0.09375 * 3, 1e-12);
}

TEST_F(LoadAnimation, SplinedRotationsStayUnit) {
  GltfBuilder b;
  const int node = b.Triangle();
  b.Animate(node, "rotation", {0, 1}, {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0},
            "CUBICSPLINE");
  const glm::dmat4 world = At(b, 0.5).instances[0].world_from_object;
  EXPECT_LT(LargestDifference(world, RotationY(90)), 1e-12);  // (0, ½, 0, ½) before it is made unit
}

TEST_F(LoadAnimation, ChildrenCamerasAndLightsFollow) {
  GltfBuilder b;
  b.Append("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}});
  b.json["extensions"] = {{"KHR_lights_punctual", {{"lights", {{{"type", "point"}, {"intensity", 683}}}}}}};
  const int mesh = b.Mesh({{{"attributes", {{"POSITION", b.Floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3)}}}}});
  const int child = b.Append("nodes", {{"name", "Child"}, {"mesh", mesh}, {"camera", 0}, {"translation", {0, 0, 1}}});
  const int lamp = b.Append(
      "nodes", {{"name", "Lamp"}, {"scale", {3, 3, 3}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  const int parent = b.Root({{"name", "Parent"}, {"children", {child, lamp}}});
  b.Root({{"name", "Still"}, {"mesh", mesh}});
  b.Animate(parent, "translation", {0, 1}, {0, 0, 0, 10, 0, 0});
  const AnimatedScene animated = Load(b);
  Scene scene = At(animated, 0.0);
  scene.lights.push_back({.name = "added"});
  ASSERT_TRUE(animated.MoveTo(0.5, scene).ok());
  EXPECT_EQ(glm::dvec3(scene.instances[0].world_from_object[3]), glm::dvec3(5, 0, 1));
  EXPECT_EQ(glm::dvec3(scene.instances[1].world_from_object[3]), glm::dvec3(0, 0, 0));
  EXPECT_EQ(glm::dvec3(scene.cameras[0].world_from_camera[3]), glm::dvec3(5, 0, 1));
  EXPECT_EQ(glm::dvec3(scene.lights[0].world_from_light[3]), glm::dvec3(5, 0, 0));
  EXPECT_EQ(scene.lights[0].world_from_light[0].x, 1.0);
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_EQ(scene.lights[1].name, "added");
}

TEST_F(LoadAnimation, WhatIsScaledToNothingIsGoneForThatTime) {
  GltfBuilder b;
  const int node = b.Triangle();
  b.Triangle("Other");
  b.json["nodes"][node]["scale"] = {0, 0, 0};
  b.Animate(node, "scale", {0, 1}, {0, 0, 0, 1, 1, 1}, "STEP");
  const AnimatedScene animated = Load(b);
  Scene scene = At(animated, 0.0);
  EXPECT_EQ(scene.instances.size(), 1u);
  ASSERT_TRUE(animated.MoveTo(1.0, scene).ok());
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.instances[0].object, "Tri");
  EXPECT_THAT(scene.warnings, ::testing::IsEmpty());
}

TEST_F(LoadAnimation, ABarBentByARightAngle) {
  Bar bar;
  bar.b.Animate(bar.tip, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, kHalf, kHalf});  // 90° about +Z: +X becomes +Y
  bar.b.Animate(bar.root, "translation", {0, 1}, {0, 0, 0, 0, 0, 4});
  const AnimatedScene animated = Load(bar.b);
  const glm::dvec3 rest[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}, {1, 2, 0}};
  // The tip's rows turn about (0, 1, 0); the middle row is half turned, half not.
  const glm::dvec3 bent[] = {{0, 0, 4}, {1, 0, 4}, {0, 1, 4}, {.5, 1.5, 4}, {-1, 1, 4}, {-1, 2, 4}};
  const Scene before = At(animated, 0.0), after = At(animated, 1.0);
  for (std::size_t v = 0; v < 6; ++v) {
    EXPECT_LT(glm::distance(WorldPosition(before, 0, v), rest[v]), kFloatError) << v;
    EXPECT_LT(glm::distance(WorldPosition(after, 0, v), bent[v]), kFloatError) << v;
    EXPECT_EQ(glm::dvec3(after.meshes[0].rest_positions[v]), rest[v]);
    EXPECT_LT(glm::distance(after.meshes[0].normals[v], glm::vec3(0, 0, 1)), kFloatError);
  }
}

TEST_F(LoadAnimation, ASkinWithoutAnimationIsPosedToo) {
  Bar bar;
  bar.b.json["nodes"][bar.tip]["rotation"] = {0, 0, kHalf, kHalf};
  const Expected<Scene> scene = LoadScene(Write("scene.glb", bar.b.Glb()));
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_LT(glm::distance(WorldPosition(*scene, 0, 5), glm::dvec3(-1, 2, 0)), kFloatError);
  EXPECT_THAT(scene->warnings, ::testing::IsEmpty());
}

TEST_F(LoadAnimation, NormalsGoByTheInverseTranspose) {
  Bar bar;
  bar.b.json["nodes"][bar.root]["scale"] = {1, 2, 1};
  bar.b.json["nodes"][bar.tip]["scale"] = {1, 1, -3};  // mirrored: only the upper rows, so the frame is not
  const int slanted = bar.b.Floats({0, 0.6f, 0.8f, 0, 0.6f, 0.8f, 0, 0, 1, 0, 0, 1, 0, 0.6f, 0.8f, 0, 0.6f, 0.8f}, 3);
  bar.b.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = slanted;
  const Scene scene = At(bar.b, 0.0);
  const auto& normals = scene.meshes[0].normals;
  EXPECT_LT(glm::distance(glm::dvec3(normals[0]), glm::normalize(glm::dvec3(0, 0.3, 0.8))), kFloatError);
  EXPECT_LT(glm::distance(glm::dvec3(normals[4]), glm::normalize(glm::dvec3(0, 0.3, -0.8 / 3))), kFloatError);
}

TEST_F(LoadAnimation, AMirroredSkeletonKeepsItsFaces) {
  Bar bar;
  bar.b.json["nodes"][bar.root]["scale"] = {-1, 1, 1};
  const Scene scene = At(bar.b, 0.0);
  EXPECT_LT(glm::distance(WorldPosition(scene, 0, 5), glm::dvec3(-1, 2, 0)), kFloatError);
  EXPECT_LT(glm::determinant(glm::dmat3(scene.instances[0].world_from_object)), 0.0);
  EXPECT_LT(glm::distance(scene.meshes[0].normals[0], glm::vec3(0, 0, 1)), kFloatError);
}

TEST_F(LoadAnimation, IntegerWeightsAreMadeToSumToOne) {
  Bar bar;
  std::vector<std::uint8_t> weights(24, 0);
  for (std::size_t i = 0; i < 24; i += 4) {
    weights[i] = 50;  // ¼ and ¾ once divided by their sum
    weights[i + 1] = 150;
  }
  const int accessor = bar.b.Accessor(bar.b.View(weights), kUbyte, 6, "VEC4");
  bar.b.json["accessors"][accessor]["normalized"] = true;
  bar.b.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = accessor;
  bar.b.json["nodes"][bar.tip]["translation"] = {4, 1, 0};
  const Scene scene = At(bar.b, 0.0);
  EXPECT_LT(glm::distance(WorldPosition(scene, 0, 0), glm::dvec3(3, 0, 0)), kFloatError);
}

TEST_F(LoadAnimation, VerticesWithoutWeightsFollowTheirFirstJoint) {
  Bar bar(std::vector<float>(24, 0.0f));
  bar.b.json["nodes"][bar.root]["translation"] = {0, 0, 2};
  const Scene scene = At(bar.b, 0.0);
  EXPECT_LT(glm::distance(WorldPosition(scene, 0, 5), glm::dvec3(1, 2, 2)), kFloatError);
  EXPECT_THAT(scene.warnings, ::testing::ElementsAre(HasSubstr("without a weight")));
}

TEST_F(LoadAnimation, MorphTargets) {
  GltfBuilder b;
  const int node = b.Triangle("Face");
  const int up = b.Floats({0, 0, 2, 0, 0, 2, 0, 0, 2}, 3), right = b.Floats({8, 0, 0, 8, 0, 0, 8, 0, 0}, 3);
  b.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", up}}, {{"POSITION", right}}};
  b.json["meshes"][0]["weights"] = {1, 0.25};
  const Expected<Scene> rest = LoadScene(Write("rest.glb", b.Glb()));
  ASSERT_TRUE(rest.ok()) << rest.error().message;
  EXPECT_EQ(rest->meshes[0].positions[1], glm::vec3(3, 0, 2));  // the mesh's own weights
  b.json["nodes"][node]["weights"] = {0.5, 0};
  EXPECT_EQ(At(b, 0.0).meshes[0].positions[1], glm::vec3(1, 0, 1));  // the node's win
  b.Animate(node, "weights", {0, 1}, {0, 0, 1, 1});
  const AnimatedScene animated = Load(b);
  EXPECT_EQ(At(animated, 0.0).meshes[0].positions[1], glm::vec3(1, 0, 0));
  const Scene half = At(animated, 0.5);
  EXPECT_EQ(half.meshes[0].positions[1], glm::vec3(5, 0, 1));
  EXPECT_EQ(half.meshes[0].rest_positions[1], glm::vec3(1, 0, 0));
}

TEST_F(LoadAnimation, MorphedShapesGetTheirOwnNormals) {
  GltfBuilder b;
  const int node = b.Triangle("Face");
  json& primitive = b.json["meshes"][0]["primitives"][0];
  // (1, 0, 0) rises to z = 1: the triangle's normal becomes (−1, 0, 1)/√2.
  primitive["targets"] = {{{"POSITION", b.Floats({0, 0, 0, 0, 0, 1, 0, 0, 0}, 3)}}};
  b.json["nodes"][node]["weights"] = {1};
  EXPECT_LT(glm::distance(At(b, 0).meshes[0].normals[0], glm::vec3(-kHalf, 0, kHalf)), kFloatError);
  // Normals of the file's own stay unless the target moves them.
  b.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = b.Floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  EXPECT_EQ(At(b, 0).meshes[0].normals[0], glm::vec3(0, 0, 1));
  b.json["meshes"][0]["primitives"][0]["targets"][0]["NORMAL"] = b.Floats({1, 0, 0, 0, 0, 0, 0, 0, 0}, 3);
  EXPECT_LT(glm::distance(At(b, 0).meshes[0].normals[0], glm::vec3(kHalf, 0, kHalf)), kFloatError);
}

TEST_F(LoadAnimation, TheTimeAloneDecides) {
  Bar bar;
  bar.b.Animate(bar.tip, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, kHalf, kHalf});
  bar.b.Animate(bar.root, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  const AnimatedScene animated = Load(bar.b);
  Scene scene = At(animated, 0.9);
  for (const double seconds : {0.3, 1.0, 0.0, 0.3}) {
    ASSERT_TRUE(animated.MoveTo(seconds, scene).ok());
    const Scene fresh = At(animated, seconds);
    EXPECT_EQ(scene.meshes[0].positions, fresh.meshes[0].positions);
    EXPECT_EQ(scene.meshes[0].normals, fresh.meshes[0].normals);
    EXPECT_EQ(scene.instances[0].world_from_object, fresh.instances[0].world_from_object);
  }
  EXPECT_FALSE(animated.MoveTo(std::nan(""), scene).ok());
}

TEST_F(LoadAnimation, StillScenesAreWhatLoadSceneMakes) {
  for (const char* name : {"snail.glb", "stilllife.glb", "suzanne.glb"}) {
    const std::filesystem::path path = std::string(SCUMBLE_SOURCE_DIR) + "/scenes/" + name;
    const Expected<Scene> plain = LoadScene(path);
    const Expected<AnimatedScene> animated = AnimatedScene::Load(path);
    ASSERT_TRUE(plain.ok() && animated.ok());
    EXPECT_FALSE(animated->moves());
    const Scene scene = At(*animated, 3.0);
    ASSERT_EQ(scene.meshes.size(), plain->meshes.size());
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
      EXPECT_EQ(scene.meshes[i].positions, plain->meshes[i].positions);
      EXPECT_TRUE(scene.meshes[i].rest_positions.empty());
    }
    EXPECT_EQ(scene.instances.size(), plain->instances.size());
    EXPECT_EQ(scene.warnings, plain->warnings);
  }
  const auto obj = AnimatedScene::Load(Write("a.obj", std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")));
  ASSERT_TRUE(obj.ok());
  EXPECT_FALSE(obj->moves());
  EXPECT_EQ(obj->duration_seconds(), 0.0);
  EXPECT_EQ(At(*obj, 1.0).instances.size(), 1u);
}

TEST_F(LoadAnimation, AnimationsByName) {
  GltfBuilder b;
  const int node = b.Triangle(), other = b.Triangle("Other");
  b.Animate(node, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  b.json["animations"][0]["name"] = "Walk";
  json run = {{"samplers", b.json["animations"][0]["samplers"]}, {"channels", b.json["animations"][0]["channels"]}};
  run["channels"][0]["target"]["node"] = other;
  b.Append("animations", run);
  const AnimatedScene first = Load(b);
  EXPECT_THAT(first.animations(), ::testing::ElementsAre("Walk", "animation_1"));
  EXPECT_THAT(At(first, 0).warnings, ::testing::ElementsAre(HasSubstr("only the first of the 2 animations")));
  const auto x = [](const Scene& scene, std::size_t i) { return scene.instances[i].world_from_object[3].x; };
  EXPECT_EQ(x(At(first, 1), 0), 1.0);
  EXPECT_EQ(x(At(first, 1), 1), 0.0);
  const Scene second = At(Load(b, "animation_1"), 1);
  EXPECT_EQ(x(second, 0), 0.0);
  EXPECT_EQ(x(second, 1), 1.0);
  const Scene both = At(Load(b, "*"), 1);
  EXPECT_EQ(x(both, 0) + x(both, 1), 2.0);
  EXPECT_THAT(ErrorOf(b, ErrorKind::kUsage, "Fly"), HasSubstr("\"Walk\", \"animation_1\""));
  b.json["animations"][1]["name"] = "Walk";
  EXPECT_THAT(Load(b).animations(), ::testing::ElementsAre("Walk", "Walk#2"));
  EXPECT_EQ(x(At(Load(b, "Walk#2"), 1), 1), 1.0);
}

// The layer that paint sticks to keeps the undeformed place of each vertex, whatever bends it.
TEST_F(LoadAnimation, PrefIsTheRestPosition) {
  Bar bar;
  bar.b.Animate(bar.tip, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, kHalf, kHalf});
  const Scene scene = At(bar.b, 1.0);
  Camera camera;
  camera.orthographic = true;
  camera.ymag = 2.0;
  camera.world_from_camera[3] = glm::dvec4(0, 1, 5, 1);
  GuidegenOptions options;
  options.width = options.height = 80;
  options.layers = {Layer::kPref, Layer::kPosition};
  const Expected<GuidegenResult> result = RenderGuides(scene, camera, options);
  ASSERT_TRUE(result.ok()) << result.error().message;
  // Inside the upper half that was bent to the left: the world's (−0.775, 1.325) is the corner (0, 1), (1, 1), (0, 2),
  // (1, 2) of the rest shape, whose triangle (0, 2), (1, 1), (1, 2) holds it.
  const int column = 24, row = 33;
  const std::size_t at = std::size_t(row) * 80 + column;
  const GuideSet& guides = result->guides;
  const glm::dvec2 seen(guides.Plane(Layer::kPosition, 0)[at], guides.Plane(Layer::kPosition, 1)[at]);
  EXPECT_NEAR(seen.x, -0.775, 1e-5);
  EXPECT_NEAR(seen.y, 1.325, 1e-5);
  // Barycentric of (0, 2) → (−1, 1), (1, 1) → (.5, 1.5), (1, 2) → (−1, 2).
  const double b1 = (seen.x + 1.0) / 1.5, b2 = seen.y - 1.0 - 0.5 * b1;
  EXPECT_NEAR(guides.Plane(Layer::kPref, 0)[at], b1 + b2, 1e-5);
  EXPECT_NEAR(guides.Plane(Layer::kPref, 1)[at], 2.0 - b1, 1e-5);
  EXPECT_NEAR(guides.Plane(Layer::kPref, 2)[at], 0.0, 1e-6);
}

// A square that slides and a camera that does not: the pixels are known.
TEST_F(LoadAnimation, MotionIsInPixelsToTheNextFrame) {
  Bar bar;
  bar.b.Animate(bar.root, "translation", {0, 1}, {0, 0, 0, 0.5, 0.25, 0});
  bar.b.Triangle("Still");
  const AnimatedScene animated = Load(bar.b);
  const Scene now = At(animated, 0.0), next = At(animated, 1.0);
  Camera camera;
  camera.orthographic = true;
  camera.ymag = 2.0;
  camera.world_from_camera[3] = glm::dvec4(0, 1, 5, 1);
  GuidegenOptions options;
  options.width = options.height = 80;  // 20 pixels a metre
  options.layers = {Layer::kMotion};
  EXPECT_EQ(RenderGuides(now, camera, options).error().kind, ErrorKind::kUnavailable);
  const auto motion_at = [&](const Camera& now_camera, const Camera& next_camera, int column, int row) {
    const Expected<GuidegenResult> result = RenderGuides(now, now_camera, {next, next_camera}, options);
    if (!result) throw std::runtime_error(result.error().message);
    const std::size_t at = std::size_t(row) * 80 + std::size_t(column);
    return glm::dvec2(result->guides.Plane(Layer::kMotion, 0)[at], result->guides.Plane(Layer::kMotion, 1)[at]);
  };
  EXPECT_LT(glm::distance(motion_at(camera, camera, 50, 25), glm::dvec2(10, -5)), 1e-5);
  EXPECT_EQ(motion_at(camera, camera, 5, 10), glm::dvec2(0));  // background
  const auto still = RenderGuides(now, camera, {now, camera}, options);
  ASSERT_TRUE(still.ok());
  for (int c = 0; c < 2; ++c) {
    for (const float value : still->guides.Plane(Layer::kMotion, c)) ASSERT_EQ(value, 0.0f);
  }
  // A perspective camera that steps back from z = 5 to z = 10 halves every distance from the picture's centre.
  camera.orthographic = false;
  camera.yfov_degrees = 2.0 * glm::degrees(std::atan(0.4));  // 4 m high at 5 m
  Camera back = camera;
  back.world_from_camera[3].z = 10.0;
  const auto result = RenderGuides(now, camera, {now, back}, options);
  ASSERT_TRUE(result.ok());
  const std::size_t at = 25 * 80 + 50;  // its centre is 10.5 pixels right of the middle and 14.5 above it
  EXPECT_NEAR(result->guides.Plane(Layer::kMotion, 0)[at], -5.25, 1e-5);
  EXPECT_NEAR(result->guides.Plane(Layer::kMotion, 1)[at], 7.25, 1e-5);
}

}  // namespace
}  // namespace scumble
