// Light at its extremes: the ray caster's light layers against closed formulas. Every case states the expected value
// and its reason; tolerances are roundings (2^-24 for a float) or five standard deviations of a sum whose variance is
// known.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/image/stopwatch.h"
#include "guidegen/light/direct_light.h"
#include "tests/support/exact_rays.h"
#include "tests/support/light_path_scenes.h"
#include "tests/support/numbers.h"

namespace scumble::testing {
namespace {

LayerSet AllLight() { return LayerSet(kAllPaths).Add(Layer::kLuminance).Add(Layer::kShadow); }

// A floor and a coated sphere under a light of every kind, with extent and without, a mesh that emits, and a sky.
Scene EveryLight(double factor) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.7f), 3.0);
  Mesh ball = BallMesh(16);
  ball.material = AddMaterial(scene, Painted(Bsdf::kMetallicRoughness, 0.8f, 0.4f));
  AddObject(scene, "ball", ball, Moved(-0.5, 0, 1));
  Material glow = Painted(Bsdf::kDiffuse, 0.2f);
  glow.emission = glm::vec3(3.0f, 2.0f, 1.0f) * float(factor);
  Mesh panel = QuadMesh();
  panel.material = AddMaterial(scene, glow);
  AddObject(scene, "glow", panel, glm::rotate(Moved(0, 2.8, 1), 0.5 * kPi, glm::dvec3(1, 0, 0)));
  for (int i = 0; i < 8; ++i) {
    Light light = PointLight({1.5 * std::cos(i), 1.5 * std::sin(i), 2.5 + 0.2 * i}, 3.0 * factor);
    light.type = LightType(i % 4);
    light.radius = i < 4 ? 0.0 : 0.3;
    light.angle_degrees = i < 4 ? 0.0 : 5.0;
    scene.lights.push_back(light);
  }
  scene.world_radiance = glm::vec3(0.1f, 0.1f, 0.2f) * float(factor);
  return scene;
}

const Camera kStageCamera = LookingAt({0, -6, 3}, {0, 0, 0.7});

// A product with a power of two rounds nothing, and whatever chance decides is decided by ratios: every layer's bits
// are the same, the exponents apart. 2^-40 … 2^40 is 9.1e-13 … 1.1e12.
TEST(ExtremeIntensity, PowersOfTwoScaleEveryBit) {
  const auto one = Render(EveryLight(1.0), kStageCamera, Paths(16, AllLight(), 8));
  for (const int power : {-40, -20, -1, 20, 40}) {
    const auto scaled = Render(EveryLight(std::ldexp(1.0, power)), kStageCamera, Paths(16, AllLight(), 8));
    for (const LayerInfo& info : AllLayers()) {
      if (!AllLight().Has(info.layer)) continue;
      for (int c = 0; c < ChannelCount(info.layer); ++c) {
        const auto expected = one.guides.Plane(info.layer, c);
        const auto actual = scaled.guides.Plane(info.layer, c);
        for (std::size_t i = 0; i < expected.size(); ++i) {
          const float factor = info.layer == Layer::kShadow ? 1.0f : std::ldexp(1.0f, power);
          ASSERT_EQ(actual[i], expected[i] * factor) << info.name << " 2^" << power << " pixel " << i;
        }
      }
    }
  }
}

// E = I cosθ / d², in double; the layer rounds once. What double leaves is below 2^-48.
TEST(ExtremeIntensity, EveryDecadeFollowsTheFormula) {
  const Camera camera = LookingAt({0, -3, 3}, {0, 0, 0});
  for (int decade = -12; decade <= 12; ++decade) {
    const double intensity = std::pow(10.0, decade);
    Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.7f), 3.0);
    scene.lights = {PointLight({0.2, 0.1, 1.5}, intensity)};
    const auto result = Render(scene, camera, Sized(9, 9, AllLight()));
    for (int y = 0; y < 9; ++y) {
      for (int x = 0; x < 9; ++x) {
        const ExactRay ray = PixelRay(camera, 9, 9, x, y);
        const glm::dvec3 eye(camera.world_from_camera[3]);
        const glm::dvec3 place = eye + ray.direction * (-eye.z / ray.direction.z);
        const glm::dvec3 way = glm::dvec3(0.2, 0.1, 1.5) - place;
        const double expected = intensity * way.z / (kPi * std::pow(glm::length(way), 3.0));
        const std::size_t i = result.guides.Index(x, y);
        EXPECT_NEAR(result.guides.Plane(Layer::kLuminance)[i], expected, (kFloatRounding + 0x1.0p-48) * expected);
        // The floor's colour is a float.
        EXPECT_NEAR(result.guides.Plane(Layer::kLpeLDE, 1)[i], double(0.7f) * expected,
                    (kFloatRounding + 0x1.0p-46) * expected);
        EXPECT_EQ(result.guides.Plane(Layer::kShadow)[i], 0.0f);
      }
    }
  }
}

TEST(ExtremeIntensity, NothingShinesWithNone) {
  const auto dark = Render(EveryLight(0.0), kStageCamera, Paths(16, AllLight(), 8));
  for (const LayerInfo& info : AllLayers()) {
    if (!AllLight().Has(info.layer)) continue;
    for (int c = 0; c < ChannelCount(info.layer); ++c) {
      for (const float value : dark.guides.Plane(info.layer, c)) EXPECT_EQ(value, 0.0f) << info.name;
    }
  }
  EXPECT_EQ(dark.rays.shadow, 0u);  // and nothing is paid for it
}

// A light from a metre above the floor down to it and below. Above float's sight it lights all of the floor by the
// formula. Below that, whether anything lies between is rounding: a pixel has the formula's light, or none. In the
// floor or under it there is none: what the side of the plane is told by leaves a few 2^-52 of the distance.
TEST(LampOnASurface, LightsByTheFormulaOrNotAtAll) {
  const Camera camera = LookingAt({1, -3, 2}, {0, 0, 0});
  const glm::dvec3 eye(camera.world_from_camera[3]);
  const double sight = 8.0 * kFloatSight;  // the largest coordinate is below 8 m
  for (const double height : {1.0, 1e-1, 1e-2, 1e-3, 1e-4, 2e-5, 1e-6, 1e-9, 1e-12, 0.0, -1e-12, -1e-6, -1e-1}) {
    Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.8f), 2.0);
    scene.lights = {PointLight({0.31, -0.17, height}, 5.0)};
    const auto result = Render(scene, camera, Sized(32, 32, AllLight()));
    ExpectFinite(result);
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 32; ++x) {
        const std::size_t i = result.guides.Index(x, y);
        if (result.guides.Plane(Layer::kCoverage)[i] == 0.0f) continue;
        const ExactRay ray = PixelRay(camera, 32, 32, x, y);
        const glm::dvec3 way = glm::dvec3(0.31, -0.17, height) - (eye + ray.direction * (-eye.z / ray.direction.z));
        const double strength = 5.0 / (kPi * std::pow(glm::length(way), 3.0));
        const double expected = strength * std::max(height, 0.0);
        const double tolerance = kFloatRounding * expected + strength * std::ldexp(8.0, -49);
        const double luminance = result.guides.Plane(Layer::kLuminance)[i];
        if (height >= sight || luminance != 0.0) {
          EXPECT_NEAR(luminance, expected, tolerance) << height;
        }
        if (height >= sight) {
          EXPECT_EQ(result.guides.Plane(Layer::kShadow)[i], 0.0f) << height;
        }
      }
    }
  }
}

// A light as far away as doubles and floats reach, as bright as its distance's square: on a floor that faces it, 1/π,
// rounded once; and a lid over the floor hides it. No ray is longer than Embree takes.
TEST(FarOut, LampsLightByTheFormula) {
  for (const double distance : {1e10, 1e17, 1.8e18, 2e18, 1e20, 1e37, 1e100, 1e150}) {
    for (const bool lid : {false, true}) {
      Scene scene = Floor(Painted(Bsdf::kDiffuse, 1.0f), 2.0);
      if (lid) AddObject(scene, "lid", QuadMesh(), glm::scale(Moved(0, 0, 2), glm::dvec3(4.0)));
      scene.lights = {PointLight({0, 0, distance}, distance * distance)};
      const auto result = Render(scene, LookingAt({0, 0, 1}, {0, 0, 0}, 30.0), Sized(8, 8, AllLight()));
      const double expected = lid ? 0.0 : 1.0 / kPi;
      for (std::size_t i = 0; i < result.guides.pixel_count(); ++i) {
        EXPECT_NEAR(result.guides.Plane(Layer::kLuminance)[i], expected, kFloatRounding * expected + 0x1p-49)
            << distance;
        EXPECT_NEAR(result.guides.Plane(Layer::kLpeLDE, 1)[i], expected, kFloatRounding * expected + 0x1p-49)
            << distance;
        EXPECT_EQ(result.guides.Plane(Layer::kShadow)[i], lid ? 1.0f : 0.0f) << distance;
      }
    }
  }
}

// Surfaces, cameras and lights with extent out there: whatever comes out, the process lives and every value is finite.
TEST(FarOut, WhateverStandsThereIsSurvived) {
  for (const double distance : {1e17, 1.5e18, 1.84e18, 2e18, 1e30, 1e150}) {
    Scene scene = Floor(Painted(Bsdf::kGlossy, 0.9f, 0.5f), 2.0);
    Material glow = Painted(Bsdf::kDiffuse, 0.5f);
    glow.emission = glm::vec3(2.0f);
    Mesh panel = QuadMesh();
    panel.material = AddMaterial(scene, glow);
    AddObject(scene, "far", panel, glm::scale(Moved(0, 0, distance), glm::dvec3(distance)));
    AddObject(scene, "wide", panel, glm::scale(Moved(0, 0, -1), glm::dvec3(distance)));
    for (int i = 0; i < 8; ++i) {
      Light light = Above(LightType(i % 4), distance, 3.0);
      light.radius = i < 4 ? 0.0 : 0.1 * distance;
      light.size_x = light.size_y = 0.2 * distance;
      scene.lights.push_back(light);
    }
    scene.world_radiance = glm::vec3(0.5f);
    for (const double from : {2.0, 0.5 * distance}) {
      ExpectFinite(Render(scene, LookingAt({0, 0, from}, {0, 0, 0}, 60.0), Paths(8, AllLight(), 4)));
    }
  }
}

enum class LightKind { kPoint, kArea, kPanel };

// A light, with and without extent, or a panel that shines, behind a lid of a room or before it, by 2^-19 of the
// largest coordinate before the eye: the ray ends 2^-20 of it before the light, and the lid is no farther off than that
// again. Behind, none of it comes in, at any scale, place and turn of the room. Before, the lid hides nothing.
TEST(LampBesideALid, IsHiddenBehindItAndNotBeforeIt) {
  constexpr double kWidth = 3.0;  // of the lid, in heights of the room
  for (int turn = 0; turn < 52; ++turn) {
    const double scale = std::pow(10.0, turn % 13 - 6), place = turn % 4 == 3 ? 1e3 : turn % 4;
    const glm::dvec3 axis = glm::normalize(glm::dvec3(std::cos(turn), std::sin(2.0 * turn), 0.3));
    const glm::dmat4 room = glm::scale(
        glm::rotate(glm::translate(glm::dmat4(1.0), glm::dvec3(place, -place, 0.5 * place)), 0.7 * turn, axis),
        glm::dvec3(scale));
    const auto at = [&](const glm::dvec3& local) { return glm::dvec3(room * glm::dvec4(local, 1.0)); };
    // From halfway up, the lid's corners are the farthest, less than √2 of its half width and a half away.
    const double gap = 0x1p-19 * std::sqrt(2.0 * kWidth * kWidth + 0.25);
    for (const double side : {1.0, -1.0}) {
      for (const LightKind kind : {LightKind::kPoint, LightKind::kArea, LightKind::kPanel}) {
        Scene scene = SceneOf(QuadMesh(), room);
        AddObject(scene, "lid", QuadMesh(), room * glm::scale(Moved(0, 0, 1), glm::dvec3(kWidth)));
        const glm::dmat4 stand = room * Moved(0, 0, 1.0 + side * gap);
        if (kind == LightKind::kPanel) {
          Material glow = Painted(Bsdf::kDiffuse, 0.5f);
          glow.emission = glm::vec3(1.0f);
          Mesh panel = QuadMesh();
          panel.material = AddMaterial(scene, glow);
          AddObject(scene, "panel", panel, stand * glm::scale(glm::dmat4(1.0), glm::dvec3(0.5)));
        } else {
          const bool wide = kind == LightKind::kArea;
          Light lamp = Above(wide ? LightType::kArea : LightType::kPoint, 0.0, wide ? 1.0 : scale * scale);
          lamp.world_from_light = stand;
          lamp.size_x = lamp.size_y = scale;
          scene.lights = {lamp};
        }
        const Camera camera = LookingAt(at({0.1, 0.1, 0.5}), at({0, 0, 0}), 40.0);
        const auto result = Render(scene, camera, Paths(8, {Layer::kLuminance, Layer::kShadow, Layer::kLpeLDE}, 16));
        for (std::size_t i = 0; i < result.guides.pixel_count(); ++i) {
          SCOPED_TRACE("turn " + std::to_string(turn) + ", kind " + std::to_string(int(kind)));
          if (side > 0.0) {
            EXPECT_EQ(result.guides.Plane(Layer::kLuminance)[i], 0.0f);
            EXPECT_EQ(result.guides.Plane(Layer::kLpeLDE, 1)[i], 0.0f);
            EXPECT_EQ(result.guides.Plane(Layer::kShadow)[i], 1.0f);
          } else {
            EXPECT_GT(result.guides.Plane(Layer::kLuminance)[i], 0.0f);
            EXPECT_GT(result.guides.Plane(Layer::kLpeLDE, 1)[i], 0.0f);
            EXPECT_EQ(result.guides.Plane(Layer::kShadow)[i], 0.0f);
          }
        }
      }
    }
  }
}

// Lights of each kind inside a closed box over a floor: all of their light stays inside, so the floor has none of it
// and `shadow` is 1 wherever a light would shine; and the box's outside is turned away from them.
TEST(LampInsideAnObject, NoneOfItsLightComesOut) {
  for (const LightType type : {LightType::kPoint, LightType::kSpot, LightType::kArea}) {
    for (const double radius : {0.0, 0.3}) {
      for (const double scale : {1e-3, 1.0, 1e3}) {
        Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.8f), 4.0);
        scene.instances[0].world_from_object = glm::scale(glm::dmat4(1.0), glm::dvec3(4.0 * scale));
        AddObject(scene, "box", CubeMesh(), glm::scale(Moved(0, 0, 1.5 * scale), glm::dvec3(scale)));
        Light lamp = Above(type, 1.2 * scale, scale * scale);
        lamp.radius = radius * scale;
        lamp.size_x = lamp.size_y = 0.5 * scale;
        scene.lights = {lamp};
        const Camera camera = LookingAt(glm::dvec3(0, -6, 3) * scale, {0, 0, 0}, 60.0);
        const auto result = Render(scene, camera, Paths(24, AllLight(), 8));
        int shaded = 0;
        for (std::size_t i = 0; i < result.guides.pixel_count(); ++i) {
          EXPECT_EQ(result.guides.Plane(Layer::kLuminance)[i], 0.0f);
          EXPECT_EQ(result.guides.Plane(Layer::kLpeFull, 1)[i], 0.0f);
          const float shadow = result.guides.Plane(Layer::kShadow)[i];
          EXPECT_TRUE(shadow == 0.0f || shadow == 1.0f) << shadow;
          shaded += shadow == 1.0f;
        }
        EXPECT_GT(shaded, 10) << "the floor below";
      }
    }
  }
}

// The irradiance of a horizontal point by a polygon of radiance 1 above its horizon (Lambert 1760): half the sum, over
// the edges, of the angle they fill times the height of their plane's normal. 0 where the polygon turns its back.
double PolygonIrradiance(const std::array<glm::dvec3, 4>& corners) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const glm::dvec3 a = glm::normalize(corners[i]), b = glm::normalize(corners[(i + 1) % 4]);
    const glm::dvec3 normal = glm::cross(a, b);
    sum += std::atan2(glm::length(normal), glm::dot(a, b)) * normal.z / glm::length(normal);
  }
  return std::max(0.5 * std::abs(sum), 0.0);
}

double MeanLuminance(const GuidegenResult& result) {
  double sum = 0.0;
  for (const float value : result.guides.Plane(Layer::kLuminance)) sum += value;
  return sum / double(result.guides.pixel_count());
}

// A panel stands upright and faces +X; the point it lights moves into its plane and behind. Sampled by area, a panel at
// this distance varies by less than half of its mean from point to point, so the mean of 16 pixels × 256 samples is off
// by 5 × 0.5 / 64 at most.
TEST(AreaLight, EdgeOnItFadesByTheFormulaToNothing) {
  const Camera spot = LookingAt({0, -0.02, 5}, {0, 0, 0}, 1.1e-8);
  for (const double beside : {1.0, 1e-1, 1e-2, 1e-4, 1e-6, 0.0, -1e-6, -1e-1}) {
    Scene scene = Floor(Painted(Bsdf::kDiffuse, 1.0f), 1.0);
    Light panel = Above(LightType::kArea, 2.5, 1.0);
    panel.world_from_light = glm::rotate(Moved(-beside, 0, 2.5), -0.5 * kPi, glm::dvec3(0, 1, 0));
    scene.lights = {panel};
    const auto result = Render(scene, spot, Paths(4, {Layer::kLuminance, Layer::kLpeLDE}, 256));
    const std::array<glm::dvec3, 4> corners = {
        {{-beside, -0.5, 2.0}, {-beside, 0.5, 2.0}, {-beside, 0.5, 3.0}, {-beside, -0.5, 3.0}}};
    const double expected = beside > 0.0 ? PolygonIrradiance(corners) / kPi : 0.0;
    // So far from its middle are what the spot's pixels see, half of its width of 1e-9 m, at a slope of less than 0.1.
    const double slack = 5e-10 * 0.1;
    for (const Layer layer : {Layer::kLuminance, Layer::kLpeLDE}) {
      const double mean = layer == Layer::kLuminance ? MeanLuminance(result) : Mean(result, layer);
      EXPECT_NEAR(mean, expected, expected * 5.0 * 0.5 / 64.0 + slack) << beside;
      if (beside < 0.0) {
        EXPECT_EQ(mean, 0.0) << beside;
      }
    }
  }
}

// A sun of no width is one ray: E cosθ / π, rounded once. One of 1e-8 degrees is equal to it.
TEST(SunAngle, NoneIsOneRay) {
  for (const double degrees : {0.0, 1e-8}) {
    for (const double elevation : {90.0, 30.0, 1.0, 0.001}) {
      Scene scene = Floor(Painted(Bsdf::kDiffuse, 1.0f), 3.0);
      Light sun = Above(LightType::kSun, 0.0, 2.0);
      sun.world_from_light = glm::rotate(glm::dmat4(1.0), glm::radians(90.0 - elevation), glm::dvec3(1, 0, 0));
      sun.angle_degrees = degrees;
      scene.lights = {sun};
      const auto result = Render(scene, SlantedSpot(), Sized(4, 4, AllLight()));
      const double expected = 2.0 * std::sin(glm::radians(elevation)) / kPi;
      for (std::size_t i = 0; i < 16; ++i) {
        EXPECT_NEAR(result.guides.Plane(Layer::kLuminance)[i], expected, kFloatRounding * expected + 0x1.0p-49);
        EXPECT_EQ(result.guides.Plane(Layer::kShadow)[i], 0.0f);
      }
    }
  }
}

// A wide sun is a disc of the half angle α: a surface that faces it receives 2 (1/cosα − 1) / tan²α of its strength,
// which is 2 cosα / (1 + cosα). At 180° that is nothing: all of the disc is at the horizon. kWidestSun takes such a sun
// as one of 179.9°, which brings too much, but less than 2 cosα / sinα: 2 / tan 89.95°, 0.0017 of its strength. Drawn
// evenly on the disc, the cosine's mean square is ln(1 + tan²α) / tan²α, 3.6 times its squared mean; directions of the
// surface, taken beside it, can only lower that. 16 × 16 pixels × 256 samples.
TEST(SunAngle, HalfASky) {
  const auto received = [](double half) { return 2.0 * std::cos(half) / (1.0 + std::cos(half)) / kPi; };
  const double widest = glm::radians(0.5 * 179.9), noise = received(widest) * 5.0 * std::sqrt(2.6) / 256.0;
  for (const double degrees : {179.9, 180.0}) {
    Scene scene = Floor(Painted(Bsdf::kDiffuse, 1.0f), 3.0);
    Light sun = Above(LightType::kSun, 0.0, 1.0);
    sun.angle_degrees = degrees;
    scene.lights = {sun};
    const auto result = Render(scene, Spot(), Paths(16, AllLight(), 256));
    ExpectFinite(result);
    const double expected = received(glm::radians(0.5 * degrees));
    const double taken_narrower = degrees > 179.9 ? 2.0 / std::tan(widest) / kPi : 0.0;
    EXPECT_NEAR(MeanLuminance(result), expected, noise + taken_narrower) << degrees;
    EXPECT_NEAR(Mean(result, Layer::kLpeLDE), expected, noise + taken_narrower) << degrees;
  }
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 1.0f));
  scene.lights = {Above(LightType::kSun, 0.0, 1.0)};
  scene.lights[0].angle_degrees = 180.1;
  EXPECT_FALSE(RenderGuides(scene, Spot(), Sized(4, 4, {Layer::kLuminance})));
}

// A corner of two walls under an even sky. What is black sends nothing back. What is white loses nothing: each path
// carries exactly 1 until it ends in the sky, or 0 where it is cut off after the last bounce; so no pixel has more than
// 1, and an open floor, from where every direction ends in the sky, has 1.
TEST(Albedo, NoneAndAll) {
  for (const float albedo : {0.0f, 1.0f}) {
    Scene scene = Floor(Painted(Bsdf::kDiffuse, albedo), 2.0);
    scene.world_radiance = glm::vec3(1.0f);
    const auto open = Render(scene, LookingAt({0, -4, 3}, {0, 0, 0}, 20.0), Paths(16, AllLight(), 16));
    for (const float value : open.guides.Plane(Layer::kLpeFull, 1)) EXPECT_EQ(value, albedo);
    // Luminance is that of white, whatever the paint.
    EXPECT_NEAR(MeanLuminance(open), 1.0, kFloatRounding);
    AddObject(scene, "wall", QuadMesh(), glm::rotate(Moved(0, 1, 1), 0.5 * kPi, glm::dvec3(1, 0, 0)));
    GuidegenOptions options = Paths(16, {Layer::kLpeFull}, 16);
    options.max_bounces = 64;
    const auto corner = Render(scene, LookingAt({0, -3, 2}, {0, 0.8, 0.2}, 10.0), options);
    for (const float value : corner.guides.Plane(Layer::kLpeFull, 1)) {
      EXPECT_LE(value, albedo);
      EXPECT_GE(value,
                albedo * 0.999f);  // 64 bounces cut off less than one path in a thousand: half of all end at each
    }
  }
}

// GGX without Fresnel, white, under a sky of 1, seen head on: what single reflections return. A mirror returns all, to
// the last bit. At α = 1 it is half the integral over c in (0, 1) of 2c / (c + 1), which is 1 − ln 2: visible normals
// are drawn, each weighs the shadowing of its reflection, and those that go below the surface weigh 0. Just above
// the line where a lobe counts as a mirror, α = 1.02e-4, no more than α² is lost.
TEST(Roughness, FromAMirrorToTheRoughest) {
  const auto returned = [](float roughness) {
    Scene scene = Floor(Painted(Bsdf::kGlossy, 1.0f, roughness), 3.0);
    scene.world_radiance = glm::vec3(1.0f);
    const auto result = Render(scene, Spot(), Paths(16, kAllPaths, 256));
    ExpectFinite(result);
    return Mean(result, Layer::kLpeFull);
  };
  EXPECT_EQ(returned(0.0f), 1.0);
  EXPECT_EQ(returned(1e-4f), 1.0);
  EXPECT_NEAR(returned(0.0101f), 1.0, 1.02e-4 * 1.02e-4 + kFloatRounding);
  // Weights are in [0, 1], so they vary by half at most; Spot() looks down at 0.2 degrees from head on.
  EXPECT_NEAR(returned(1.0f), 1.0 - std::log(2.0), 5.0 * 0.5 / 256.0);
}

// The sum, light by light, in double; the tracer sums in double too and rounds once. A thousand roundings of doubles
// are below 2^-42.
TEST(ThousandLights, BringTheirSum) {
  Scene scene = Floor(Painted(Bsdf::kDiffuse, 0.8f), 2.0);
  for (int i = 0; i < 1000; ++i) {
    const double away = 0.1 + 0.02 * i;
    const glm::dvec3 place(away * std::cos(i), away * std::sin(i), 0.5 + 0.001 * i);
    scene.lights.push_back(PointLight(place, 0.01 * std::pow(1.007, i)));
  }
  const Camera camera = LookingAt({0, -3, 3}, {0, 0, 0}, 20.0);
  Stopwatch watch;
  const auto result = Render(scene, camera, Sized(32, 32, {Layer::kLuminance, Layer::kShadow, Layer::kLpeLDE}));
  RecordProperty("ms", std::to_string(watch.Lap()));
  EXPECT_EQ(result.rays.shadow, 2u * 1000u * 32u * 32u);  // luminance and the path layer, every light at every pixel
  const glm::dvec3 eye(camera.world_from_camera[3]);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      const ExactRay ray = PixelRay(camera, 32, 32, x, y);
      const glm::dvec3 place = eye + ray.direction * (-eye.z / ray.direction.z);
      double expected = 0.0;
      for (const Light& lamp : scene.lights) {
        const glm::dvec3 way = glm::dvec3(lamp.world_from_light[3]) - place;
        expected += lamp.intensity * way.z / (kPi * std::pow(glm::length(way), 3.0));
      }
      const std::size_t i = result.guides.Index(x, y);
      EXPECT_NEAR(result.guides.Plane(Layer::kLuminance)[i], expected, (kFloatRounding + 0x1.0p-42) * expected);
      EXPECT_NEAR(result.guides.Plane(Layer::kLpeLDE, 1)[i], double(0.8f) * expected,
                  (kFloatRounding + 0x1.0p-42) * expected);
      EXPECT_EQ(result.guides.Plane(Layer::kShadow)[i], 0.0f);
    }
  }
}

}  // namespace
}  // namespace scumble::testing
