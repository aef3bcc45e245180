// Light-path layers against light that is known: furnaces, form factors, exact lights, integrals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/light_path_scenes.h"

namespace scumble::testing {
namespace {

TEST(Furnace, WhiteLambertReturnsTheWorld) {
  const LayerSet layers = {Layer::kLpeFull, Layer::kLpeLDE, Layer::kLuminance};
  Scene cube = SceneOf(CubeMesh());
  cube.materials[0] = Painted(Bsdf::kDiffuse, 1.0f);
  cube.world_radiance = glm::vec3(1.0f);
  const auto flat = Render(cube, LookingAt({2, 3, 5}, {0, 0, 0}), Paths(16, layers, 8));
  for (std::size_t i = 0; i < flat.guides.pixel_count(); ++i) {
    const float covered = flat.guides.Plane(Layer::kCoverage)[i];
    EXPECT_NEAR(flat.guides.Plane(Layer::kLpeFull)[i], covered, 1e-6);
    EXPECT_NEAR(flat.guides.Plane(Layer::kLpeLDE)[i], covered, 1e-6);
    EXPECT_NEAR(flat.guides.Plane(Layer::kLuminance)[i], covered, 1e-6);
  }
  // Where shading normals differ from the facets' own, directions below the facet are lost: a share of about 1e-4.
  Scene ball = SceneOf(BallMesh(64));
  ball.materials[0] = cube.materials[0];
  ball.world_radiance = glm::vec3(1.0f);
  const auto round = Render(ball, FrontCamera(4.0), Paths(24, layers));
  for (const Layer layer : {Layer::kLpeFull, Layer::kLpeLDE, Layer::kLuminance}) {
    double sum = 0.0;
    double covered = 0.0;
    for (const float value : round.guides.Plane(layer)) sum += value;
    for (const float value : round.guides.Plane(Layer::kCoverage)) covered += value;
    EXPECT_NEAR(sum / covered, 1.0, 1e-3) << Info(layer).name;
  }
}

TEST(Furnace, ConcaveWhiteReturnsTheWorldAfterEnoughBounces) {
  // The inside corner of two white planes: what one bounce does not return, the others do.
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 1.0f));
  AddObject(scene, "wall", QuadMesh(), glm::rotate(Moved(0, 1, 1), 0.5 * kPi, glm::dvec3(1, 0, 0)));
  scene.world_radiance = glm::vec3(1.0f);
  GuidegenOptions options = Paths(8, {Layer::kLpeFull}, 512);
  options.max_bounces = 200;
  const auto result = Render(scene, LookingAt({0, -2, 3}, {0, 0.5, 0.2}, 8.0), options);
  EXPECT_NEAR(Mean(result, Layer::kLpeFull), 1.0, 1e-3);
}

TEST(Furnace, NoRoughnessReturnsMoreThanTheWorld) {
  for (const float roughness : {0.0f, 0.1f, 0.3f, 0.6f, 1.0f}) {
    for (const Bsdf bsdf : {Bsdf::kGlossy, Bsdf::kMetallicRoughness}) {
      Scene ball = SceneOf(BallMesh(48));
      ball.materials[0] = Painted(bsdf, 1.0f, roughness);
      ball.world_radiance = glm::vec3(1.0f);
      const auto result = Render(ball, FrontCamera(4.0), Paths(12, {Layer::kLpeFull}, 128));
      for (const float value : result.guides.Plane(Layer::kLpeFull)) EXPECT_LE(value, 1.03f) << roughness;
      EXPECT_LE(Mean(result, Layer::kLpeFull), 1.0 + 1e-3);
      EXPECT_GT(Mean(result, Layer::kLpeFull), 0.3);
    }
  }
}

TEST(DirectLight, DeltaLampsAreExactWithoutChance) {
  const double albedo = 0.5;
  for (const int samples : {1, 64}) {
    Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.5f));
    scene.lights = {Above(LightType::kPoint, 2.0, 3.0)};
    const auto point = Render(scene, Spot(), Paths(1, {Layer::kLpeLDE, Layer::kLuminance}, samples));
    EXPECT_NEAR(Center(point, Layer::kLpeLDE), albedo * 3.0 / 4.0 / kPi, 1e-6);
    EXPECT_NEAR(point.guides.Plane(Layer::kLuminance)[0] * albedo, Center(point, Layer::kLpeLDE), 1e-6);
    EXPECT_EQ(point.samples, 0);
    EXPECT_EQ(point.rays.bounce, 0u);
    EXPECT_EQ(point.rays.shadow, 2u);  // one for each of the layers

    scene.lights = {Above(LightType::kSun, 0.0, 3.0)};
    EXPECT_NEAR(Center(Render(scene, Spot(), Paths(1, {Layer::kLpeLDE}, samples)), Layer::kLpeLDE), 1.5 / kPi, 1e-6);

    // 60° off the axis: inside the outer cone, halfway through Cycles' blend.
    Light spot = Above(LightType::kSpot, 2.0, 8.0);
    spot.world_from_light =
        glm::inverse(glm::lookAt(glm::dvec3(0, 0, 2), glm::dvec3(0, 1, 2 - std::sqrt(3.0)), {1, 0, 0}));
    spot.cycles_spot = true;
    spot.outer_cone_degrees = 60.0;
    spot.spot_blend = 1.0;
    scene.lights = {spot};
    const double cosine = std::cos(glm::radians(30.0));
    const double t = (cosine - 0.5) / 0.5;
    const double expected = albedo / kPi * 8.0 / 4.0 * cosine * t * t * (3.0 - 2.0 * t);
    EXPECT_NEAR(Center(Render(scene, Spot(), Paths(1, {Layer::kLpeLDE}, samples)), Layer::kLpeLDE), expected, 1e-6);
    scene.lights[0].spot_cosine = false;  // as in later versions of Cycles
    EXPECT_NEAR(Center(Render(scene, Spot(), Paths(1, {Layer::kLpeLDE}, samples)), Layer::kLpeLDE), expected / cosine,
                1e-6);
  }
}

TEST(DirectLight, ColouredLampsAndTexturesMultiply) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 1.0f));
  scene.materials[0].base_color = {0.2f, 0.5f, 0.8f, 1.0f};
  scene.lights = {Above(LightType::kSun, 0.0, kPi)};
  scene.lights[0].color = {1.0f, 0.5f, 0.25f};
  const auto result = Render(scene, Spot(), Paths(1, {Layer::kLpeLDE}));
  const glm::vec3 light = result.guides.Vec3(Layer::kLpeLDE, 0);
  EXPECT_NEAR(light.r, 0.2, 1e-6);
  EXPECT_NEAR(light.g, 0.25, 1e-6);
  EXPECT_NEAR(light.b, 0.2, 1e-6);
}

// Irradiance under the middle of a rectangle that faces it, per radiance: the form factor of four corners times π.
double RectangleFormFactor(double width, double depth, double height) {
  const double x = 0.5 * width / height;
  const double y = 0.5 * depth / height;
  const double corner = (x / std::sqrt(1 + x * x) * std::atan(y / std::sqrt(1 + x * x)) +
                         y / std::sqrt(1 + y * y) * std::atan(x / std::sqrt(1 + y * y))) /
                        (2.0 * kPi);
  return 4.0 * corner;
}

TEST(DirectLight, SoftLampsHaveTheirAnalyticIrradiance) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 1.0f), 4.0);
  const auto radiance = [&](const Light& light) {
    scene.lights = {light};
    const auto result = Render(scene, Spot(), Paths(1, {Layer::kLpeLDE, Layer::kLuminance, Layer::kShadow}, 4096));
    EXPECT_NEAR(result.guides.Plane(Layer::kLuminance)[0], Center(result, Layer::kLpeLDE), 2e-3);
    EXPECT_EQ(result.guides.Plane(Layer::kShadow)[0], 0.0f);
    return Center(result, Layer::kLpeLDE);
  };
  Light panel = Above(LightType::kArea, 1.5, 2.0);
  panel.size_x = 2.0;
  panel.size_y = 1.0;
  EXPECT_NEAR(radiance(panel), 2.0 * RectangleFormFactor(2.0, 1.0, 1.5), 1e-3);
  panel.ellipse = true;
  panel.size_y = 2.0;  // a disc of radius 1 m
  EXPECT_NEAR(radiance(panel), 2.0 / (1.0 + 1.5 * 1.5), 1e-3);
  // A disc that faces the point: sin² of its half angle, and I = L π r².
  Light ball = Above(LightType::kPoint, 1.5, 2.0);
  ball.radius = 0.5;
  EXPECT_NEAR(radiance(ball), 2.0 / (1.5 * 1.5 + 0.5 * 0.5) / kPi, 1e-3);
  Light sun = Above(LightType::kSun, 0.0, 2.0);
  for (const double degrees : {0.5, 10.0, 60.0, 120.0}) {
    sun.angle_degrees = degrees;
    const double half = glm::radians(0.5 * degrees);
    const double share = 2.0 * (1.0 / std::cos(half) - 1.0) / std::pow(std::tan(half), 2.0);
    EXPECT_NEAR(radiance(sun), 2.0 / kPi * share, 1e-3) << degrees;
  }
  // The light's back is dark.
  panel.world_from_light = glm::rotate(Moved(0, 0, 1.5), kPi, glm::dvec3(1, 0, 0));
  EXPECT_EQ(radiance(panel), 0.0);
}

TEST(DirectLight, EmissiveMeshesLightLikeLampsOfTheirShape) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 1.0f), 4.0);
  Material glow = Painted(Bsdf::kEmission, 1.0f);
  glow.emission = glm::vec3(2.0f);
  Mesh panel = QuadMesh();
  panel.material = AddMaterial(scene, glow);
  AddObject(scene, "panel", panel, glm::scale(Moved(0, 0, 1.5), glm::dvec3(1.0, 0.5, 1.0)));
  const auto result =
      Render(scene, SlantedSpot(), Paths(1, {Layer::kLpeLDE, Layer::kLpeFull, Layer::kLuminance}, 4096));
  const double expected = 2.0 * RectangleFormFactor(2.0, 1.0, 1.5);
  EXPECT_NEAR(Center(result, Layer::kLpeLDE), expected, 2e-3);
  EXPECT_NEAR(Center(result, Layer::kLpeFull), expected, 2e-3);
  EXPECT_NEAR(result.guides.Plane(Layer::kLuminance)[0], expected, 2e-3);
  // Seen itself, it is in the full picture alone.
  const auto seen = Render(scene, LookingAt({0, -3, 3}, {0, 0, 1.5}, 1e-3), Paths(1, kAllPaths));
  EXPECT_EQ(Center(seen, Layer::kLpeFull), 2.0);
  EXPECT_EQ(Center(seen, Layer::kLpeLDE), 0.0);
}

// What white Lambert reflects of a polygon of radiance 1, all of it above the horizon: Lambert's sum over its edges.
double PolygonLight(const std::vector<glm::dvec3>& corners, const glm::dvec3& point, const glm::dvec3& normal) {
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 a = glm::normalize(corners[i] - point);
    const glm::dvec3 b = glm::normalize(corners[(i + 1) % corners.size()] - point);
    const glm::dvec3 across = glm::cross(a, b);
    sum += glm::normalize(across) * std::atan2(glm::length(across), glm::dot(a, b));
  }
  return std::abs(glm::dot(sum, normal)) / (2.0 * kPi);
}

// The farther the camera, the coarser Embree's floats: the panel must not be found before itself.
TEST(DirectLight, EmissiveMeshesDoNotShadeThemselvesHoweverFarTheCamera) {
  for (const double height : {0.05, 0.6}) {
    // A strip that is tilted a little, so that its corners are rounded each by itself.
    const std::vector<glm::dvec3> corners = {{-0.8, -0.503, height},
                                             {0.8, -0.507, height + 0.011},
                                             {0.8, -0.45, height + 0.013},
                                             {-0.8, -0.45, height + 0.003}};
    Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.8f), 2.0);
    Material glow = Painted(Bsdf::kEmission, 1.0f);
    glow.emission = glm::vec3(1.0f);
    Mesh strip;
    for (const glm::dvec3& corner : corners) strip.positions.push_back(corner);
    strip.triangles = {{0, 1, 2}, {0, 2, 3}};
    strip.material = AddMaterial(scene, glow);
    AddObject(scene, "strip", strip, glm::dmat4(1.0));
    for (const double distance : {5.0, 50.0, 500.0}) {
      const double k = distance / 5.0;
      const Camera camera =
          LookingAt({1.3 * k, -4.0 * k, 3.1 * k}, {0, 0, 0}, glm::degrees(2.0 * std::atan(std::tan(0.15) / k)));
      const auto result =
          Render(scene, camera, Paths(24, {Layer::kLpeLDE, Layer::kLuminance, Layer::kShadow, Layer::kPosition}, 1024));
      double light = 0.0, luminance = 0.0, expected = 0.0, worst_shadow = 0.0;
      for (std::size_t i = 0; i < result.guides.pixel_count(); ++i) {
        const glm::dvec3 point = result.guides.Vec3(Layer::kPosition, i);
        if (result.guides.Plane(Layer::kCoverage)[i] == 0.0f || point.z > 0.5 * height) continue;
        expected += PolygonLight(corners, point, {0, 0, 1});
        light += result.guides.Plane(Layer::kLpeLDE, 1)[i];
        luminance += result.guides.Plane(Layer::kLuminance)[i];
        worst_shadow = std::max(worst_shadow, double(result.guides.Plane(Layer::kShadow)[i]));
      }
      EXPECT_EQ(worst_shadow, 0.0) << height << " m, camera at " << distance << " m";
      EXPECT_NEAR(light / (0.8 * expected), 1.0, 4e-3) << height << " m, camera at " << distance << " m";
      EXPECT_NEAR(luminance / expected, 1.0, 4e-3) << height << " m, camera at " << distance << " m";
    }
  }
}

TEST(DirectLight, WorldUnderAnOverhang) {
  // A wide roof above the left half space of a point hides half of the sky: the upright wall through the point.
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.5f), 1.0);
  Mesh wall = QuadMesh();
  wall.material = AddMaterial(scene, Painted(Bsdf::kDiffuse, 0.0f));
  AddObject(scene, "wall", wall,
            glm::scale(glm::rotate(Moved(0.001, 0, 0), 0.5 * kPi, glm::dvec3(0, 1, 0)), glm::dvec3(1000.0)));
  scene.world_radiance = glm::vec3(2.0f);
  const Camera camera = LookingAt({-2, 0, 2}, {0, 0, 0}, 1e-4);
  const auto result = Render(scene, camera, Paths(1, {Layer::kLpeLDE, Layer::kShadow, Layer::kLuminance}, 1024));
  EXPECT_NEAR(Center(result, Layer::kLpeLDE), 0.5, 3e-3);
  EXPECT_NEAR(result.guides.Plane(Layer::kLuminance)[0], 1.0, 5e-3);
  EXPECT_NEAR(result.guides.Plane(Layer::kShadow)[0], 0.5, 3e-3);
  EXPECT_EQ(result.rays.bounce, 0u);
}

// A roughness of 1e-4 counts as none.
TEST(Specular, MirrorsShowLampsAndWorldAndTheEyeDoesNot) {
  for (const float roughness : {0.0f, 1e-4f}) {
    SCOPED_TRACE(roughness);
    Scene scene = Floor(Painted(Bsdf::kGlossy, 0.5f, roughness), 4.0);
    Light panel = Above(LightType::kArea, 3.0, 8.0);
    panel.world_from_light = Moved(0, 3, 3);
    panel.size_x = panel.size_y = 1.0;
    Light sun = Above(LightType::kSun, 0.0, 1.0);
    sun.angle_degrees = 10.0;
    sun.world_from_light = glm::rotate(glm::dmat4(1.0), -0.25 * kPi, glm::dvec3(1, 0, 0));
    const double sun_radiance = 1.0 / (kPi * std::pow(std::tan(glm::radians(5.0)), 2));
    scene.lights = {panel};
    const auto lamp = Render(scene, SlantedSpot(), Paths(1, kAllPaths, 4));
    EXPECT_NEAR(Center(lamp, Layer::kLpeLSE), 4.0, 1e-6);
    EXPECT_NEAR(Center(lamp, Layer::kLpeFull), 4.0, 1e-6);
    EXPECT_EQ(Center(lamp, Layer::kLpeLDE), 0.0);
    scene.lights = {sun};
    EXPECT_NEAR(Center(Render(scene, SlantedSpot(), Paths(1, kAllPaths, 4)), Layer::kLpeLSE), 0.5 * sun_radiance, 1e-4);
    scene.lights.clear();
    scene.world_radiance = glm::vec3(3.0f);
    EXPECT_NEAR(Center(Render(scene, SlantedSpot(), Paths(1, kAllPaths, 4)), Layer::kLpeLSE), 1.5, 1e-6);
    // The light between the eye and the floor is not in the picture.
    scene.world_radiance = glm::vec3(0.0f);
    panel.world_from_light = Moved(0, -1.5, 1.5);
    scene.lights = {panel};
    EXPECT_EQ(Center(Render(scene, SlantedSpot(), Paths(1, kAllPaths, 4)), Layer::kLpeFull), 0.0);
  }
}

TEST(Specular, RoughHighlightsAgreeByLampAndByMesh) {
  // An equal square of light as an area light and as a mesh, seen in a rough floor: two sets of techniques, one truth.
  for (const float roughness : {0.2f, 0.5f, 0.9f}) {
    Scene lamp_scene = Floor(Painted(Bsdf::kGlossy, 1.0f, roughness), 4.0);
    Scene mesh_scene = lamp_scene;
    const glm::dmat4 placed = Moved(0.2, 1.5, 2.0);
    Light panel = Above(LightType::kArea, 0.0, 1.0);
    panel.world_from_light = placed;
    panel.size_x = panel.size_y = 2.0;
    lamp_scene.lights = {panel};
    Material glow = Painted(Bsdf::kEmission, 1.0f);
    glow.emission = glm::vec3(1.0f);
    Mesh quad = QuadMesh();
    quad.material = AddMaterial(mesh_scene, glow);
    AddObject(mesh_scene, "panel", quad, placed);
    const auto by_lamp = Render(lamp_scene, SlantedSpot(), Paths(1, {Layer::kLpeLSE}, 8192));
    const auto by_mesh = Render(mesh_scene, SlantedSpot(), Paths(1, {Layer::kLpeLSE}, 8192));
    const double a = Center(by_lamp, Layer::kLpeLSE);
    EXPECT_GT(a, 0.01);
    EXPECT_NEAR(Center(by_mesh, Layer::kLpeLSE) / a, 1.0, 0.01) << roughness;
  }
}

TEST(Specular, DeltaLampsGiveTheLobesOwnValue) {
  Scene scene = Floor(Painted(Bsdf::kGlossy, 1.0f, 0.5f), 4.0);
  Light sun = Above(LightType::kSun, 0.0, 2.0);
  sun.world_from_light = glm::rotate(glm::dmat4(1.0), -0.25 * kPi, glm::dvec3(1, 0, 0));
  scene.lights = {sun};
  const auto result = Render(scene, SlantedSpot(), Paths(1, {Layer::kLpeLSE}));
  // At the mirror angle D = 1/(π α²), and both masking terms are G1(45°).
  const double alpha = 0.25;
  const double cosine = std::sqrt(0.5);
  const double g1 = 2.0 * cosine / (cosine + std::sqrt(alpha * alpha * 0.5 + 0.5));
  const double expected = 2.0 * g1 * g1 / (kPi * alpha * alpha) / (4.0 * cosine);
  EXPECT_NEAR(Center(result, Layer::kLpeLSE) / expected, 1.0, 1e-5);
  EXPECT_EQ(result.samples, 0);
}

// The radiance at the middle of the floor by light that a second plate scatters onto it: a grid over the plate.
double PlateIntegral(double side, double height, double floor_albedo, double plate_albedo, double sun) {
  const int n = 400;
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double x = ((i + 0.5) / n - 0.5) * 2.0 * side;
      const double y = ((j + 0.5) / n - 0.5) * 2.0 * side;
      const double square = x * x + y * y + height * height;
      sum += height * height / (square * square);
    }
  }
  return floor_albedo / kPi * plate_albedo * sun / kPi * sum * (4.0 * side * side / (double(n) * n));
}

// A floor and, parallel to it, a plate whose lower face is lit by a sun from below through a floor that the light does
// not meet: it comes from the side.
TEST(Interreflection, FacingPlatesAgreeWithTheIntegral) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.6f), 0.05);
  Mesh plate = QuadMesh();
  plate.material = AddMaterial(scene, Painted(Bsdf::kDiffuse, 0.8f));
  AddObject(scene, "plate", plate, glm::scale(Moved(0, 0, 1.0), glm::dvec3(0.5, 0.5, 1.0)));
  Light sun = Above(LightType::kSun, 0.0, 2.0);
  sun.world_from_light = glm::rotate(glm::dmat4(1.0), kPi, glm::dvec3(1, 0, 0));  // shines up +Z
  scene.lights = {sun};
  const auto result = Render(scene, LookingAt({0, -3, 0.5}, {0, 0, 0}, 1e-4), Paths(1, kAllPaths, 8192));
  // The floor's shadow on the plate, 0.1 × 0.1 m right above it, is missing from the light.
  const double expected = PlateIntegral(0.5, 1.0, 0.6, 0.8, 2.0) - PlateIntegral(0.05, 1.0, 0.6, 0.8, 2.0);
  EXPECT_EQ(Center(result, Layer::kLpeLDE), 0.0);
  EXPECT_NEAR(Center(result, Layer::kLpeLDDE) / expected, 1.0, 0.01);
  EXPECT_NEAR(Center(result, Layer::kLpeLD12E) / expected, 1.0, 0.01);
  EXPECT_NEAR(Center(result, Layer::kLpeFull), Center(result, Layer::kLpeLDDE), 1e-3 * expected);
}

// A box of one grey, closed but for what its inside emits: radiance inside is emission / (1 − albedo) everywhere.
TEST(Interreflection, AGlowingBoxSumsTheGeometricSeries) {
  Scene scene = SceneOf(CubeMesh());
  scene.materials[0] = Painted(Bsdf::kDiffuse, 0.5f);
  scene.materials[0].emission = glm::vec3(1.0f);
  GuidegenOptions options = Paths(6, kAllPaths, 1024);
  options.max_bounces = 40;
  const auto result = Render(scene, FrontCamera(0.3, 70.0), options);
  EXPECT_NEAR(Mean(result, Layer::kLpeFull), 2.0, 5e-3);
  EXPECT_NEAR(Mean(result, Layer::kLpeLDE), 0.5, 3e-3);
  EXPECT_NEAR(Mean(result, Layer::kLpeLDDE), 0.5, 3e-3);
  EXPECT_NEAR(Mean(result, Layer::kLpeLD12E), 0.75, 3e-3);
  EXPECT_EQ(Mean(result, Layer::kLpeLSE), 0.0);
  options.max_bounces = 0;
  EXPECT_NEAR(Mean(Render(scene, FrontCamera(0.3, 70.0), options), Layer::kLpeFull), 1.5, 3e-3);
}

TEST(Interreflection, LayersAddUpInADiffuseScene) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.7f), 2.0);
  AddObject(scene, "ball", BallMesh(24), glm::scale(Moved(0, 0, 0.6), glm::dvec3(0.6)));
  Light lamp = Above(LightType::kPoint, 3.0, 20.0);
  lamp.radius = 0.3;
  scene.lights = {lamp};
  const auto result = Render(scene, LookingAt({0, -4, 3}, {0, 0, 0}), Paths(16, kAllPaths, 16));
  for (std::size_t i = 0; i < result.guides.pixel_count(); ++i) {
    const float full = result.guides.Plane(Layer::kLpeFull)[i];
    const float parts = result.guides.Plane(Layer::kLpeLDE)[i] + result.guides.Plane(Layer::kLpeLDDE)[i];
    EXPECT_NEAR(full, parts, 1e-5f * (1.0f + full));
    EXPECT_LE(result.guides.Plane(Layer::kLpeLD12E)[i], full + 1e-5f);
  }
}

}  // namespace
}  // namespace scumble::testing
