// Shading normals bent as Cycles bends them, and the light on them.
#include "guidegen/surface/shading_normal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "guidegen/cycles_version.h"
#include "guidegen/rays/camera_rays.h"
#include "tests/support/light_path_scenes.h"

namespace scumble::testing {
namespace {

glm::dvec3 RandomUnit(std::mt19937& random) {
  std::normal_distribution<double> place;
  return glm::normalize(glm::dvec3(place(random), place(random), place(random)));
}

// The height of the mirrored ray above the surface.
double MirroredHeight(const glm::dvec3& facing, const glm::dvec3& to_eye, const glm::dvec3& normal) {
  return glm::dot(2.0 * glm::dot(normal, to_eye) * normal - to_eye, facing);
}

// The least turn towards the geometric normal after which the ray clears the surface, by trying all of them.
glm::dvec3 TurnedByTrial(const glm::dvec3& facing, const glm::dvec3& to_eye, const glm::dvec3& normal) {
  const double height = std::min(0.9 * glm::dot(to_eye, facing), 0.01);
  const double whole = std::acos(std::clamp(glm::dot(facing, normal), -1.0, 1.0));
  const int steps = 10000;
  for (int i = 0; i <= steps; ++i) {
    const double left = whole * (1.0 - double(i) / steps);
    const glm::dvec3 across = glm::normalize(normal - facing * glm::dot(facing, normal));
    const glm::dvec3 turned = across * std::sin(left) + facing * std::cos(left);
    if (MirroredHeight(facing, to_eye, turned) >= height) return turned;
  }
  return facing;
}

TEST(BentNormal, IsTheLeastTurnThatClearsTheSurface) {
  std::mt19937 random(5);
  int bent = 0, other = 0;
  for (int i = 0; i < 4000; ++i) {
    const glm::dvec3 facing = RandomUnit(random);
    glm::dvec3 to_eye = RandomUnit(random), normal = RandomUnit(random);
    if (glm::dot(to_eye, facing) < 0.0) to_eye = -to_eye;
    if (glm::dot(normal, facing) < 0.0) normal = -normal;
    const glm::dvec3 found = BentNormal(facing, to_eye, normal);
    const double height = std::min(0.9 * glm::dot(to_eye, facing), 0.01);
    EXPECT_NEAR(glm::length(found), 1.0, 1e-12);
    if (found == normal) {
      EXPECT_GE(MirroredHeight(facing, to_eye, normal), height);
      continue;
    }
    ++bent;
    EXPECT_LT(MirroredHeight(facing, to_eye, normal), height);
    EXPECT_GT(glm::dot(found, to_eye), 0.0) << "it faces the eye";
    const double found_height = MirroredHeight(facing, to_eye, found);
    const glm::dvec3 least = TurnedByTrial(facing, to_eye, normal);
    if (std::abs(found_height - height) > 1e-9) {  // Cycles' other root
      ++other;
      EXPECT_GE(found_height, 1e-5 - 1e-12);
      EXPECT_LT(found_height, height);
      EXPECT_LT(glm::length(found - least), 0.04) << i;
      continue;
    }
    EXPECT_LT(glm::length(found - least), 2e-4) << i;
  }
  EXPECT_GT(bent, 1000);
  EXPECT_LT(other, bent / 50);
}

TEST(BentNormal, ExtremesStayFinite) {
  const glm::dvec3 up(0, 0, 1), side(1, 0, 0);
  const auto expect_unit = [](const glm::dvec3& v) { EXPECT_NEAR(glm::length(v), 1.0, 1e-12); };
  EXPECT_EQ(BentNormal(up, side, up), up) << "flat surfaces are never bent, however they are seen";
  EXPECT_EQ(BentNormal(up, up, up), up);
  for (const glm::dvec3& normal : {side, -side, -up, glm::normalize(glm::dvec3(1, 0, -1e-9)), glm::dvec3(0, 1, 0)}) {
    for (const double height : {1.0, 1e-3, 1e-9, 1e-200, 0.0, -1e-17}) {
      expect_unit(BentNormal(up, glm::normalize(glm::dvec3(-1, 0, height)), normal));
      expect_unit(BentNormal(up, glm::normalize(glm::dvec3(1, 0, height)), normal));
    }
  }
  EXPECT_EQ(BentNormal(up, up, -up), -up) << "its mirrored ray is the same one";
}

TEST(ShadingNormalShadow, FadesWhereLightSinksBelowTheInterpolatedNormal) {
  const glm::dvec3 smooth(0, 0, 1), normal = glm::normalize(glm::dvec3(1, 0, 1));
  EXPECT_EQ(ShadingNormalShadow(normal, glm::dvec3(0.0), {-1, 0, 0}), 1.0) << "no other normal";
  EXPECT_EQ(ShadingNormalShadow(normal, smooth, smooth), 1.0) << "light on the smooth normal's side";
  const glm::dvec3 low = glm::normalize(glm::dvec3(1, 0, 0.2));
  const double g = low.z / (glm::dot(normal, low) * std::sqrt(0.5));
  EXPECT_NEAR(ShadingNormalShadow(normal, smooth, low), g + g * g - g * g * g, 1e-12);
  EXPECT_EQ(ShadingNormalShadow(normal, smooth, {1, 0, -0.01}), 0.0) << "below it";
  double before = 0.0;
  for (int i = 0; i <= 100; ++i) {
    const double angle = i / 100.0 * kPi / 4.0;
    const double share = ShadingNormalShadow(normal, smooth, {std::cos(angle), 0.0, std::sin(angle)});
    EXPECT_GE(share, before);
    EXPECT_LE(share, 1.0);
    before = share;
  }
  EXPECT_EQ(before, 1.0);
}

// Eight smooth sides without caps around the axis Y: neighbours' normals differ by 45°.
Mesh CoarseTube() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    const float angle = float(2.0 * kPi * i / 8.0);
    const glm::vec3 out(std::cos(angle), 0.0f, std::sin(angle));
    for (const float height : {-1.0f, 1.0f}) {
      mesh.positions.push_back(out + glm::vec3(0.0f, height, 0.0f));
      mesh.normals.push_back(out);
    }
    const unsigned a = 2u * unsigned(i), b = 2u * unsigned((i + 1) % 8);
    mesh.triangles.push_back({a, a + 1, b});
    mesh.triangles.push_back({b, a + 1, b + 1});
  }
  return mesh;
}

Scene Tube(Bsdf bsdf) {
  Scene scene = SceneOf(CoarseTube());
  scene.materials[0] = Painted(bsdf, 1.0f);
  scene.lights = {PointLight({3.0, 2.0, 3.0}, 20.0)};
  return scene;
}

struct BendCounts {
  int covered = 0, bent = 0;
};

// Each pixel of the bent picture against BentNormal of the raw one's. `all_bent`: each is bent where it needs to be.
BendCounts CountBent(const GuidegenResult& bent, const GuidegenResult& raw, const Camera& camera,
                     bool all_bent = true) {
  BendCounts counts;
  const CameraRays rays = CameraRays::Make(camera, bent.guides.width(), bent.guides.height()).value();
  for (int y = 0; y < bent.guides.height(); ++y) {
    for (int x = 0; x < bent.guides.width(); ++x) {
      const auto i = std::size_t(y) * std::size_t(bent.guides.width()) + std::size_t(x);
      if (bent.guides.Plane(Layer::kCoverage)[i] == 0.0f) continue;
      ++counts.covered;
      const glm::dvec3 normal(bent.guides.Vec3(Layer::kNormal, i)), before(raw.guides.Vec3(Layer::kNormal, i));
      const glm::dvec3 to_eye = glm::normalize(-rays.Through(x + 0.5, y + 0.5).direction);
      if (all_bent || normal != before) {
        EXPECT_GT(glm::dot(normal, to_eye), 0.0) << "normals face the eye";
      }
      if (normal == before) continue;
      ++counts.bent;
      EXPECT_GT(glm::dot(normal, to_eye), glm::dot(before, to_eye));
    }
  }
  return counts;
}

TEST(BentNormals, ACoarseTubeIsBentAtItsRimsInEveryLayer) {
  const Camera camera = LookingAt({0, 0.5, 6}, {0, 0, 0}, 40.0);
  GuidegenOptions options = Paths(96, {Layer::kLpeLDE, Layer::kLuminance, Layer::kPosition}, 4);
  const Scene scene = Tube(Bsdf::kDiffuse);
  const auto bent = Render(scene, camera, options);
  options.raw_normals = true;
  const auto raw = Render(scene, camera, options);
  const BendCounts counts = CountBent(bent, raw, camera);
  EXPECT_GT(counts.bent, counts.covered / 50);
  EXPECT_LT(counts.bent, counts.covered / 4);
  EXPECT_EQ(bent.guides.attributes.count("scumble:raw_normals"), 0u);
  EXPECT_EQ(raw.guides.attributes.at("scumble:raw_normals"), "true");
  // White Lambert's direct light is the luminance, whatever bends the normal.
  for (const auto* result : {&bent, &raw}) {
    for (std::size_t i = 0; i < result->guides.pixel_count(); ++i) {
      EXPECT_NEAR(result->guides.Plane(Layer::kLpeLDE)[i], result->guides.Plane(Layer::kLuminance)[i], 1e-6);
    }
  }
  // The same from memory that other layers share: normals alone take another way through the caster.
  options.raw_normals = false;
  options.layers = {};
  const auto alone = Render(scene, camera, options);
  for (int c = 0; c < 3; ++c) {
    const auto one = alone.guides.Plane(Layer::kNormal, c), other = bent.guides.Plane(Layer::kNormal, c);
    EXPECT_TRUE(std::equal(one.begin(), one.end(), other.begin()));
  }
}

TEST(BentNormals, WhatReflectsNothingKeepsItsNormals) {
  const Camera camera = LookingAt({0, 0.5, 6}, {0, 0, 0}, 40.0);
  Scene black = Tube(Bsdf::kDiffuse), dark = Tube(Bsdf::kDiffuse);
  black.materials[0].base_color = {0.0f, 0.0f, 0.0f, 1.0f};
  dark.materials[0].base_color = {1e-4f, 1e-4f, 1e-4f, 1.0f};
  for (const Scene& scene : {Tube(Bsdf::kEmission), black, dark}) {
    GuidegenOptions options = Paths(64, {});
    const auto bent = Render(scene, camera, options);
    options.raw_normals = true;
    const auto raw = Render(scene, camera, options);
    int same = 0;
    for (int c = 0; c < 3; ++c) {
      const auto one = bent.guides.Plane(Layer::kNormal, c), other = raw.guides.Plane(Layer::kNormal, c);
      same += std::equal(one.begin(), one.end(), other.begin());
    }
    EXPECT_EQ(same == 3, scene.materials[0].base_color.r != 1e-4f);
  }
}

TEST(BentNormals, Cycles4BendsThoseOfSpecularLobesAlone) {
  const Camera camera = LookingAt({0, 0.5, 6}, {0, 0, 0}, 40.0);
  for (const Bsdf bsdf : {Bsdf::kDiffuse, Bsdf::kGlossy, Bsdf::kMetallicRoughness}) {
    Scene scene = Tube(bsdf);
    EXPECT_TRUE(ShadeAsCycles("4.3.2", scene));
    EXPECT_FALSE(ShadeAsCycles("4.3.2 LTS", scene)) << "it is already";
    GuidegenOptions options = Paths(64, {});
    const auto bent = Render(scene, camera, options);
    options.raw_normals = true;
    const auto raw = Render(scene, camera, options);
    const BendCounts counts = CountBent(bent, raw, camera, bsdf == Bsdf::kGlossy);
    EXPECT_EQ(counts.bent > 0, bsdf == Bsdf::kGlossy);
    EXPECT_TRUE(ShadeAsCycles("3.4.1", scene));
    options.raw_normals = false;
    EXPECT_GT(CountBent(Render(scene, camera, options), raw, camera).bent, 0);
  }
}

// A mirrored sky of 1: with bent normals no mirrored ray is lost.
TEST(BentNormals, AMirrorLosesNothing) {
  Scene scene = Tube(Bsdf::kGlossy);
  scene.materials[0].roughness = 0.0f;
  scene.lights.clear();
  scene.world_radiance = glm::vec3(1.0f);
  const auto result = Render(scene, LookingAt({0, 0.5, 6}, {0, 0, 0}, 40.0), Paths(48, {Layer::kLpeFull}, 16));
  for (std::size_t i = 0; i < result.guides.pixel_count(); ++i) {
    if (result.guides.Plane(Layer::kCoverage)[i] > 0.0f) {
      EXPECT_NEAR(result.guides.Plane(Layer::kLpeFull)[i], 1.0, 1e-5);
    }
  }
}

}  // namespace
}  // namespace scumble::testing
