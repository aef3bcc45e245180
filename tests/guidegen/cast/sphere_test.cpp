// The exemplar's guides against the analytic sphere.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <utility>

#include "core/image/direction.h"
#include "guidegen/guidegen.h"
#include "tests/support/guidegen_checks.h"

namespace scumble::testing {
namespace {

GuidegenResult RenderSphere(const SphereOptions& options) { return TakeValid(RenderSphereGuides(options)); }

double AngleDegrees(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

class SphereOfSize : public ::testing::TestWithParam<int> {};

TEST_P(SphereOfSize, IsTheAnalyticSphere) {
  const int n = GetParam();
  SphereOptions options;
  options.size = n;
  options.layers = {Layer::kPosition, Layer::kPref};
  const auto result = RenderSphere(options);
  const GuideSet& guides = result.guides;
  int covered = 0, wrong_normals = 0, wrong_places = 0, wrong_coverage = 0;
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const std::size_t i = guides.Index(x, y);
      const double px = (x + 0.5 - n / 2.0) / (n / 2.0);
      const double py = (n / 2.0 - y - 0.5) / (n / 2.0);
      const double radius2 = px * px + py * py;
      const bool hit = guides.Plane(Layer::kCoverage)[i] > 0.0f;
      if (std::abs(radius2 - 1.0) > 1e-5) wrong_coverage += hit != (radius2 < 1.0);
      if (!hit) continue;
      ++covered;
      const glm::dvec3 expected(px, py, std::sqrt(std::max(0.0, 1.0 - radius2)));
      wrong_normals += AngleDegrees(guides.Vec3(Layer::kNormal, i), expected) > 0.001;
      const double depth = 2.0 - expected.z;
      wrong_places += std::abs(guides.Plane(Layer::kDepth)[i] - depth) > 1e-5 * depth ||
                      glm::length(glm::dvec3(guides.Vec3(Layer::kPosition, i)) - expected) > 1e-5 ||
                      guides.Vec3(Layer::kPosition, i) != guides.Vec3(Layer::kPref, i);
    }
  }
  EXPECT_EQ(wrong_coverage, 0);
  EXPECT_GT(covered, 0);
  EXPECT_LE(wrong_normals, covered / 1000);
  EXPECT_LE(wrong_places, covered / 1000);
  EXPECT_EQ(result.rays.primary, std::size_t(n) * n);
}

INSTANTIATE_TEST_SUITE_P(Sizes, SphereOfSize, ::testing::Values(1, 2, 63, 64, 512, 1024),
                         [](const auto& size) { return std::to_string(size.param); });

TEST(Sphere, FillsThePictureExactly) {
  SphereOptions options;
  options.size = 256;
  options.aa = 8;
  const auto result = RenderSphere(options);
  double area = 0.0;
  for (const float a : result.guides.Plane(Layer::kCoverage)) area += a;
  EXPECT_NEAR(area, glm::pi<double>() * 128 * 128, 5.0);
  // The silhouette touches all four edges in the middle and leaves the corners empty.
  for (const auto& [x, y] : {std::pair{128, 0}, {128, 255}, {0, 128}, {255, 128}}) {
    EXPECT_GT(result.guides.Plane(Layer::kCoverage)[result.guides.Index(x, y)], 0.5f);
  }
  EXPECT_EQ(result.guides.Plane(Layer::kCoverage)[0], 0.0f);
}

TEST(Sphere, IsLitByTheKeyLight) {
  SphereOptions options;
  options.size = 128;
  options.layers = {Layer::kLuminance, Layer::kShadow};
  const auto result = RenderSphere(options);
  const glm::dvec3 sun(-0.49240387650610407, 0.6427876096865394, 0.5868240888334652);
  for (std::size_t i = 0; i < result.guides.pixel_count(); ++i) {
    if (result.guides.Plane(Layer::kCoverage)[i] == 0.0f) continue;
    const double cosine = glm::dot(glm::dvec3(result.guides.Vec3(Layer::kNormal, i)), sun);
    EXPECT_NEAR(result.guides.Plane(Layer::kLuminance)[i], std::max(0.0, cosine), 1e-5);
    EXPECT_EQ(result.guides.Plane(Layer::kShadow)[i], 0.0f);
  }
}

TEST(Sphere, HasAHighlightHalfwayToTheKeyLight) {
  SphereOptions options;
  options.size = 128;
  options.layers = {Layer::kLpeLDE, Layer::kLpeLSE};
  const GuideSet guides = RenderSphere(options).guides;
  const auto highlight = guides.Plane(Layer::kLpeLSE);
  const auto brightest = std::size_t(std::max_element(highlight.begin(), highlight.end()) - highlight.begin());
  const glm::dvec3 sun = DirectionFromAngles(kKeyLightAzimuth, kKeyLightElevation);
  const glm::dvec3 halfway = glm::normalize(sun + glm::dvec3(0, 0, 1));
  EXPECT_GT(highlight[brightest], 0.1f);
  EXPECT_LT(AngleDegrees(guides.Vec3(Layer::kNormal, brightest), halfway), 5.0);
  options.layers = {Layer::kLpeLDE};
  const GuideSet matt = RenderSphere(options).guides;
  const auto lit = matt.Plane(Layer::kLpeLDE), beside = guides.Plane(Layer::kLpeLDE);
  EXPECT_TRUE(std::ranges::equal(lit, beside)) << "other layers stay matt";
}

TEST(Direction, TurnsFromTowardsTheViewerToTheRightAndUp) {
  const auto expect_near = [](const glm::dvec3& a, const glm::dvec3& b) { EXPECT_LT(glm::length(a - b), 1e-15); };
  expect_near(DirectionFromAngles(0, 0), {0, 0, 1});
  expect_near(DirectionFromAngles(90, 0), {1, 0, 0});
  expect_near(DirectionFromAngles(180, 0), {0, 0, -1});
  expect_near(DirectionFromAngles(123, 90), {0, 1, 0});
  expect_near(DirectionFromAngles(-90, -30), {-std::sqrt(0.75), -0.5, 0});
  expect_near(DirectionFromAngles(kKeyLightAzimuth, kKeyLightElevation),
              {-0.49240387650610407, 0.6427876096865394, 0.5868240888334652});
}

TEST(Sphere, HasItsNames) {
  const auto result = RenderSphere({});
  EXPECT_EQ(result.guides.width(), 512);
  ASSERT_EQ(result.guides.object_names.size(), 1u);
  EXPECT_EQ(result.guides.object_names.begin()->second, "sphere");
  const std::size_t middle = result.guides.Index(256, 256);
  EXPECT_EQ(result.guides.Plane(Layer::kObject)[middle], float(result.guides.object_names.begin()->first));
  EXPECT_TRUE(result.guides.camera.has_value());
}

TEST(Sphere, RefusesImpossibleSizes) {
  for (const int size : {0, -3, kMaxImageSide + 1}) {
    SphereOptions options;
    options.size = size;
    const auto result = RenderSphereGuides(options);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().kind, ErrorKind::kUsage);
  }
}

}  // namespace
}  // namespace scumble::testing
