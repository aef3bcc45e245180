// The layers cosine and uv against their formulas.
#include "guidegen/light/key_lamp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/image/direction.h"
#include "core/image/fragments.h"
#include "tests/support/guidegen_checks.h"
#include "tests/support/guidegen_scenes.h"

namespace scumble::testing {
namespace {

const LayerSet kBoth = {Layer::kCosine, Layer::kUv};

Light SunTowards(const glm::dvec3& to_sun, double irradiance) {
  Light sun;
  sun.name = "sun", sun.type = LightType::kSun, sun.intensity = irradiance;
  sun.world_from_light[2] = glm::dvec4(to_sun, 0.0);
  return sun;
}

// The cosine of each pixel by its own normal, turned back to the world, and its place there.
template <class ToLamp>
void ExpectCosines(const GuideSet& guides, const Camera& camera, const ToLamp& to_lamp) {
  const glm::dmat3 world_from_view(camera.world_from_camera);
  int covered = 0, below = 0;
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    const float cosine = guides.Plane(Layer::kCosine)[i];
    if (!(guides.Plane(Layer::kCoverage)[i] > 0.0f)) {
      EXPECT_EQ(cosine, 0.0f);
      continue;
    }
    ++covered, below += cosine < 0.0f;
    const glm::dvec3 normal = world_from_view * glm::dvec3(guides.Vec3(Layer::kNormal, i));
    const glm::dvec3 to = glm::normalize(to_lamp(glm::dvec3(guides.Vec3(Layer::kPosition, i))));
    ASSERT_NEAR(cosine, glm::dot(normal, to), 2e-6) << i;
  }
  EXPECT_GT(covered, 100);
  EXPECT_GT(below, 10) << "the signed cosine, not the light";
}

TEST(KeyLamp, CosineIsThatToASun) {
  Scene scene = SceneOf(BallMesh(24), glm::scale(Moved(0.3, -0.2, 0.1), glm::dvec3(1.0, 0.7, 1.3)));
  const glm::dvec3 to_sun = glm::normalize(glm::dvec3(1.0, 2.0, -0.5));
  scene.lights = {SunTowards(to_sun * 3.0, 2.0)};
  const Camera camera = LookingAt({3, 2, 5}, {0, 0, 0});
  const GuideSet guides = Render(scene, camera, Sized(64, 48, {Layer::kCosine, Layer::kPosition})).guides;
  ExpectCosines(guides, camera, [&](const glm::dvec3&) { return to_sun; });
}

TEST(KeyLamp, CosineIsThatToAPointLampFromEachPoint) {
  Scene scene = SceneOf(BallMesh(24));
  scene.lights = {PointLight({1.5, 1.0, 0.5}, 7.0)};
  const Camera camera = LookingAt({0, 1, 5}, {0, 0, 0});
  GuidegenOptions options = Sized(64, 48, {Layer::kCosine, Layer::kPosition});
  const GuideSet guides = Render(scene, camera, options).guides;
  ExpectCosines(guides, camera, [](const glm::dvec3& at) { return glm::dvec3(1.5, 1.0, 0.5) - at; });
  // Normals in the eye's frame change nothing of it.
  options.normal_frame = NormalFrame::kEye;
  const GuideSet turned = Render(scene, camera, options).guides;
  EXPECT_TRUE(std::ranges::equal(turned.Plane(Layer::kCosine), guides.Plane(Layer::kCosine)));
}

TEST(KeyLamp, ASphereHasTheFormulasCosines) {
  SphereOptions options;
  options.size = 64, options.layers = kBoth;
  const GuideSet guides = TakeValid(RenderSphereGuides(options)).guides;
  const glm::dvec3 sun = DirectionFromAngles(kKeyLightAzimuth, kKeyLightElevation);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    const glm::dvec3 normal(guides.Vec3(Layer::kNormal, i));
    EXPECT_NEAR(guides.Plane(Layer::kCosine)[i], glm::dot(normal, sun), 1e-5);
    EXPECT_EQ(guides.Plane(Layer::kUv, 0)[i], 0.0f) << "it has no texture coordinates";
    EXPECT_EQ(guides.Plane(Layer::kUv, 1)[i], 0.0f);
  }
}

TEST(KeyLamp, IsTheBrightestAtTheCentre) {
  Scene scene = SceneOf(QuadMesh(), Moved(10, 0, 0));  // the centre is (10, 0, 0)
  const auto at = [&] { return FindKeyLamp(scene).value_or(KeyLamp()).at; };
  scene.lights = {PointLight({10, 0, 4}, 15.9), PointLight({10, 0, -2}, 4.0)};
  EXPECT_EQ(at(), glm::dvec3(10, 0, -2)) << "15.9 / 16 is less than 4 / 4";
  scene.lights[0].intensity = 16.0;
  EXPECT_EQ(at(), glm::dvec3(10, 0, 4)) << "the first of equals";
  scene.lights.push_back(SunTowards({0, 3, 0}, 1.01));
  EXPECT_TRUE(FindKeyLamp(scene)->endless);
  EXPECT_EQ(at(), glm::dvec3(0, 1, 0));
  Light panel;
  panel.type = LightType::kArea, panel.intensity = 1.0, panel.size_x = 2.0, panel.size_y = 3.0;
  panel.world_from_light = Moved(10, 2, 0);  // 6 / 4
  scene.lights.push_back(panel);
  EXPECT_EQ(at(), glm::dvec3(10, 2, 0));
  scene.lights.back().ellipse = true;  // 6 · 0.785 / 4
  EXPECT_EQ(at(), glm::dvec3(10, 2, 0));
  scene.lights[2].intensity = 1.179;
  EXPECT_TRUE(FindKeyLamp(scene)->endless) << "an ellipse is smaller by π / 4";
}

TEST(KeyLamp, MayBeAMeshThatEmits) {
  Scene scene = SceneOf(QuadMesh());
  scene.materials.resize(2);
  scene.materials[1].emission = glm::vec3(0.5f);
  Mesh lamp = QuadMesh();  // 4 m², as placed 1
  lamp.material = 1;
  AddObject(scene, "lamp", lamp, glm::scale(Moved(0, 0, 4), glm::dvec3(0.5)));
  // The box is from z 0 to 4: the centre is (0, 0, 2), 2 m from the lamp, which brings 0.5 · 1 / 4.
  scene.lights = {SunTowards({0, 1, 0}, 0.12)};
  ASSERT_TRUE(FindKeyLamp(scene));
  EXPECT_EQ(FindKeyLamp(scene)->at, glm::dvec3(0, 0, 4));
  scene.lights[0].intensity = 0.13;
  EXPECT_TRUE(FindKeyLamp(scene)->endless);
}

TEST(KeyLamp, WithoutALampTheCosineIsZero) {
  Scene scene = SceneOf(BallMesh(8));
  scene.world_radiance = glm::vec3(1.0f);
  EXPECT_FALSE(FindKeyLamp(scene));
  const GuidegenOptions options = Sized(16, 16, kBoth);
  const GuideSet guides = Render(scene, FrontCamera(4.0), options).guides;
  for (const float cosine : guides.Plane(Layer::kCosine)) EXPECT_EQ(cosine, 0.0f);
  scene.lights = {PointLight({0, 0, 9}, 0.0)};
  EXPECT_FALSE(FindKeyLamp(scene)) << "a black lamp is none";
  for (const PlanItem& item : PlanGuides(scene, options)) {
    if (item.layer == "cosine") {
      EXPECT_EQ(item.cost, "none: the scene has no lamp, so it is 0");
    }
  }
}

TEST(KeyLamp, NoRayIsCastForIt) {
  Scene scene = SceneOf(BallMesh(8));
  scene.lights = {PointLight({3, 3, 3}, 5.0)};
  const GuidegenResult result = Render(scene, FrontCamera(4.0), Sized(16, 16, kBoth));
  EXPECT_EQ(result.rays.shadow + result.rays.bounce, 0u);
  EXPECT_EQ(result.work.light_samples + result.work.materials, 0u);
}

TEST(KeyLamp, BadLightsAreRefusedAsForOtherLayers) {
  Scene scene = SceneOf(BallMesh(8));
  scene.lights = {PointLight({NAN, 0, 0}, 5.0)};
  const auto result = RenderGuides(scene, FrontCamera(4.0), Sized(8, 8, {Layer::kCosine}));
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, ErrorKind::kInput);
}

TEST(UvLayer, CountsFromTheLowerLeft) {
  Scene scene = SceneOf(QuadMesh());
  // The quad fills the picture; columns 0 … 7, rows from the top.
  const GuideSet guides = Render(scene, FlatCamera(3.0, 1.0), Sized(8, 8, {Layer::kUv})).guides;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      EXPECT_NEAR(guides.Plane(Layer::kUv, 0)[guides.Index(x, y)], (x + 0.5) / 8.0, 1e-6);
      EXPECT_NEAR(guides.Plane(Layer::kUv, 1)[guides.Index(x, y)], 1.0 - (y + 0.5) / 8.0, 1e-6);
    }
  }
  scene.meshes[0].uvs[0].clear();
  for (int c = 0; c < 2; ++c) {
    const GuideSet none = Render(scene, FlatCamera(3.0, 1.0), Sized(8, 8, {Layer::kUv})).guides;
    for (const float value : none.Plane(Layer::kUv, c)) EXPECT_EQ(value, 0.0f);
  }
}

// Two quads side by side, their border inside a pixel: each fragment has its own surface's values.
TEST(UvLayer, FragmentsHaveTheirOwnValues) {
  Scene scene = SceneOf(QuadMesh(), Moved(-1.03, 0, 0));
  AddObject(scene, "other", QuadMesh(), glm::rotate(Moved(0.97, 0, 0), glm::pi<double>() / 2, glm::dvec3(0, 0, 1)));
  scene.lights = {PointLight({0, 0, 1}, 5.0)};
  GuidegenOptions options = Sized(10, 10, kBoth);
  options.aa = 4, options.layers.Add(Layer::kPosition);
  const GuideSet guides = Render(scene, FlatCamera(3.0, 1.0), options).guides;
  ASSERT_TRUE(guides.fragments);
  const GuideSet& values = guides.fragments->values;
  ASSERT_GE(values.pixel_count(), 10u);
  for (std::size_t i = 0; i < values.pixel_count(); ++i) {
    const glm::dvec3 at(values.Vec3(Layer::kPosition, i));
    const bool is_left = at.x < -0.03;
    // The right one is turned by 90°: its u goes up, its v to the left.
    const double u = is_left ? (at.x + 2.03) / 2.0 : (at.y + 1.0) / 2.0;
    const double v = is_left ? (at.y + 1.0) / 2.0 : 1.0 - (at.x + 0.03) / 2.0;
    EXPECT_NEAR(values.Plane(Layer::kUv, 0)[i], u, 1e-5) << i;
    EXPECT_NEAR(values.Plane(Layer::kUv, 1)[i], v, 1e-5) << i;
    EXPECT_NEAR(values.Plane(Layer::kCosine)[i], glm::normalize(glm::dvec3(0, 0, 1) - at).z, 1e-5) << i;
  }
}

TEST(KeyLamp, BytesDoNotDependOnThreads) {
  Scene scene = SceneOf(BallMesh(12), glm::rotate(glm::dmat4(1.0), 0.7, glm::dvec3(1, 2, 3)));
  AddObject(scene, "other", BallMesh(9), Moved(0.9, 0.3, 0.4));
  scene.lights = {PointLight({2, 3, 4}, 5.0)};
  GuidegenOptions options = Sized(70, 50, kBoth);
  options.aa = 3, options.threads = 1;
  const GuideSet one = Render(scene, FrontCamera(5.0), options).guides;
  options.threads = 4;
  const GuideSet four = Render(scene, FrontCamera(5.0), options).guides;
  EXPECT_TRUE(SameBytes(one, four));
  ASSERT_TRUE(one.fragments && four.fragments);
  EXPECT_TRUE(SameBytes(one.fragments->values, four.fragments->values));
}

}  // namespace
}  // namespace scumble::testing
