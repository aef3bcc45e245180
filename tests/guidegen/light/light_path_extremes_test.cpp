// Light-path layers where light is hardest: mirrors, lights that touch or swallow what they light, an eye inside a
// mesh, very many lights, very weak and very strong ones. Nothing is clamped on the way, so nothing here is hidden by a
// clamp. Tolerances are roundings (2^-24 for a float), or five standard errors of noise: of noise whose variance is
// bounded by what the estimator is, or is measured in the test itself, by renders that differ in nothing but their
// seed. Seeds are fixed, so where a false alarm's probability is said, it was drawn when the test was written, not at
// each run.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/exact_rays.h"
#include "tests/support/light_path_scenes.h"
#include "tests/support/numbers.h"

namespace scumble::testing {
namespace {

constexpr double kErrors = 5.0;  // standard errors: a normal deviate is farther off once in 1.7 million

// A floor with a matt, a smooth metal and a coated sphere under one light of every kind with extent, a point light, a
// panel that emits, and a sky. What shines is told by floats of few bits, so that Scale can multiply it without a
// rounding.
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
  scene.world_radiance = {0.125f, 0.125f, 0.25f};
  return scene;
}

const Camera kStageCamera = LookingAt({0, -6, 3}, {0, 0, 0.7});

void Scale(Scene& scene, double factor) {
  for (Light& light : scene.lights) light.intensity *= factor;
  for (Material& material : scene.materials) material.emission *= float(factor);
  scene.world_radiance *= float(factor);
}

// Factors that are no powers of two round every sum on the way, but in double; both are 15625 times a power of two,
// which takes 14 bits, so what shines is multiplied exactly. A layer is then off by two roundings to float, its own in
// either picture (of the smallest floats half of 2^-149), and by what double leaves. That is 2^-53 a step; it also
// moves the border between two lights of which one is chosen, and so the point drawn on a light, by 2^-50 over the
// choice's probability, which is above 1e-3 here, and what a lobe of α = 0.04 reflects by 1/α² times that: less than
// 2^-30. A choice itself falls out otherwise where a number of 2^-32 lies that near a border: 65,000 choices of five
// lights, less than once in a million sets of random numbers.
TEST(Extremes, LayersScaleWithTheLight) {
  const LayerSet layers = LayerSet(kAllPaths).Add(Layer::kLuminance);
  const auto one = Render(Stage(0.2f), kStageCamera, Paths(16, layers, 16));
  for (const double factor : {std::ldexp(15625.0, -34), 1e6}) {
    Scene scene = Stage(0.2f);
    Scale(scene, factor);
    const auto scaled = Render(scene, kStageCamera, Paths(16, layers, 16));
    for (const LayerInfo& info : AllLayers()) {
      if (!layers.Has(info.layer)) continue;
      for (int c = 0; c < ChannelCount(info.layer); ++c) {
        const auto expected = one.guides.Plane(info.layer, c);
        const auto actual = scaled.guides.Plane(info.layer, c);
        for (std::size_t i = 0; i < expected.size(); ++i) {
          const double smallest = 0x1.0p-150 * (1.0 + 1.0 / factor);
          const double tolerance = (2.0 * kFloatRounding + 0x1.0p-30) * expected[i] + smallest;
          ASSERT_NEAR(actual[i] / factor, expected[i], tolerance) << info.name << " " << factor << " pixel " << i;
        }
      }
    }
  }
}

// Of each pixel the mean and the standard deviation of its values in renders with the seeds 1 … kSeeds.
constexpr int kSeeds = 16;
struct Spread {
  std::vector<double> mean, deviation;
};
std::vector<Spread> SpreadOf(const Scene& scene, GuidegenOptions options, const std::vector<Layer>& layers) {
  const std::size_t pixels = std::size_t(options.width) * std::size_t(options.height);
  std::vector<Spread> spread(layers.size(), {std::vector<double>(pixels), std::vector<double>(pixels)});
  for (options.seed = 1; options.seed <= kSeeds; ++options.seed) {
    const auto result = Render(scene, kStageCamera, options);
    for (std::size_t l = 0; l < layers.size(); ++l) {
      const auto values = result.guides.Plane(layers[l], 1);
      for (std::size_t i = 0; i < pixels; ++i) {  // Welford's sums, which lose nothing where all values are alike
        const double off = values[i] - spread[l].mean[i];
        spread[l].mean[i] += off / double(options.seed);
        spread[l].deviation[i] += off * (values[i] - spread[l].mean[i]);
      }
    }
  }
  for (Spread& one : spread) {
    for (double& square : one.deviation) square = std::sqrt(square / (kSeeds - 1));
  }
  return spread;
}

// A firefly is a pixel in which one path outweighs all others together, brighter than all about it, and by more than
// the picture's mean, or nobody would see it. Without one, a pixel is at most twice what its other paths bring. They
// bring what the converged picture has in the pixel or beside it, and noise, five standard deviations of it at most:
// sixteen pictures with other seeds tell them, and the largest of nine pixels' is no underestimate. Without its largest
// path a mean of 64 has no long tail; of normal ones, one of the 9,216 that are looked at would be beyond in one of 380
// sets of seeds.
TEST(Extremes, SmoothSurfacesMakeNoFireflies) {
  constexpr int kSide = 32;
  const std::vector<Layer> layers = {Layer::kLpeFull, Layer::kLpeLSE, Layer::kLpeLDDE};
  for (const float roughness : {0.0f, 0.005f, 0.05f}) {
    const Scene scene = Stage(roughness);
    const GuidegenOptions options = Paths(kSide, {Layer::kLpeFull, Layer::kLpeLSE, Layer::kLpeLDDE}, 64);
    const auto noisy = Render(scene, kStageCamera, options);
    ExpectFinite(noisy);
    const std::vector<Spread> truth = SpreadOf(scene, options, layers);
    for (std::size_t l = 0; l < layers.size(); ++l) {
      const auto value = noisy.guides.Plane(layers[l], 1);
      const double visible = Mean(noisy, layers[l]);
      double worst = 0.0;
      for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
          double others = 0.0;
          for (int v = std::max(y - 1, 0); v <= std::min(y + 1, kSide - 1); ++v) {
            for (int u = std::max(x - 1, 0); u <= std::min(x + 1, kSide - 1); ++u) {
              const auto i = std::size_t(v * kSide + u);
              others = std::max(others, truth[l].mean[i] + kErrors * truth[l].deviation[i]);
            }
          }
          worst = std::max(worst, value[std::size_t(y * kSide + x)] / (2.0 * others + visible));
        }
      }
      EXPECT_LE(worst, 1.0) << Info(layers[l]).name << " at roughness " << roughness;
      std::printf("fireflies, %s, roughness %.3f: %.2f of the limit\n", Info(layers[l]).name, double(roughness), worst);
    }
  }
}

// A light in the floor's own plane is off it by what the place is known to, δ = 2^-49 of the largest coordinate, which
// is below 8 m: it brings its light times the cosine δ / d. Of a panel of 1 m² the cosine is as small at either end of
// the way, so a point d away brings its radiance times δ² / d⁴. That one of the 32,768 points drawn on both panels lies
// within 1e-5 m of the place that it lights has a probability of 1e-5. Directions leave the floor from above the
// lights, and meet none.
TEST(Extremes, LampsInTheSurfaceItselfDoNotLightIt) {
  constexpr int kSide = 32;
  constexpr double kAlbedo = 0.8, kStrength = 5.0, kNearest = 1e-5;
  const double off = std::ldexp(8.0, -49);
  const double panels = kAlbedo / kPi * kStrength * std::pow(off / (kNearest * kNearest), 2.0);  // 2.6e-8
  Scene scene = Floor(Painted(Bsdf::kDiffuse, float(kAlbedo)), 2.0);
  // From the side: the camera's own axes are then not the floor's, and rounding has its chance.
  const Camera camera = LookingAt({1, -3, 2}, {0, 0, 0});
  const glm::dvec3 eye(camera.world_from_camera[3]);
  const std::array<glm::dvec3, 2> lamps = {glm::dvec3(0, 0, 0), glm::dvec3(0.31, -0.17, 0)};
  for (const double angle : {0.0, kPi}) {  // the panel faces into the floor, and away from it
    Light panel = Above(LightType::kArea, 0.0, kStrength);
    panel.world_from_light = glm::rotate(panel.world_from_light, angle, glm::dvec3(1, 0, 0));
    scene.lights = {panel, PointLight(lamps[0], kStrength), PointLight(lamps[1], kStrength)};
    const auto result = Render(scene, camera, Paths(kSide, kAllPaths, 16));
    ExpectFinite(result);
    double brightest = 0.0;
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const std::size_t i = result.guides.Index(x, y);
        if (result.guides.Plane(Layer::kCoverage)[i] == 0.0f) continue;
        const ExactRay ray = PixelRay(camera, kSide, kSide, x, y);
        const glm::dvec3 place = eye + ray.direction * (-eye.z / ray.direction.z);
        double most = panels;
        for (const glm::dvec3& lamp : lamps) {
          most += kAlbedo / kPi * kStrength * off / std::pow(glm::length(lamp - place), 3.0);
        }
        const double value = result.guides.Plane(Layer::kLpeFull, 1)[i];
        EXPECT_LE(value, most * (1.0 + 4.0 * kFloatRounding)) << "pixel " << x << ", " << y << " angle " << angle;
        brightest = std::max(brightest, value);
      }
    }
    std::printf("lamps in the floor, panel at %.2f rad: brightest pixel %.3g\n", angle, brightest);
  }
}

// The light is a disc that turns to the point it lights, and its middle is inside the sphere, below the horizon of all
// that the sphere has outside. So at most half of the sky is the disc: a share F ≤ ½ of what a sky of the light's
// radiance would bring, M. A sample is a point of the disc and a direction, weighed by the balance heuristic: α M and β
// M in the mean, α + β = F. The sum of both squares is β M² in the mean (w = p_b / (p_l + p_b): ∫ w² (p_l + p_b) = ∫ w
// p_b), so the variance is (β - α² - β²) M², which for F ≤ ½ is never more than F (1 - F) M² ≤ ¼ M². Numbers of a net
// in base 2 may double it (Owen 1997). Of 64 samples five standard errors are then 0.44 M, so no value is above 0.94 M.
TEST(Extremes, ALampThatSwallowsTheObjectIsNoBrighterThanItsOwnRadiance) {
  constexpr int kSamples = 64;
  Scene scene = SceneOf(BallMesh(24));
  scene.materials[0] = Painted(Bsdf::kDiffuse, 0.8f);
  for (const double radius : {0.5, 1.0, 5.0}) {  // inside the sphere, as large, around it and the camera
    for (const double offset : {0.0, 0.7}) {
      Light lamp = PointLight({offset, 0, 0}, 4.0);
      lamp.radius = radius;
      scene.lights = {lamp};
      const auto result = Render(scene, FrontCamera(4.0), Paths(24, kAllPaths, kSamples));
      ExpectFinite(result);
      const double most = 0.8 * 4.0 / (kPi * radius * radius);
      const double share = 0.5 + kErrors * std::sqrt(2.0 * 0.25 / kSamples);
      float brightest = 0.0f;
      for (const float value : result.guides.Plane(Layer::kLpeLDE)) {
        EXPECT_LE(value, share * most) << radius;
        brightest = std::max(brightest, value);
      }
      // About a middle that is the sphere's own the disc lies below every horizon; beside it a wide one rises above
      // some.
      if (offset == 0.0) {
        EXPECT_EQ(brightest, 0.0f) << radius;
      } else if (radius == 5.0) {
        EXPECT_GT(brightest, 0.0f);
      }
      std::printf("a lamp of %.1f m, %.1f m beside the middle: at most %.3f of a sky's light\n", radius, offset,
                  double(brightest) / most);
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
  // A light inside, and a surface that touches the eye.
  scene.lights = {PointLight({0, 0, 0}, 1.0)};
  scene.world_radiance = glm::vec3(0.0f);
  const auto lit = Render(scene, inside, Paths(24, kAllPaths, 16));
  ExpectFinite(lit);
  for (const float value : lit.guides.Plane(Layer::kLpeLDE)) EXPECT_GT(value, 0.0f);
  const auto touching = Render(scene, LookingAt({0, 0, 1}, {0, 0, 0}), Paths(8, kAllPaths, 16));
  ExpectFinite(touching);
}

// What scenes bring to the layers of a picture, summed over them and over its pixels, and how sure that is: each scene
// is rendered with two seeds of its own. Pixels draw independently of each other, so of each the mean of both renders
// is off by half of their difference, root mean square, and the squares of all add up. Of 144 pixels that is told well
// enough for five such errors to be passed less than once in 100,000 sets of seeds (Student's t with fifty degrees of
// freedom; pixels are not all alike).
class LightSum {
 public:
  LightSum(std::vector<Layer> layers, std::uint64_t first_seed) : layers_(std::move(layers)), seed_(first_seed) {}

  // `samples` in all.
  void Add(const Scene& scene, const Camera& camera, int samples) {
    LayerSet asked;
    for (const Layer layer : layers_) asked.Add(layer);
    GuidegenOptions options = Paths(kSide, asked, samples / 2);
    for (std::vector<double>& half : halves_) {
      options.seed = seed_++;
      const auto result = Render(scene, camera, options);
      ExpectFinite(result);
      half.resize(layers_.size() * kPixels);
      for (std::size_t l = 0; l < layers_.size(); ++l) {
        const auto values = result.guides.Plane(layers_[l]);
        for (std::size_t i = 0; i < kPixels; ++i) half[l * kPixels + i] += values[i];
      }
    }
  }

  double Sum(std::size_t layer) const {
    double sum = 0.0;
    for (std::size_t i = layer * kPixels; i < (layer + 1) * kPixels; ++i) sum += 0.5 * (halves_[0][i] + halves_[1][i]);
    return sum;
  }
  double Variance(std::size_t layer) const {
    double squares = 0.0;
    for (std::size_t i = layer * kPixels; i < (layer + 1) * kPixels; ++i) {
      squares += 0.25 * (halves_[0][i] - halves_[1][i]) * (halves_[0][i] - halves_[1][i]);
    }
    return squares;
  }

 private:
  static constexpr int kSide = 12;
  static constexpr std::size_t kPixels = kSide * kSide;
  std::vector<Layer> layers_;
  std::uint64_t seed_;
  std::array<std::vector<double>, 2> halves_;  // pixel by pixel, layer after layer
};

// Sums that must be the same but for their noise; and they can tell, which a tenth of the light missing would show.
void ExpectAlike(const LightSum& all, const LightSum& parts, const std::vector<Layer>& layers) {
  for (std::size_t l = 0; l < layers.size(); ++l) {
    const double tolerance = kErrors * std::sqrt(all.Variance(l) + parts.Variance(l));
    EXPECT_NEAR(all.Sum(l), parts.Sum(l), tolerance) << Info(layers[l]).name;
    EXPECT_LT(tolerance, 0.1 * parts.Sum(l)) << Info(layers[l]).name;
    std::printf("many lamps and few, %s: %+.3f %% off, %.3f %% allowed\n", Info(layers[l]).name,
                100.0 * (all.Sum(l) / parts.Sum(l) - 1.0), 100.0 * tolerance / parts.Sum(l));
  }
}

TEST(Extremes, OneOfFiveHundredLampsBringsWhatAllBring) {
  // Light from the floor on the wall and back: one light is chosen there. A quarter of the lights is near, the others
  // are far.
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.8f), 2.0);
  AddObject(scene, "wall", QuadMesh(), glm::rotate(Moved(0, 1, 1), 0.5 * kPi, glm::dvec3(1, 0, 0)));
  for (int i = 0; i < 500; ++i) {
    const double far = i % 4 == 0 ? 0.5 : 20.0;
    scene.lights.push_back(PointLight({std::cos(i) * far, std::sin(i) * far, 1.5 + 0.001 * i}, 0.01 * far * far));
  }
  const Camera camera = LookingAt({0, -4, 2}, {0, 0.5, 0.5});
  const std::vector<Layer> layers = {Layer::kLpeLDDE};
  LightSum all(layers, 0), parts(layers, 1000);
  all.Add(scene, camera, 256);
  // The sum over lights that are alone, ten at a time, weighed one by one.
  for (int i = 0; i < 500; i += 10) {
    Scene few = scene;
    few.lights.assign(scene.lights.begin() + i, scene.lights.begin() + i + 10);
    parts.Add(few, camera, 64);
  }
  ExpectAlike(all, parts, layers);
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
  const Camera camera = LookingAt({0, -4, 3}, {0, 0, 0.2});
  LightSum many(layers, 0), few(layers, 1000);
  many.Add(scene, camera, 1024);
  for (std::size_t begin = 0; begin < scene.lights.size(); begin += 6) {
    Scene part = scene;
    part.lights.assign(scene.lights.begin() + std::ptrdiff_t(begin), scene.lights.begin() + std::ptrdiff_t(begin) + 6);
    few.Add(part, camera, 256);
  }
  ExpectAlike(many, few, layers);
}

}  // namespace
}  // namespace scumble::testing
