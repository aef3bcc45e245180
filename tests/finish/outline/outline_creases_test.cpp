// Creases of outlines: which folds are some, how far they go, and on whose side they lie.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/finish/outline/outline_fixtures.h"

namespace scumble {
namespace {

// Two faces at a right angle, which meet at x = 60.
GuideSet CreaseGuides() {
  const float h = std::sqrt(0.5f);
  return GuidesOf(120, 80, [&](glm::vec2 at) {
    return SeenPoint{true, {at.x < 60.0f ? -h : h, 0.0f, h}, 5.0f + 0.01f * std::fabs(at.x - 60.0f), 1.0f};
  });
}

TEST(Outline, CreaseIsOneLine) {
  OutlinePass pass;
  pass.width = 3.0;
  pass.of_class[std::size_t(LineClass::kCrease)] = 1.0;
  const std::vector<double> ink = InkOf(pass, CreaseGuides());
  for (int x = 0; x < 120; ++x) {
    const double expected = std::clamp(2.0 - std::fabs(x + 0.5 - 60.0), 0.0, 1.0);  // half of 3 pixels, and a half
    EXPECT_NEAR(ink[40 * 120 + std::size_t(x)], expected, 1e-4) << x;
  }
  pass.crease_angle = 91.0;
  EXPECT_EQ(Sum(InkOf(pass, CreaseGuides())), 0.0);
  pass.crease_angle = 40.0, pass.of_class[std::size_t(LineClass::kCrease)] = 0.0;
  EXPECT_EQ(Sum(InkOf(pass, CreaseGuides())), 0.0);
}

// Normals that turn by 45 degrees a pixel over half a circle: a fold of four pixels, and no edge.
TEST(Outline, ARoundFoldIsNoCreaseHoweverSmall) {
  OutlinePass pass;
  pass.of_class[std::size_t(LineClass::kCrease)] = 1.0;
  const auto bent = [](float per_pixel) {
    return GuidesOf(120, 80, [=](glm::vec2 at) {
      const double turn = std::clamp(double(per_pixel) * (at.x - 60.0), -90.0, 90.0) * std::numbers::pi / 180.0;
      return SeenPoint{true, {float(std::sin(turn)), 0.0f, float(std::cos(turn))}, 5.0f, 1.0f};
    });
  };
  EXPECT_EQ(Sum(InkOf(pass, bent(45.0f))), 0.0);
  EXPECT_EQ(Sum(InkOf(pass, bent(10.0f))), 0.0);
  EXPECT_GT(Sum(InkOf(pass, bent(170.0f))), 80.0) << "two pixels, from one side to the other";
}

// A fold whose angle falls from 50 degrees at the left to 20 at the right, and one of 30 degrees by itself: the crease
// goes on from where it reaches 40 to where it falls below two thirds of that, and does not begin without.
TEST(Outline, ACreaseGoesOnToTwoThirdsOfItsAngle) {
  OutlinePass pass;
  pass.width = 1.0;
  pass.of_class[std::size_t(LineClass::kCrease)] = 1.0;
  const auto folded = [](auto angle_at) {
    return GuidesOf(120, 80, [&](glm::vec2 at) {
      const double half = 0.5 * angle_at(at.x) * std::numbers::pi / 180.0;
      const auto up = static_cast<float>(std::sin(half)), out = static_cast<float>(std::cos(half));
      return SeenPoint{true, {0.0f, at.y < 40.0f ? up : -up, out}, 5.0f, 1.0f};
    });
  };
  const std::vector<double> ink = InkOf(pass, folded([](float x) { return 50.0 - 0.25 * x; }));
  const auto column = [&](int x) {
    double sum = 0.0;
    for (std::size_t y = 0; y < 80; ++y) sum += ink[y * 120 + std::size_t(x)];
    return sum;
  };
  for (int x = 2; x < 90; ++x) EXPECT_NEAR(column(x), 1.0, 0.01) << x;
  for (int x = 96; x < 120; ++x) EXPECT_EQ(column(x), 0.0) << x;
  EXPECT_EQ(Sum(InkOf(pass, folded([](float) { return 30.0; }))), 0.0);
  // A crease that leaves at the right does not go on at the left, one row below.
  const GuideSet leaves = GuidesOf(120, 80, [&](glm::vec2 at) {
    const double half = (at.x > 60.0f ? 25.0 : at.x < 20.0f ? 15.0 : 0.0) * std::numbers::pi / 180.0;
    const auto up = static_cast<float>(std::sin(half)), out = static_cast<float>(std::cos(half));
    return SeenPoint{true, {0.0f, at.y < (at.x > 60.0f ? 40.0f : 41.0f) ? up : -up, out}, 5.0f, 1.0f};
  });
  EXPECT_NEAR(Sum(InkOf(pass, leaves)), 60.0, 2.0);
  // Nor on another object.
  const GuideSet two = GuidesOf(120, 80, [&](glm::vec2 at) {
    const double half = (at.x < 60.0f ? 25.0 : 15.0) * std::numbers::pi / 180.0;
    const auto up = static_cast<float>(std::sin(half)), out = static_cast<float>(std::cos(half));
    return SeenPoint{true, {0.0f, at.y < 40.0f ? up : -up, out}, 5.0f, at.x < 60.0f ? 1.0f : 2.0f};
  });
  OutlinePass creases = pass;
  for (double& width : creases.of_class) width = 0.0;
  creases.of_class[std::size_t(LineClass::kCrease)] = 1.0;
  EXPECT_NEAR(Sum(InkOf(creases, two)), 60.0, 2.0);
}

// A fold that turns by 150 degrees within three pixels, wherever these lie.
TEST(Outline, FoldsOfFewPixelsAreNoCreases) {
  OutlinePass pass;
  for (double& width : pass.of_class) width = 0.0;
  pass.of_class[std::size_t(LineClass::kCrease)] = 1.0;
  for (const double place : {60.0, 60.25, 60.5, 60.75}) {
    const GuideSet fold = GuidesOf(120, 80, [=](glm::vec2 at) {
      const double turn = 75.0 * std::tanh(at.x - place) * std::numbers::pi / 180.0;
      return SeenPoint{true, {float(std::sin(turn)), 0.0f, float(std::cos(turn))}, 5.0f, 1.0f};
    });
    EXPECT_EQ(Sum(InkOf(pass, fold)), 0.0) << place;
  }
}

// A pyramid's edge, whose faces narrow down to nothing.
TEST(Outline, CreasesReachCorners) {
  OutlinePass pass;
  for (double& width : pass.of_class) width = 0.0;
  pass.of_class[std::size_t(LineClass::kCrease)] = 1.0;
  const GuideSet guides = GuidesOf(120, 80, [](glm::vec2 at) {
    const float across = at.x - 60.0f, half = 0.25f * (at.y - 10.0f);
    const float side = across < 0.0f ? -0.7071f : 0.7071f;
    return SeenPoint{std::fabs(across) < half && at.y < 70.0f, {side, 0.0f, 0.7071f}, 5.0f, 1.0f};
  });
  const std::vector<double> ink = InkOf(pass, guides);
  for (std::size_t y = 16; y < 69; ++y) {
    double sum = 0.0;
    for (std::size_t x = 56; x < 64; ++x) sum += ink[120 * y + x];
    EXPECT_GT(sum, 0.5) << y;
  }
}

// Beside a crease neither surface is nearer, whichever pixel is.
TEST(Outline, CreasesHaveNoSide) {
  const float h = std::sqrt(0.5f);
  const GuideSet guides = GuidesOf(120, 80, [&](glm::vec2 at) {
    const float across = at.x - 57.3f - 0.1f * at.y;
    return SeenPoint{true, {across < 0.0f ? -h : h, 0.0f, h}, 5.0f + 0.01f * std::fabs(across), 1.0f};
  });
  OutlinePass pass;
  pass.width = 8.0;
  const std::vector<double> centre = InkOf(pass, guides);
  EXPECT_GT(Sum(centre), 350.0);
  for (const auto side : {OutlinePass::Side::kInside, OutlinePass::Side::kOutside}) {
    pass.side = side;
    EXPECT_EQ(InkOf(pass, guides), centre);
  }
}

}  // namespace
}  // namespace scumble
