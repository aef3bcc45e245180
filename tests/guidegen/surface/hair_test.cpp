// Hair against formulas, and its form in glTF.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "guidegen/surface/curve.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/light_path_scenes.h"

namespace scumble::testing {
namespace {

using ::testing::HasSubstr;

// One curve through these points, each of this radius.
Mesh CurveMesh(std::vector<glm::vec3> points, float radius, bool ribbons) {
  points.insert(points.begin(), points.front());
  points.push_back(points.back());
  Mesh mesh;
  mesh.curves.radii.assign(points.size(), radius);
  for (std::uint32_t i = 0; i + 3 < points.size(); ++i) mesh.curves.segments.push_back(i);
  mesh.curves.ribbons = ribbons;
  mesh.positions = std::move(points);
  return mesh;
}

constexpr float kRadius = 0.3f;

// Along Y, from 1 m below the middle to 1 m above it.
Mesh StraightHair(bool ribbons) { return CurveMesh({{0, -1, 0}, {0, 0, 0}, {0, 1, 0}}, kRadius, ribbons); }

// In the plane z = 0, radius 1. Catmull-Rom segments of 10° stray from a circle by less than 1e-5 of it.
Mesh RingOfHair() {
  std::vector<glm::vec3> points;
  for (int i = 0; i <= 36; ++i) {
    const double angle = glm::radians(10.0 * i);
    points.emplace_back(std::cos(angle), std::sin(angle), 0.0);
  }
  return CurveMesh(points, kRadius, false);
}

class StraightHairs : public ::testing::TestWithParam<bool> {};

TEST_P(StraightHairs, HaveTheNormalsOfARod) {
  const int side = 61;
  const Camera camera = FlatCamera(5.0, 0.7);
  const auto result = Render(SceneOf(StraightHair(GetParam())), camera, Sized(side, side, {Layer::kPosition}));
  const GuideSet& guides = result.guides;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const std::size_t i = guides.Index(x, y);
      const double across = ((x + 0.5) / side * 2.0 - 1.0) * 0.7 / kRadius;
      if (std::abs(std::abs(across) - 1.0) < 1e-3) continue;
      ASSERT_EQ(guides.Plane(Layer::kCoverage)[i] > 0.0f, std::abs(across) < 1.0) << x << " " << y;
      if (std::abs(across) > 1.0) continue;
      const double height = std::sqrt(1.0 - across * across);
      const glm::dvec3 normal = guides.Vec3(Layer::kNormal, i);
      EXPECT_NEAR(normal.x, across, 1e-5);
      EXPECT_NEAR(normal.y, 0.0, 1e-5);
      EXPECT_NEAR(normal.z, height, 1e-4);
      EXPECT_NEAR(guides.Vec3(Layer::kPosition, i).z, GetParam() ? 0.0 : kRadius * height, 1e-5);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, StraightHairs, ::testing::Bool(),
                         [](const auto& test) { return test.param ? "Ribbons" : "Round"; });

TEST(Hair, ARingOfItIsATorus) {
  const int side = 80;
  const glm::dmat4 tilted = glm::rotate(glm::dmat4(1.0), 0.7, glm::normalize(glm::dvec3(1.0, 0.4, 0.2)));
  const glm::dmat3 back = glm::transpose(glm::dmat3(tilted));
  const auto result = Render(SceneOf(RingOfHair(), tilted), FrontCamera(5.0), Sized(side, side, {Layer::kPosition}));
  const GuideSet& guides = result.guides;
  int seen = 0;
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    if (guides.Plane(Layer::kCoverage)[i] < 1.0f) continue;
    const glm::dvec3 place = back * guides.Vec3(Layer::kPosition, i), normal = back * guides.Vec3(Layer::kNormal, i);
    if (std::abs(std::atan2(place.y, place.x)) < 0.45) continue;  // its ends meet there, which are not bent
    ++seen;
    const glm::dvec3 middle = glm::normalize(glm::dvec3(place.x, place.y, 0.0));
    EXPECT_NEAR(glm::length(place - middle), kRadius, 1e-4);
    EXPECT_LT(glm::length(normal - glm::normalize(place - middle)), 1e-3);
  }
  EXPECT_GT(seen, 500);
}

TEST(Hair, ScalesWithItsObject) {
  const glm::dmat4 scaled = glm::scale(glm::dmat4(1.0), glm::dvec3(0.5));
  for (const bool ribbons : {true, false}) {
    const auto result = Render(SceneOf(StraightHair(ribbons), scaled), FlatCamera(5.0, 0.7), Sized(63, 63));
    double covered = 0.0;
    for (int x = 0; x < 63; ++x) covered += result.guides.Plane(Layer::kCoverage)[result.guides.Index(x, 31)];
    EXPECT_NEAR(covered / 63 * 1.4, 2.0 * 0.5 * kRadius, 0.025);
  }
}

TEST_P(StraightHairs, AreLitAsARodAndShadeWhatIsBehindThem) {
  Scene scene = SceneOf(StraightHair(GetParam()));
  scene.materials[0] = Painted(Bsdf::kDiffuse, 0.5f);
  AddObject(scene, "wall", QuadMesh(), glm::scale(Moved(0, 0, -1), glm::dvec3(10.0)));
  Light sun = PointLight({0, 0, 1000}, 1e6);
  scene.lights.push_back(sun);
  const int side = 61;
  const auto result = Render(scene, FlatCamera(5.0, 0.7), Paths(side, {Layer::kLpeLDE}));
  const GuideSet& guides = result.guides;
  for (int x = 0; x < side; ++x) {
    const std::size_t i = guides.Index(x, side / 2);
    const double across = ((x + 0.5) / side * 2.0 - 1.0) * 0.7 / kRadius;
    if (std::abs(std::abs(across) - 1.0) < 0.05) continue;
    const double expected =
        std::abs(across) < 1.0 ? 0.5 / glm::pi<double>() * std::sqrt(1.0 - across * across) : 0.5 / glm::pi<double>();
    EXPECT_NEAR(guides.Plane(Layer::kLpeLDE, 1)[i], expected, 0.005 * expected + 1e-4) << x;
  }
}

TEST_P(StraightHairs, CastAShadow) {
  Scene scene = SceneOf(StraightHair(GetParam()));
  scene.materials[0] = Painted(Bsdf::kDiffuse, 0.5f);
  AddObject(scene, "wall", QuadMesh(), glm::scale(Moved(0, 0, -1), glm::dvec3(10.0)));
  scene.lights.push_back(PointLight({1000, 0, 1000}, 1e6));
  const auto result = Render(scene, FlatCamera(5.0, 2.0), Paths(101, {Layer::kLpeLDE}));
  const GuideSet& guides = result.guides;
  // The hair's shadow falls 1 m to the left; a hair turned to this light is as wide as it is to the camera.
  const double lit = guides.Plane(Layer::kLpeLDE, 1)[guides.Index(90, 50)];
  EXPECT_GT(lit, 0.0);
  EXPECT_EQ(guides.Plane(Layer::kLpeLDE, 1)[guides.Index(25, 50)], 0.0f);
  EXPECT_NEAR(guides.Plane(Layer::kLpeLDE, 1)[guides.Index(5, 50)], lit, 0.02 * lit);
}

TEST_P(StraightHairs, MoveAsTheirObjectDoes) {
  Scene now = SceneOf(StraightHair(GetParam())), next = SceneOf(StraightHair(GetParam()), Moved(0.1, 0.05, 0));
  const Camera camera = FlatCamera(5.0, 0.7);
  const auto result =
      TakeValid(RenderGuides(now, camera, NextFrame{next, camera}, Sized(56, 56, {Layer::kPref, Layer::kMotion})));
  const GuideSet& guides = result.guides;
  const std::size_t middle = guides.Index(28, 28);
  ASSERT_GT(guides.Plane(Layer::kCoverage)[middle], 0.0f);
  EXPECT_NEAR(guides.Plane(Layer::kMotion, 0)[middle], 0.1 / 1.4 * 56, 1e-3);
  EXPECT_NEAR(std::abs(guides.Plane(Layer::kMotion, 1)[middle]), 0.05 / 1.4 * 56, 1e-3);
  EXPECT_NEAR(guides.Vec3(Layer::kPref, middle).x, 0.0, 1e-6) << "the place on the hair's middle line";
}

// --- glTF -----------------------------------------------------------------------------------------------------------

class LoadHair : public RefusedScenes {
 protected:
  // Two segments, seen by nobody else's reader but as four points and more.
  GltfBuilder Hair() {
    GltfBuilder b;
    const int position = b.Floats({0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 2, 0, 0, 2, 0}, 3);
    const int radius = b.Floats({0.1f, 0.1f, 0.05f, 0, 0}, 1);
    const int segments = b.Indices({0, 1});
    const int mesh = b.Mesh({{{"mode", 0},
                              {"attributes", {{"POSITION", position}, {"_SCUMBLE_RADIUS", radius}}},
                              {"indices", segments},
                              {"extras", {{"scumble", {{"curves", {{"ribbons", true}, {"pieces", 4}}}}}}}}});
    b.Root({{"name", "Hair"}, {"mesh", mesh}});
    return b;
  }
  static nlohmann::json& Primitive(GltfBuilder& b) { return b.json["meshes"][0]["primitives"][0]; }
};

TEST_F(LoadHair, IsReadAsItIsWritten) {
  const Expected<Scene> scene = LoadScene(Write("hair.glb", Hair().Glb()));
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  ASSERT_EQ(scene->meshes.size(), 1u);
  const Mesh& mesh = scene->meshes[0];
  EXPECT_TRUE(mesh.IsCurves());
  EXPECT_TRUE(mesh.triangles.empty() && mesh.normals.empty());
  EXPECT_EQ(mesh.positions.size(), 5u);
  EXPECT_EQ(mesh.curves.radii, (std::vector<float>{0.1f, 0.1f, 0.05f, 0, 0}));
  EXPECT_EQ(mesh.curves.segments, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_TRUE(mesh.curves.ribbons);
  EXPECT_EQ(mesh.curves.pieces, 4);
  EXPECT_TRUE(scene->warnings.empty());
}

TEST_F(LoadHair, TakesItsColourFromWhereItGrows) {
  GltfBuilder b = Hair();
  Primitive(b)["attributes"]["TEXCOORD_0"] = b.Floats({0.25f, 1, 0.25f, 1, 0.25f, 1, 0.25f, 1, 0.25f, 1}, 2);
  const Expected<Scene> scene = LoadScene(Write("hair.glb", b.Glb()));
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_EQ(scene->meshes[0].uvs[0], std::vector<glm::vec2>(5, glm::vec2(0.25f, 1.0f)));
}

TEST_F(LoadHair, WhatDoesNotFitTogetherIsRefused) {
  GltfBuilder no_radius = Hair();
  Primitive(no_radius)["attributes"].erase("_SCUMBLE_RADIUS");
  EXPECT_THAT(Refusal(no_radius), HasSubstr("radii"));

  GltfBuilder few = Hair();
  Primitive(few)["attributes"]["_SCUMBLE_RADIUS"] = few.Floats({1, 1}, 1);
  EXPECT_THAT(Refusal(few), HasSubstr("2 × 1 numbers; expected 5 × 1"));

  GltfBuilder negative = Hair();
  Primitive(negative)["attributes"]["_SCUMBLE_RADIUS"] = negative.Floats({1, 1, -1, 1, 1}, 1);
  EXPECT_THAT(Refusal(negative), HasSubstr("point 2"));

  GltfBuilder nowhere = Hair();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Primitive(nowhere)["attributes"]["POSITION"] = nowhere.Floats({0, 0, 0, 0, nan, 0, 0, 1, 0, 0, 2, 0, 0, 2, 0}, 3);
  EXPECT_THAT(Refusal(nowhere), HasSubstr("point 1"));

  GltfBuilder outside = Hair();
  Primitive(outside)["indices"] = outside.Indices({0, 2});
  EXPECT_THAT(Refusal(outside), HasSubstr("three more behind it"));

  GltfBuilder pieces = Hair();
  Primitive(pieces)["extras"]["scumble"]["curves"]["pieces"] = 1000;
  EXPECT_THAT(Refusal(pieces), HasSubstr("pieces"));

  GltfBuilder deformed = Hair();
  const int moved = deformed.Floats({0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 2, 0, 0, 2, 0}, 3);
  Primitive(deformed)["targets"] = {{{"POSITION", moved}}};
  deformed.json["meshes"][0]["weights"] = {0.5};
  deformed.Animate(0, "weights", {0, 1}, {0, 1});
  EXPECT_THAT(Refusal(deformed), HasSubstr("deformed"));
}

}  // namespace
}  // namespace scumble::testing
