// Light-path layers of a room with every feature: their cost, and that they repeat, converge and stay finite.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/light_path_scenes.h"

namespace scumble::testing {
namespace {

TEST(Economy, OnlyWhatASceneRequiresIsTraced) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.5f), 9.0);
  scene.lights = {PointLight({0, 0, 2}, 1.0), PointLight({1, 0, 2}, 1.0)};
  const auto rays = [&](LayerSet layers) { return Render(scene, FrontCamera(3.0), Paths(8, layers, 4)).rays; };
  EXPECT_EQ(rays({Layer::kLpeLDE}).shadow, 128u);
  EXPECT_EQ(rays({Layer::kLpeLDE}).bounce, 0u);
  EXPECT_EQ(rays({Layer::kLpeLSE}).shadow, 0u);
  EXPECT_EQ(rays({Layer::kLpeLSE}).bounce, 0u);
  EXPECT_EQ(rays({Layer::kLpeLD12E}).bounce, 256u);  // one for each sample
  EXPECT_EQ(rays({Layer::kNormal}).shadow, 0u);
  Light panel = Above(LightType::kArea, 2.0, 1.0);
  scene.lights.push_back(panel);
  EXPECT_EQ(rays({Layer::kLpeLDE}).bounce, 0u);
  scene.lights.clear();
  EXPECT_EQ(rays(kAllPaths).shadow, 0u);
  EXPECT_EQ(rays(kAllPaths).bounce, 0u);
  EXPECT_EQ(Mean(Render(scene, FrontCamera(3.0), Paths(8, kAllPaths)), Layer::kLpeFull), 0.0);
}

// A room with everything in it, for the tests that compare it with itself.
Scene Room() {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.7f), 3.0);
  Mesh ball = BallMesh(20);
  ball.material = AddMaterial(scene, Painted(Bsdf::kMetallicRoughness, 0.8f, 0.4f));
  AddObject(scene, "ball", ball, Moved(-1.2, 0, 1));
  Mesh mirror = BallMesh(20);
  mirror.material = AddMaterial(scene, Painted(Bsdf::kGlossy, 0.9f, 0.0f));
  AddObject(scene, "mirror", mirror, Moved(1.2, 0, 1));
  Material glow = Painted(Bsdf::kDiffuse, 0.2f);
  glow.emission = {3.0f, 2.0f, 1.0f};
  Mesh quad = QuadMesh();
  quad.material = AddMaterial(scene, glow);
  AddObject(scene, "glow", quad,
            glm::scale(glm::rotate(Moved(0, 2.5, 1), 0.5 * kPi, glm::dvec3(1, 0, 0)), glm::dvec3(0.5)));
  Light panel = Above(LightType::kArea, 4.0, 3.0);
  Light ball_lamp = PointLight({2, -2, 3}, 5.0);
  ball_lamp.radius = 0.3;
  Light sun = Above(LightType::kSun, 0.0, 0.5);
  sun.angle_degrees = 5.0;
  scene.lights = {panel, ball_lamp, sun, PointLight({-2, -2, 3}, 5.0)};
  scene.world_radiance = {0.1f, 0.1f, 0.2f};
  return scene;
}

const Camera kRoomCamera = LookingAt({0, -6, 4}, {0, 0, 0.8});

std::vector<float> Values(const GuidegenResult& result) {
  std::vector<float> values;
  for (const LayerInfo& info : AllLayers()) {
    if (!result.guides.Has(info.layer)) continue;
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      const auto plane = result.guides.Plane(info.layer, c);
      values.insert(values.end(), plane.begin(), plane.end());
    }
  }
  return values;
}

LayerSet Lit() { return LayerSet(kAllPaths).Add(Layer::kLuminance).Add(Layer::kShadow); }

TEST(LightPaths, AnyNumberOfThreadsGivesTheSameBytes) {
  GuidegenOptions options = Paths(40, Lit(), 4);
  options.threads = 1;
  const auto one = Render(Room(), kRoomCamera, options);
  options.threads = 7;
  const auto many = Render(Room(), kRoomCamera, options);
  EXPECT_EQ(Values(one), Values(many));
  EXPECT_EQ(one.rays.bounce, many.rays.bounce);
  EXPECT_EQ(one.rays.shadow, many.rays.shadow);
  EXPECT_EQ(one.samples, 4);
}

double RootMeanSquare(const GuidegenResult& a, const GuidegenResult& b, Layer layer) {
  double sum = 0.0;
  const auto left = a.guides.Plane(layer, 1);
  const auto right = b.guides.Plane(layer, 1);
  for (std::size_t i = 0; i < left.size(); ++i) sum += (left[i] - right[i]) * (left[i] - right[i]);
  return std::sqrt(sum / double(left.size()));
}

TEST(LightPaths, ErrorFallsAtLeastAsFastAsTheRootOfTheSamples) {
  const auto truth = Render(Room(), kRoomCamera, Paths(12, kAllPaths, 8192));
  std::vector<double> errors;
  for (const int samples : {8, 32, 128, 512}) {
    const auto result = Render(Room(), kRoomCamera, Paths(12, kAllPaths, samples));
    errors.push_back(RootMeanSquare(result, truth, Layer::kLpeFull));
  }
  const double slope = std::log(errors.back() / errors.front()) / std::log(512.0 / 8.0);
  RecordProperty("slope", std::to_string(slope));
  EXPECT_LT(slope, -0.45);
  EXPECT_GT(slope, -1.2);
}

TEST(LightPaths, TracedUntilTheErrorIsBelowTheLimit) {
  GuidegenOptions options = Paths(16, {Layer::kLpeFull});
  options.noise = 0.05;
  const auto adaptive = Render(Room(), kRoomCamera, options);
  EXPECT_GT(adaptive.samples, 8);
  EXPECT_LE(adaptive.noise, 0.05);
  const auto truth = Render(Room(), kRoomCamera, Paths(16, {Layer::kLpeFull}, 4096));
  const double error = RootMeanSquare(adaptive, truth, Layer::kLpeFull) / Mean(truth, Layer::kLpeFull);
  // The estimate takes two halves of the samples for independent. They fill each other's gaps, so it is a little large.
  EXPECT_LT(error, 1.2 * adaptive.noise);
  EXPECT_GT(error, 0.6 * adaptive.noise);
  const auto repeated = Render(Room(), kRoomCamera, Paths(16, {Layer::kLpeFull}, adaptive.samples));
  EXPECT_EQ(Values(adaptive), Values(repeated));
}

TEST(LightPaths, AnotherSeedGivesOtherNoiseOfTheEstimatedSize) {
  double last = 0.0;
  for (const int samples : {16, 256}) {
    GuidegenOptions options = Paths(32, {Layer::kLpeFull});
    options.noise = 1e-9;
    options.max_samples = samples;
    const auto zero = Render(Room(), kRoomCamera, options);
    EXPECT_EQ(zero.guides.attributes.count("scumble:seed"), 0u);
    options.seed = 7;
    const auto one = Render(Room(), kRoomCamera, options);
    EXPECT_EQ(one.guides.attributes.at("scumble:seed"), "7");
    options.seed = std::uint64_t(7) << 40;
    const auto two = Render(Room(), kRoomCamera, options);
    EXPECT_NE(Values(zero), Values(one));
    EXPECT_NE(Values(one), Values(two));
    options.seed = 7;
    EXPECT_EQ(Values(one), Values(Render(Room(), kRoomCamera, options)));
    // The difference of two pictures has the error of both.
    const double mean = Mean(zero, Layer::kLpeFull);
    const double error = RootMeanSquare(one, two, Layer::kLpeFull) / std::sqrt(2.0) / mean;
    EXPECT_NEAR(error / one.noise, 1.0, 0.3) << samples;
    EXPECT_NEAR(Mean(one, Layer::kLpeFull) / mean, 1.0, 4.0 * one.noise / 32.0);
    if (last > 0.0) {
      EXPECT_LT(error, last / 3.5);
    }
    last = error;
  }
  GuidegenOptions soft = Paths(16, {Layer::kLuminance}, 4);
  const auto zero = Render(Room(), kRoomCamera, soft);
  soft.seed = 7;
  EXPECT_NE(Values(zero), Values(Render(Room(), kRoomCamera, soft)));
}

TEST(LightPaths, ATimeBudgetSaysWhatRepeatsIt) {
  GuidegenOptions options = Paths(16, {Layer::kLpeFull});
  options.time_budget_seconds = 0.2;
  const auto budgeted = Render(Room(), kRoomCamera, options);
  EXPECT_GE(budgeted.samples, 1);
  const auto repeated = Render(Room(), kRoomCamera, Paths(16, {Layer::kLpeFull}, budgeted.samples));
  EXPECT_EQ(Values(budgeted), Values(repeated));
}

TEST(LightPaths, ATimeBudgetThatIsOverAtOnceTakesOneSample) {
  GuidegenOptions options = Paths(16, {Layer::kLpeFull});
  options.time_budget_seconds = 1e-9;
  const auto hasty = Render(Room(), kRoomCamera, options);
  EXPECT_EQ(hasty.samples, 1);
  EXPECT_EQ(Values(hasty), Values(Render(Room(), kRoomCamera, Paths(16, {Layer::kLpeFull}, 1))));
}

TEST(LightPaths, ATimeBudgetMayBeLeftWhenTheErrorIsBelowTheLimit) {
  GuidegenOptions options = Paths(16, {Layer::kLpeFull});
  options.time_budget_seconds = 1e6;
  options.noise = 0.5;
  const auto early = Render(Room(), kRoomCamera, options);
  EXPECT_EQ(early.samples, 16);
  EXPECT_LE(early.noise, 0.5);
  EXPECT_EQ(Values(early), Values(Render(Room(), kRoomCamera, Paths(16, {Layer::kLpeFull}, 16))));
}

TEST(LightPaths, SmallMaxBouncesTakeAwayAndNeverAdd) {
  GuidegenOptions options = Paths(12, {Layer::kLpeFull}, 64);
  double last = 0.0;
  for (const int bounces : {0, 1, 2, 8}) {
    options.max_bounces = bounces;
    const double mean = Mean(Render(Room(), kRoomCamera, options), Layer::kLpeFull);
    EXPECT_GE(mean, last) << bounces;
    last = mean;
  }
}

TEST(LightPaths, ExtremesStayFiniteAndNotNegative) {
  for (const double intensity : {1e-6, 1.0, 1e6}) {
    for (const float roughness : {0.0f, 1e-3f, 0.02f, 1.0f}) {
      Scene scene = Room();
      for (Material& material : scene.materials) material.roughness = roughness;
      for (Light& light : scene.lights) light.intensity *= intensity;
      // Lights that touch: on the floor's surface, in it, and inside the sphere.
      Light panel = Above(LightType::kArea, 0.0, intensity);
      Light ball = PointLight({0, 0, 0}, intensity);
      ball.radius = 0.5;
      Light tiny = PointLight({0.5, 0.5, 0}, intensity);
      Light inside = PointLight({-1.2, 0, 1}, intensity);
      scene.lights.insert(scene.lights.end(), {panel, ball, tiny, inside});
      ExpectFinite(Render(scene, kRoomCamera, Paths(12, Lit(), 8)));
      ExpectFinite(Render(scene, LookingAt({-1.2, 0.1, 1.2}, {0, 0, 0.5}), Paths(8, Lit(), 8)));
    }
  }
}

// Extremes.OneOfFiveHundred… and …ManySoftLamps… test that they give the sum of all.
TEST(LightPaths, FiveHundredLights) {
  Scene scene = Room();
  for (int i = 0; i < 500; ++i) {
    Light light = PointLight({std::cos(i) * 3.0, std::sin(i) * 3.0, 1.0 + i * 0.01}, 0.01 * (1 + i % 7));
    if (i % 3 == 0) light.radius = 0.05;
    if (i % 5 == 0) light.type = LightType::kArea;
    scene.lights.push_back(light);
  }
  ExpectFinite(Render(scene, kRoomCamera, Paths(8, Lit(), 256)));
}

// What stands on a floor and shines fills half of a place's sky at most. Where a point of it and a direction are
// weighed against each other, at all distances, a sample's variance is then no more than ½ · ½ of the square of what a
// sky of its radiance would bring, and a net in base 2 may double it (Extremes.ALampThatSwallowsTheObject… says why).
// So no pixel has more than a half and five standard errors, 0.94 of such a sky's light.
constexpr int kTouchSamples = 64;
const double kMostOfASky = 0.5 + 5.0 * std::sqrt(2.0 * 0.25 / kTouchSamples);

TEST(LightPaths, LampsThatTouchASurfaceMakeNoFireflies) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.8f), 2.0);
  Light panel = Above(LightType::kArea, 0.001, 1.0);
  panel.world_from_light = glm::rotate(Moved(0, 0, 0.5), 0.5 * kPi, glm::dvec3(1, 0, 0));  // stands on the floor
  scene.lights = {panel};
  const auto result = Render(scene, FrontCamera(4.0), Paths(48, {Layer::kLpeLDE}, kTouchSamples));
  for (const float value : result.guides.Plane(Layer::kLpeLDE)) EXPECT_LE(value, 0.8 * kMostOfASky);
}

// One panel, and ten of which one is chosen. All of the floor is within four of their radii, so that directions look
// for them from everywhere.
TEST(LightPaths, EmissiveMeshesThatTouchASurfaceMakeNoFireflies) {
  for (const int count : {1, 10}) {
    Scene scene = Floor(Painted(Bsdf::kDiffuse, 1.0f), 2.0);
    Material glow = Painted(Bsdf::kEmission, 1.0f);
    glow.emission = glm::vec3(1.0f);
    Mesh quad = QuadMesh();
    quad.material = AddMaterial(scene, glow);
    for (int i = 0; i < count; ++i) {
      const double width = 0.5 / count;
      AddObject(scene, "panel" + std::to_string(i), quad,
                glm::scale(glm::rotate(Moved((2 * i + 1 - count) * 2.0 * width, 0, 1), 0.5 * kPi, {1, 0, 0}),
                           glm::dvec3(width, 1.0, 1.0)));
    }
    const LayerSet layers = {Layer::kLpeLDE, Layer::kLuminance, Layer::kShadow};
    const Camera camera = LookingAt({0, -4, 3}, {0, 0, 0}, 34.0);
    const auto result = Render(scene, camera, Paths(96, layers, kTouchSamples));
    ExpectFinite(result);
    double luminance = 0.0, diffuse = 0.0, worst = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < result.guides.pixel_count(); ++i) {
      const double white = result.guides.Plane(Layer::kLuminance)[i], path = result.guides.Plane(Layer::kLpeLDE, 1)[i];
      if (white == 0.0 && path == 0.0) continue;
      const auto object = std::uint32_t(result.guides.Plane(Layer::kObject)[i]);
      if (result.guides.object_names.at(object).starts_with("panel")) continue;  // luminance has its own light, too
      luminance += white, diffuse += path, squares += (white - path) * (white - path);
      EXPECT_EQ(result.guides.Plane(Layer::kShadow)[i], 0.0f) << i;
      worst = std::max({worst, white, path});
    }
    EXPECT_LE(worst, kMostOfASky) << count;
    // Both layers mean the same, and every pixel of either draws by itself: the differences' squares add up to the
    // variance of their sum. A tenth of the light missing would show.
    const double tolerance = 5.0 * std::sqrt(squares);
    EXPECT_NEAR(luminance, diffuse, tolerance) << count;
    EXPECT_LT(tolerance, 0.1 * diffuse) << count;
  }
}

// The back of an emissive sphere is hidden by its own front, and that is no shadow; a lid over the floor is.
TEST(LightPaths, OnlyWhatDoesNotShineCastsShadowsInTheLightOfMeshes) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 1.0f), 2.0);
  Material glow = Painted(Bsdf::kEmission, 1.0f);
  glow.emission = glm::vec3(1.0f);
  Mesh ball = BallMesh(16);
  ball.material = AddMaterial(scene, glow);
  AddObject(scene, "ball", ball, glm::scale(Moved(0, 0, 1.5), glm::dvec3(0.5)));
  const LayerSet layers = {Layer::kLuminance, Layer::kShadow};
  const auto free = Render(scene, SlantedSpot(), Paths(1, layers, 1024));
  EXPECT_EQ(free.guides.Plane(Layer::kShadow)[0], 0.0f);
  // A sphere of radius r and radiance 1, d above: (r/d)².
  EXPECT_NEAR(free.guides.Plane(Layer::kLuminance)[0], 1.0 / 9.0, 2e-3);
  // Half of the sphere is behind a lid whose edge is right above the point; the camera looks in from the other side.
  AddObject(scene, "lid", QuadMesh(), glm::scale(Moved(0, 1, 0.3), glm::dvec3(2.0, 1.0, 1.0)));
  const auto half = Render(scene, SlantedSpot(), Paths(1, layers, 4096));
  EXPECT_NEAR(half.guides.Plane(Layer::kShadow)[0], 0.5, 5e-3);
}

TEST(LightPaths, BadLightIsRefusedByName) {
  const auto refuse = [](const Scene& scene, const std::string& what) {
    const auto result = RenderGuides(scene, kRoomCamera, Paths(2, kAllPaths));
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().kind, ErrorKind::kInput);
    EXPECT_NE(result.error().message.find(what), std::string::npos) << result.error().message;
  };
  Scene scene = Room();
  scene.lights[1].radius = -1.0;
  refuse(scene, "lamp");
  scene = Room();
  scene.lights[2].angle_degrees = 181.0;
  refuse(scene, "180");
  scene = Room();
  scene.lights[0].size_x = std::numeric_limits<double>::quiet_NaN();
  refuse(scene, "size");
  scene = Room();
  scene.lights[0].color.g = -1.0f;
  refuse(scene, "brightness");
  scene = Room();
  scene.world_radiance.r = -1.0f;
  refuse(scene, "world");
  scene = Room();
  scene.materials[0].emission.b = std::numeric_limits<float>::infinity();
  refuse(scene, "paint");
}

TEST(LightPaths, NoMoreSamplesThanAllowedHoweverLargeTheError) {
  for (const int most : {1, 4, 20}) {
    GuidegenOptions options = Paths(16, {Layer::kLpeFull});
    options.noise = 1e-9;
    options.max_samples = most;
    const auto capped = Render(Room(), kRoomCamera, options);
    EXPECT_EQ(capped.samples, most);
    EXPECT_EQ(capped.noise > 0.0, most > 1);
    EXPECT_EQ(Values(capped), Values(Render(Room(), kRoomCamera, Paths(16, {Layer::kLpeFull}, most))));
  }
}

TEST(LightPaths, LuminanceTakesNoLimitOfTheNoise) {
  GuidegenOptions options = Paths(8, {Layer::kLuminance});
  options.noise = 0.1;
  const auto refused = RenderGuides(Room(), kRoomCamera, options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kUsage);
  EXPECT_NE(refused.error().message.find("take samples of their own"), std::string::npos) << refused.error().message;
  // Under lights without extent there is no noise, and nothing to refuse.
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.5f));
  scene.lights = {PointLight({0, 0, 2}, 1.0)};
  EXPECT_GT(Render(scene, FrontCamera(3.0), options).guides.Plane(Layer::kLuminance)[0], 0.0f);
}

TEST(LightPaths, OptionsOutOfRangeAreRefused) {
  const auto refuse = [](const GuidegenOptions& options, const std::string& what) {
    const auto result = RenderGuides(Room(), kRoomCamera, options);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().kind, ErrorKind::kUsage);
    EXPECT_NE(result.error().message.find(what), std::string::npos) << result.error().message;
  };
  refuse(Paths(2, kAllPaths, 0), "samples 0");
  refuse(Paths(2, kAllPaths, kMaxSamples + 1), "samples");
  GuidegenOptions options = Paths(2, kAllPaths);
  options.max_bounces = -1;
  refuse(options, "max_bounces -1");
  options = Paths(2, kAllPaths);
  options.noise = std::numeric_limits<double>::quiet_NaN();
  refuse(options, "noise");
  options = Paths(2, kAllPaths);
  options.time_budget_seconds = -1.0;
  refuse(options, "time budget");
}

}  // namespace
}  // namespace scumble::testing
