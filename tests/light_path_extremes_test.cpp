// Light-path layers where light is hardest: mirrors, lamps that touch or swallow what they light, an eye inside a mesh,
// very many lamps, very weak and very strong ones. Nothing is clamped on the way, so nothing here is hidden by a clamp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/light_path_scenes.h"

namespace scumble::testing {
namespace {

// A floor with a matt, a smooth metal and a coated ball under one lamp of every kind with extent, a point lamp, a panel
// that emits, and a sky.
Scene Stage(float roughness) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.7f), 3.0);
  const auto ball = [&](Bsdf bsdf, double x) {
    Mesh mesh = BallMesh(20);
    mesh.material = AddMaterial(scene, Painted(bsdf, 0.8f, roughness));
    AddObject(scene, "ball" + std::to_string(int(bsdf)), mesh, glm::scale(Moved(x, 0, 0.7), glm::dvec3(0.7)));
  };
  ball(Bsdf::kDiffuse, -1.5);
  ball(Bsdf::kGlossy, 0.0);
  ball(Bsdf::kMetallicRoughness, 1.5);
  Material glow = Painted(Bsdf::kDiffuse, 0.2f);
  glow.emission = {3.0f, 2.0f, 1.0f};
  Mesh quad = QuadMesh();
  quad.material = AddMaterial(scene, glow);
  AddObject(scene, "glow", quad, glm::rotate(Moved(0, 2.8, 1), 0.5 * kPi, glm::dvec3(1, 0, 0)));
  Light panel = Above(LightType::kArea, 4.0, 3.0);
  Light bulb = PointLight({2, -2, 3}, 5.0);
  bulb.radius = 0.3;
  Light sun = Above(LightType::kSun, 0.0, 0.5);
  sun.angle_degrees = 5.0;
  scene.lights = {panel, bulb, sun, PointLight({-2, -2, 3}, 5.0)};
  scene.world_radiance = {0.1f, 0.1f, 0.2f};
  return scene;
}

const Camera kStageCamera = LookingAt({0, -6, 3}, {0, 0, 0.7});

void Scale(Scene& scene, double factor) {
  for (Light& light : scene.lights) light.intensity *= factor;
  for (Material& material : scene.materials) material.emission *= float(factor);
  scene.world_radiance *= float(factor);
}

TEST(Extremes, LayersScaleWithTheLight) {
  const LayerSet layers = LayerSet(kAllPaths).Add(Layer::kLuminance);
  const auto one = Render(Stage(0.2f), kStageCamera, Paths(16, layers, 16));
  for (const double factor : {1e-6, 1e6}) {
    Scene scene = Stage(0.2f);
    Scale(scene, factor);
    const auto scaled = Render(scene, kStageCamera, Paths(16, layers, 16));
    for (const LayerInfo& info : AllLayers()) {
      if (!layers.Has(info.layer)) continue;
      for (int c = 0; c < ChannelCount(info.layer); ++c) {
        const auto expected = one.guides.Plane(info.layer, c);
        const auto actual = scaled.guides.Plane(info.layer, c);
        for (std::size_t i = 0; i < expected.size(); ++i) {
          // Rounding to float, of the scene's values and of the layer's.
          ASSERT_NEAR(actual[i] / factor, expected[i], 2e-6 * expected[i]) << info.name << " " << factor;
        }
      }
    }
  }
}

// A firefly is a pixel in which one path outweighs all others. Noise of 64 samples is a few tenths of a pixel's value,
// so one that is three times as bright as anything about it in the converged picture, and a good deal brighter than the
// picture's mean on top of that, cannot be noise.
TEST(Extremes, SmoothSurfacesMakeNoFireflies) {
  constexpr int kSide = 32;
  const LayerSet layers = {Layer::kLpeFull, Layer::kLpeLSE, Layer::kLpeLDDE};
  for (const float roughness : {0.0f, 0.005f, 0.05f}) {
    const Scene scene = Stage(roughness);
    const auto noisy = Render(scene, kStageCamera, Paths(kSide, layers, 64));
    const auto converged = Render(scene, kStageCamera, Paths(kSide, layers, 1024));
    ExpectFinite(noisy);
    for (const Layer layer : {Layer::kLpeFull, Layer::kLpeLSE, Layer::kLpeLDDE}) {
      const auto truth = converged.guides.Plane(layer, 1);
      const auto value = noisy.guides.Plane(layer, 1);
      const double slack = Mean(converged, layer);
      double worst = 0.0;
      for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
          float around = 0.0f;
          for (int v = std::max(y - 1, 0); v <= std::min(y + 1, kSide - 1); ++v) {
            for (int u = std::max(x - 1, 0); u <= std::min(x + 1, kSide - 1); ++u) {
              around = std::max(around, truth[std::size_t(v * kSide + u)]);
            }
          }
          worst = std::max(worst, value[std::size_t(y * kSide + x)] / (3.0 * around + slack));
        }
      }
      EXPECT_LE(worst, 1.0) << Info(layer).name << " at roughness " << roughness;
      RecordProperty(std::string(Info(layer).name) + "_" + std::to_string(roughness), std::to_string(worst));
    }
  }
}

TEST(Extremes, LampsInTheSurfaceItselfDoNotLightIt) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.8f), 2.0);
  for (const double angle : {0.0, kPi}) {  // the panel faces into the floor, and away from it
    Light panel = Above(LightType::kArea, 0.0, 5.0);
    panel.world_from_light = glm::rotate(panel.world_from_light, angle, glm::dvec3(1, 0, 0));
    scene.lights = {panel, PointLight({0, 0, 0}, 5.0), PointLight({0.31, -0.17, 0}, 5.0)};
    // From the side: the camera's own axes are then not the floor's, and rounding has its chance.
    const auto result = Render(scene, LookingAt({1, -3, 2}, {0, 0, 0}), Paths(32, kAllPaths, 16));
    ExpectFinite(result);
    // What a float's rounding lifts a floor point above the lamp's plane lets a sliver of light in, near the lamps
    // alone.
    EXPECT_LT(Mean(result, Layer::kLpeFull), 1e-3);
  }
}

TEST(Extremes, ALampThatSwallowsTheObjectIsNoBrighterThanItsOwnRadiance) {
  Scene scene = SceneOf(BallMesh(24));
  scene.materials[0] = Painted(Bsdf::kDiffuse, 0.8f);
  for (const double radius : {0.5, 1.0, 5.0}) {  // inside the ball, as large, around it and the camera
    for (const double offset : {0.0, 0.7}) {
      Light lamp = PointLight({offset, 0, 0}, 4.0);
      lamp.radius = radius;
      scene.lights = {lamp};
      const auto result = Render(scene, FrontCamera(4.0), Paths(32, kAllPaths, 32));
      ExpectFinite(result);
      // The lamp is a disc that turns to the point it lights. A sky of its radiance is the most there can be; half a
      // percent is chance, because a direction and a point of the lamp are not drawn together.
      const double most = 0.8 * 4.0 / (kPi * radius * radius);
      for (const float value : result.guides.Plane(Layer::kLpeLDE)) EXPECT_LE(value, 1.005 * most) << radius;
    }
  }
}

TEST(Extremes, AnEyeInsideAMeshSeesWhatIsInside) {
  Scene scene = SceneOf(CubeMesh());
  scene.materials[0] = Painted(Bsdf::kDiffuse, 0.5f);
  const Camera inside = LookingAt({0.3, -0.2, 0.6}, {-1, 1, -1}, 90.0);
  // Closed: nothing that shines outside gets in.
  scene.lights = {PointLight({0, 0, 3}, 100.0), Above(LightType::kSun, 0.0, 10.0)};
  scene.world_radiance = glm::vec3(1.0f);
  const auto dark = Render(scene, inside, Paths(24, kAllPaths, 16));
  for (const float value : dark.guides.Plane(Layer::kLpeFull)) EXPECT_EQ(value, 0.0f);
  // A lamp inside, and a surface that touches the eye.
  scene.lights = {PointLight({0, 0, 0}, 1.0)};
  scene.world_radiance = glm::vec3(0.0f);
  const auto lit = Render(scene, inside, Paths(24, kAllPaths, 16));
  ExpectFinite(lit);
  for (const float value : lit.guides.Plane(Layer::kLpeLDE)) EXPECT_GT(value, 0.0f);
  const auto touching = Render(scene, LookingAt({0, 0, 1}, {0, 0, 0}), Paths(8, kAllPaths, 16));
  ExpectFinite(touching);
}

TEST(Extremes, OneOfFiveHundredLampsBringsWhatAllBring) {
  // Light from the floor on the wall and back: one lamp is chosen there. A quarter of the lamps is near, the others are
  // far.
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.8f), 2.0);
  AddObject(scene, "wall", QuadMesh(), glm::rotate(Moved(0, 1, 1), 0.5 * kPi, glm::dvec3(1, 0, 0)));
  for (int i = 0; i < 500; ++i) {
    const double far = i % 4 == 0 ? 0.5 : 20.0;
    scene.lights.push_back(PointLight({std::cos(i) * far, std::sin(i) * far, 1.5 + 0.001 * i}, 0.01 * far * far));
  }
  const Camera camera = LookingAt({0, -4, 2}, {0, 0.5, 0.5});
  const LayerSet layers = {Layer::kLpeLDDE};
  const auto all = Render(scene, camera, Paths(12, layers, 256));
  ExpectFinite(all);
  // The sum over lamps that are alone, ten at a time, weighed one by one.
  double sum = 0.0;
  for (int i = 0; i < 500; i += 10) {
    Scene few = scene;
    few.lights.assign(scene.lights.begin() + i, scene.lights.begin() + i + 10);
    sum += Mean(Render(few, camera, Paths(12, layers, 64)), Layer::kLpeLDDE);
  }
  EXPECT_NEAR(Mean(all, Layer::kLpeLDDE) / sum, 1.0, 0.02);
}

double Sum(const GuidegenResult& result, Layer layer) {
  double sum = 0.0;
  for (const float value : result.guides.Plane(layer)) sum += value;
  return sum;
}

// Few lights with extent are each sampled on the first surface, of many one is chosen: both must bring the same.
TEST(Extremes, ManySoftLampsBringWhatFewOfThemBringTogether) {
  Scene scene = Floor(Painted(Bsdf::kMetallicRoughness, 0.8f, 0.4f), 2.0);
  Mesh ball = BallMesh(16);
  AddObject(scene, "ball", ball, glm::scale(Moved(0, 0, 0.5), glm::dvec3(0.5)));
  for (int i = 0; i < 24; ++i) {
    Light lamp = PointLight({1.5 * std::cos(i), 1.5 * std::sin(i), 1.0 + 0.1 * i}, 1.0);
    lamp.type = LightType(i % 4);
    lamp.radius = 0.1 + 0.05 * (i % 5);
    lamp.angle_degrees = 4.0 + i;
    lamp.size_x = 0.2 + 0.1 * (i % 7);
    scene.lights.push_back(lamp);
  }
  const std::vector<Layer> layers = {Layer::kLpeLDE, Layer::kLpeLSE, Layer::kLuminance};
  const LayerSet asked = {Layer::kLpeLDE, Layer::kLpeLSE, Layer::kLuminance};
  const Camera camera = LookingAt({0, -4, 3}, {0, 0, 0.2});
  const auto many = Render(scene, camera, Paths(12, asked, 1024));
  std::vector<double> sums(layers.size(), 0.0);
  for (std::size_t begin = 0; begin < scene.lights.size(); begin += 6) {
    Scene part = scene;
    part.lights.assign(scene.lights.begin() + std::ptrdiff_t(begin), scene.lights.begin() + std::ptrdiff_t(begin) + 6);
    const auto few = Render(part, camera, Paths(12, asked, 256));
    for (std::size_t i = 0; i < layers.size(); ++i) sums[i] += Sum(few, layers[i]);
  }
  for (std::size_t i = 0; i < layers.size(); ++i) {
    EXPECT_NEAR(Sum(many, layers[i]) / sums[i], 1.0, 5e-3) << Info(layers[i]).name;
  }
}

}  // namespace
}  // namespace scumble::testing
