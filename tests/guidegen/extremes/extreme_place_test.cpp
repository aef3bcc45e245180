// Scenes far from the origin in files: the precision that a loader keeps in double, and the precision that the file
// itself has lost. And normals without a length in files.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "guidegen/load_scene.h"
#include "tests/support/animation_fixtures.h"
#include "tests/support/exact_rays.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/guidegen_checks.h"
#include "tests/support/guidegen_scenes.h"
#include "tests/support/numbers.h"

namespace scumble::testing {
namespace {

class ExtremePlace : public LoaderTest {
 protected:
  // A quad under two nodes whose places add up to `place`, turned, and a camera that stands 3 m before it. Where it is
  // lit, a light beside the camera, and between them a lid that throws its shadow on the quad.
  Expected<Scene> SceneAt(const glm::dvec3& place, const std::vector<float>& corners, bool lit = false) {
    GltfBuilder gltf;
    const int position = gltf.Floats(corners, 3);
    const int index = gltf.Indices({0, 1, 2, 0, 2, 3});
    const int mesh = gltf.Mesh({{{"attributes", {{"POSITION", position}}}, {"indices", index}}});
    const int lens =
        gltf.Append("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.0}}}});
    const int thing = gltf.Append("nodes", {{"name", "thing"},
                                            {"mesh", mesh},
                                            {"translation", {0.0625, -0.125, 0.25}},
                                            {"rotation", {0.0, 0.28, 0.0, 0.96}}});
    const int camera = gltf.Append("nodes", {{"name", "eye"}, {"camera", lens}, {"translation", {0.0, 0.0, 3.0}}});
    std::vector<int> children = {thing, camera};
    if (lit) {
      gltf.json["extensionsUsed"] = {"KHR_lights_punctual"};
      gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 683.0}}};
      children.push_back(gltf.Append("nodes", {{"name", "lamp"},
                                               {"translation", {0.75, 0.5, 2.5}},
                                               {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}));
      children.push_back(gltf.Append(
          "nodes",
          {{"name", "lid"}, {"mesh", mesh}, {"translation", {0.375, 0.25, 1.25}}, {"scale", {0.25, 0.25, 0.25}}}));
    }
    gltf.Root({{"name", "far"}, {"children", children}, {"translation", {place.x, place.y, place.z}}});
    return LoadScene(Write("far.glb", gltf.Glb()));
  }

  const std::vector<float> kQuad = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
};

// A float at 1e7 m steps by 1 m, a double by 2e-9 m. The file's node translations are doubles, and they are kept and
// subtracted as such: these places have few enough bits that nothing is rounded at all, so the guides have the same
// bits but for the positions, which are floats in the world's own frame and can be no better than half a metre. The
// same goes for light: a light's place is a node's, its distance from the eye is a difference of doubles without a
// rounding, and from there on all is relative to the eye; chance is hashed by pixel.
TEST_F(ExtremePlace, NodesTenThousandKilometresAwayLoseNothing) {
  const auto here = SceneAt({0, 0, 0}, kQuad, true);
  ASSERT_TRUE(here) << here.error().message;
  GuidegenOptions options = Sized(
      40, 40, {Layer::kPosition, Layer::kPref, Layer::kLuminance, Layer::kShadow, Layer::kLpeLDE, Layer::kLpeFull});
  options.samples = 4;
  auto near_by = Render(*here, here->cameras[0], options);
  for (const Layer light : {Layer::kLuminance, Layer::kLpeLDE, Layer::kLpeFull}) {
    const auto plane = near_by.guides.Plane(light);
    EXPECT_GT(std::count_if(plane.begin(), plane.end(), [](float value) { return value > 0.0f; }), 100);
  }
  const auto shadow = near_by.guides.Plane(Layer::kShadow);
  EXPECT_GT(std::count(shadow.begin(), shadow.end(), 1.0f), 30);  // 0.8 m² behind the lid, partly hidden by it
  for (const glm::dvec3 place : {glm::dvec3(1e7, -1e7, 1e7), glm::dvec3(1e7 + 0.125, 3.5, -2e7 - 0.75)}) {
    const auto there = SceneAt(place, kQuad, true);
    ASSERT_TRUE(there) << there.error().message;
    auto far_away = Render(*there, there->cameras[0], options);
    int covered = 0;
    for (std::size_t i = 0; i < 1600; ++i) {
      if (near_by.guides.Plane(Layer::kCoverage)[i] == 0.0f) continue;
      ++covered;
      for (int axis = 0; axis < 3; ++axis) {
        const double truth = double(near_by.guides.Plane(Layer::kPosition, axis)[i]) + place[axis];
        // Both were rounded to floats; and double's own arithmetic at the place.
        const double near_float = near_by.guides.Plane(Layer::kPosition, axis)[i];
        const double tolerance = (std::abs(place[axis]) + 2.0 * std::abs(near_float)) * 0x1p-24 + std::ldexp(2e7, -50);
        ASSERT_NEAR(far_away.guides.Plane(Layer::kPosition, axis)[i], truth, tolerance);
      }
    }
    EXPECT_GT(covered, 500);
    for (auto* result : {&near_by, &far_away}) {
      for (int axis = 0; axis < 3; ++axis) {
        auto plane = result->guides.Plane(Layer::kPosition, axis);
        std::fill(plane.begin(), plane.end(), 0.0f);
      }
    }
    EXPECT_TRUE(SameBytes(near_by.guides, far_away.guides));
    near_by = Render(*here, here->cameras[0], options);
  }
}

// The same quad with the distance in its vertices: glTF has only floats for those, so the file itself holds whole
// metres and the quad has become another shape. That shape is shown exactly.
TEST_F(ExtremePlace, VerticesTenThousandKilometresAwayAreTheFilesWholeMetres) {
  std::vector<float> corners = kQuad;
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = 1.4f * corners[i] + (i % 3 == 2 ? 0.0f : 1e7f);
  const auto scene = SceneAt({0, 0, 0}, corners);
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->meshes[0].positions[1], glm::vec3(10000001.0f, 9999999.0f, 0.0f));  // 1.4 m aside became 1 m
  const glm::dvec3 middle(scene->instances[0].world_from_object * glm::dvec4(1e7, 1e7, 0.0, 1.0));
  const Camera camera = LookingAt(middle + glm::dvec3(1, 2, 4), middle);
  const ExactCount count = ExpectExactGuides(*scene, camera, 40, 40);
  EXPECT_GT(count.covered, 100);
  // From here nothing is far: float's sight is 1e-6 of 6 m, beside pixels of 0.1 m.
  EXPECT_EQ(count.undecided, 0);
}

// A surveyor's scan: a file may hold doubles, and a wall 2 m wide at 5e6 m is then as good as one at 0. A float would
// have moved its corners by up to a quarter of a metre. Near 0 nothing changes: the object stands at 0.
TEST_F(ExtremePlace, ScansInDoublesFarFromTheOriginKeepTheirDigits) {
  const auto scan_at = [&](double x, double y, const std::string& type) {
    std::string text = "ply\nformat ascii 1.0\nelement vertex 4\n";
    for (const char* axis : {"x", "y", "z"}) text += "property " + type + " " + axis + "\n";
    text += "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    for (const glm::dvec2 corner : {glm::dvec2(-0.95, -1.05), {1.05, -1.05}, {1.05, 0.95}, {-0.95, 0.95}}) {
      text += std::to_string(x + corner.x) + " " + std::to_string(y + corner.y) + " 0.25\n";
    }
    return LoadScene(Write("scan.ply", text + "4 0 1 2 3\n"));
  };
  const auto far = scan_at(5e6, -3e6, "double");
  ASSERT_TRUE(far) << far.error().message;
  EXPECT_EQ(glm::dvec3(far->instances[0].world_from_object[3]), glm::dvec3(5e6, -3e6, 0.0));
  EXPECT_EQ(far->meshes[0].positions[2], glm::vec3(1.05f, 0.95f, 0.25f));
  EXPECT_GT(ExpectExactGuides(*far, LookingAt({5e6 + 1, -3e6, 4}, {5e6, -3e6, 0}), 30, 30).covered, 300);
  const auto floats = scan_at(5e6, -3e6, "float");
  ASSERT_TRUE(floats);
  EXPECT_EQ(floats->instances[0].world_from_object, glm::dmat4(1.0));
  EXPECT_EQ(floats->meshes[0].positions[2], glm::vec3(5000001.0f, -2999999.0f, 0.25f));
  const auto near_by = scan_at(3.0, 2.0, "double");
  ASSERT_TRUE(near_by);
  EXPECT_EQ(near_by->instances[0].world_from_object, glm::dmat4(1.0));
  EXPECT_EQ(near_by->meshes[0].positions[2], glm::vec3(4.05f, 2.95f, 0.25f));
}

// The same in OBJ's text, whose digits are as many as are written.
TEST_F(ExtremePlace, ObjFilesFarFromTheOriginKeepTheirDigits) {
  const auto wall_at = [&](double x, double y) {
    std::string text = "o wall\n";
    for (const glm::dvec2 corner : {glm::dvec2(-0.95, -1.05), {1.05, -1.05}, {1.05, 0.95}, {-0.95, 0.95}}) {
      text += "v " + std::to_string(x + corner.x) + " " + std::to_string(y + corner.y) + " 0.25\n";
    }
    return LoadScene(Write("wall.obj", text + "f 1 2 3 4\n"));
  };
  const auto far = wall_at(1e7, -3e6);
  ASSERT_TRUE(far) << far.error().message;
  EXPECT_EQ(glm::dvec3(far->instances[0].world_from_object[3]), glm::dvec3(1e7, -3e6, 0.0));
  EXPECT_EQ(far->meshes[0].positions[2], glm::vec3(1.05f, 0.95f, 0.25f));
  EXPECT_EQ(far->meshes[0].normals[2], glm::vec3(0, 0, 1));
  EXPECT_GT(ExpectExactGuides(*far, LookingAt({1e7 + 1, -3e6, 4}, {1e7, -3e6, 0}), 30, 30).covered, 300);
  const auto near_by = wall_at(3.0, 2.0);
  ASSERT_TRUE(near_by);
  EXPECT_EQ(near_by->instances[0].world_from_object, glm::dmat4(1.0));
  EXPECT_EQ(near_by->meshes[0].positions[2], glm::vec3(4.05f, 2.95f, 0.25f));
}

// A skin and an animation under a node that far away: joints are placed in double and the skinned shape is stored
// relative to its first joint, so its floats are as good as at 0. Every number here has few bits and keys are halved at
// most, so nothing is rounded, and guides and motion have the same bits.
TEST_F(LoadAnimation, SkinsAndAnimationsTenThousandKilometresAwayLoseNothing) {
  const auto animation_at = [&](double x) {
    Bar bar;
    bar.b.Animate(bar.tip, "translation", {0, 1}, {0, 1, 0, 0.5, 1, 0.25});
    bar.b.Animate(bar.root, "translation", {0, 1}, {0, 0, 0, 0.25, 0.125, 0});
    const int far = bar.b.Append("nodes", {{"children", {bar.root}}, {"translation", {x, 0.0, -x}}});
    bar.b.json["scenes"][0]["nodes"] = {far, bar.node};
    return Load(bar.b);
  };
  const auto see = [&](const AnimatedScene& film, double x, double seconds) {
    const Camera camera = [&] {
      Camera seen = FlatCamera(0.0, 1.5);
      seen.world_from_camera[3] = glm::dvec4(x + 0.5, 1.0, -x + 4.0, 1.0);
      return seen;
    }();
    const Scene now = At(film, seconds), next = At(film, 1.0);
    return TakeValid(RenderGuides(now, camera, NextFrame{next, camera}, Sized(40, 40, {Layer::kPref, Layer::kMotion})));
  };
  const AnimatedScene here = animation_at(0.0), there = animation_at(1e7);
  for (const double seconds : {0.0, 0.5, 1.0}) {
    const GuidegenResult near_by = see(here, 0.0, seconds);
    EXPECT_TRUE(SameBytes(near_by.guides, see(there, 1e7, seconds).guides)) << seconds;
    const auto coverage = near_by.guides.Plane(Layer::kCoverage);
    EXPECT_GT(std::count(coverage.begin(), coverage.end(), 1.0f), 300);
  }
}

// A loader's own choice: any direction that can be determined is kept, down to the smallest float; the others are
// computed from the triangles, with a warning.
TEST_F(ExtremePlace, LoadersKeepTheDirectionOfTinyNormalsAndReplaceThoseWithoutOne) {
  GltfBuilder gltf;
  const int position = gltf.Floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 0, 6, 5, 0, 5, 6, 0}, 3);
  const int normal = gltf.Floats({0, 1e-30f, 0, 0, 1e-45f, 0, 3e38f, 3e38f, 0,  //
                                  0, 0, 0, kNan, 0, 1, kInfinity, 0, 0},
                                 3);
  const int index = gltf.Indices({0, 1, 2, 3, 4, 5});
  const int mesh = gltf.Mesh({{{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}, {"indices", index}}});
  gltf.Root({{"name", "Tri"}, {"mesh", mesh}});
  const auto scene = LoadScene(Write("normals.glb", gltf.Glb()));
  ASSERT_TRUE(scene) << scene.error().message;
  const std::vector<glm::vec3>& normals = scene->meshes[0].normals;
  ASSERT_EQ(normals.size(), 6u);
  EXPECT_EQ(normals[0], glm::vec3(0, 1, 0));
  EXPECT_EQ(normals[1], glm::vec3(0, 1, 0));
  EXPECT_NEAR(normals[2].x, std::sqrt(0.5), 0x1p-24);
  for (std::size_t i = 3; i < 6; ++i) EXPECT_EQ(normals[i], glm::vec3(0, 0, 1));
  ASSERT_FALSE(scene->warnings.empty());
  EXPECT_NE(scene->warnings[0].find("normals without a direction"), std::string::npos);
}

}  // namespace
}  // namespace scumble::testing
