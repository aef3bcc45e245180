// Normals against the depth of the same pixels, on balls and floors whose normals and depths are known.
#include "core/io/guides/normal_space.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "core/io/guide_file.h"
#include "tests/support/temporary_folder.h"

namespace scumble {
namespace {

// A ball of radius 1 around (0.4, 0.2, -4) and a floor at y = -1, seen from the origin along -z by 60 degrees.
GuideSet BallOnFloor(const glm::dmat3& turn_normals) {
  GuideSet guides(96, 64);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject, Layer::kMaterial})
    guides.Add(layer);
  const double half = std::tan(glm::radians(30.0));
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      const glm::dvec3 ray((x + 0.5 - 48.0) / 48.0 * half, -(y + 0.5 - 32.0) / 48.0 * half, -1.0);
      const glm::dvec3 centre(0.4, 0.2, -4.0);
      const double b = glm::dot(ray, centre), c = glm::dot(centre, centre) - 1.0, a = glm::dot(ray, ray);
      const double root = b * b - a * c;
      const std::size_t i = guides.Index(x, y);
      glm::dvec3 normal(0.0);
      if (root > 0.0) {
        const double depth = (b - std::sqrt(root)) / a;
        normal = depth * ray - centre;
        guides.Plane(Layer::kDepth)[i] = static_cast<float>(depth), guides.Plane(Layer::kObject)[i] = 1.0f;
      } else if (ray.y < -0.05) {
        normal = {0.0, 1.0, 0.0};
        guides.Plane(Layer::kDepth)[i] = static_cast<float>(-1.0 / ray.y), guides.Plane(Layer::kObject)[i] = 2.0f;
      } else {
        continue;
      }
      normal = turn_normals * normal;
      for (int k = 0; k < 3; ++k) guides.Plane(Layer::kNormal, k)[i] = static_cast<float>(normal[k]);
      guides.Plane(Layer::kCoverage)[i] = 1.0f;
    }
  }
  return guides;
}

glm::dmat3 Turned(double degrees, glm::dvec3 axis) {
  return glm::dmat3(glm::rotate(glm::dmat4(1.0), glm::radians(degrees), axis));
}

TEST(NormalSpace, NormalsOfTheViewPointWhereDepthGrows) {
  const double degrees = internal::NormalsAgainstDepth(BallOnFloor(glm::dmat3(1.0)));
  EXPECT_GE(degrees, 0.0);
  EXPECT_LT(degrees, 2.0);
}

TEST(NormalSpace, WhatTheWorldOrAnotherAxisMakesOfThemIsFar) {
  EXPECT_GT(internal::NormalsAgainstDepth(BallOnFloor(Turned(180.0, {0.0, 1.0, 0.0}))), 30.0);
  EXPECT_GT(internal::NormalsAgainstDepth(BallOnFloor(Turned(90.0, {1.0, 0.0, 0.0}))), 40.0);
  EXPECT_GT(internal::NormalsAgainstDepth(BallOnFloor(glm::dmat3(glm::scale(glm::dmat4(1.0), {1.0, -1.0, 1.0})))),
            60.0);
}

TEST(NormalSpace, NormalsAwayFromTheEyeAreFound) {
  const GuideSet right = BallOnFloor(glm::dmat3(1.0));
  GuideSet turned = BallOnFloor(glm::dmat3(glm::scale(glm::dmat4(1.0), {1.0, 1.0, -1.0})));
  EXPECT_EQ(internal::ShareTurnedAway(right), 0.0);
  EXPECT_GT(internal::ShareTurnedAway(turned), 0.95) << "the floor has z = 0";
  const auto refused = internal::CheckNormalSpace(turned, "left.exr");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("away from the eye"), std::string::npos) << refused.error().message;
  turned.Remove(Layer::kDepth);
  for (float& z : turned.Plane(Layer::kNormal, 2)) z = -1.0f;
  EXPECT_FALSE(internal::CheckNormalSpace(turned, "left.exr")) << "normals alone tell";
}

// A floor under a camera that looks up by 30 degrees: it is seen where z of its normals is below 0.
TEST(NormalSpace, AViewUpwardsOverAFloorIsNoMistake) {
  GuideSet guides(96, 96);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject}) guides.Add(layer);
  const glm::dvec3 normal(0.0, std::cos(glm::radians(30.0)), -0.5);
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 96; ++x) {
      const glm::dvec3 ray((x + 0.5 - 48.0) / 48.0, -(y + 0.5 - 48.0) / 48.0, -1.0);
      const double across = glm::dot(ray, normal);
      if (across > -0.05) continue;
      const std::size_t i = guides.Index(x, y);
      for (int k = 0; k < 3; ++k) guides.Plane(Layer::kNormal, k)[i] = static_cast<float>(normal[k]);
      guides.Plane(Layer::kDepth)[i] = static_cast<float>(-1.0 / across);
      guides.Plane(Layer::kCoverage)[i] = guides.Plane(Layer::kObject)[i] = 1.0f;
    }
  }
  EXPECT_TRUE(internal::CheckNormalSpace(guides, "up.exr"));
  guides.Remove(Layer::kDepth);
  EXPECT_TRUE(internal::CheckNormalSpace(guides, "up.exr"));
}

// Blades of grass of one object beside each other: their depths jump, and their normals are right.
TEST(NormalSpace, DepthsThatJumpTellNothing) {
  GuideSet guides = BallOnFloor(glm::dmat3(1.0));
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kDepth)[i] *= 1.0f + 0.03f * static_cast<float>(i * 7 % 5);
    guides.Plane(Layer::kObject)[i] = 1.0f;
  }
  EXPECT_TRUE(internal::CheckNormalSpace(guides, "grass.exr"));
}

TEST(NormalSpace, FewPixelsTellNothing) {
  GuideSet guides(4, 4);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject}) guides.Add(layer);
  EXPECT_EQ(internal::NormalsAgainstDepth(guides), -1.0);
}

TEST(NormalSpace, AFileWithWorldNormalsIsRefused) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteGuides(folder / "view.exr", BallOnFloor(glm::dmat3(1.0))));
  ASSERT_TRUE(WriteGuides(folder / "world.exr", BallOnFloor(Turned(180.0, {0.0, 1.0, 0.0}))));
  GuideReadOptions options;
  options.required = {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject};
  const auto taken = ReadGuides(folder / "view.exr", options);
  EXPECT_TRUE(taken) << taken.error().message;
  const auto refused = ReadGuides(folder / "world.exr", options);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("view space"), std::string::npos) << refused.error().message;
}

}  // namespace
}  // namespace scumble
