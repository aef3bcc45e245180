// What lies on a ground or in it: the ground does not shade it, however large the ground is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/guidegen/light/self_shadow_scenes.h"
#include "tests/support/light_path_scenes.h"

namespace scumble::testing {
namespace {

constexpr int kTurns = 12;
constexpr double kEyeToSquare = 4.0;  // m

// A square of 2 m in the middle of a ground `width` times as wide, or `gap` metres above it; suns and lights overhead
// and slanted. The eye looks down on it at an angle, and all is turned, so that corners have every digit.
Stage SquareOnAGround(double width, double gap, int turn) {
  const glm::dmat4 matrix = Placed(1.0, glm::dvec3(0.0), turn);
  const glm::dvec3 x(matrix[0]), y(matrix[1]), up(matrix[2]);
  Stage stage{SceneOf(QuadMesh(), glm::scale(matrix, glm::dvec3(width, width, 1.0))), {}};
  AddObject(stage.scene, "square", QuadMesh(), glm::translate(glm::dmat4(1.0), up * gap) * matrix);
  for (const double degrees : {90.0, 45.0, 10.0}) {
    const double elevation = glm::radians(degrees);
    const glm::dvec3 direction = y * std::cos(elevation) + up * std::sin(elevation);
    stage.scene.lights.push_back(SunFrom(direction));
    stage.scene.lights.push_back(PointLight(direction * 5.0, 25.0));
  }
  const glm::dvec3 view = glm::normalize(up + x * 0.8 + y * 0.3);
  stage.camera = LookingAt(view * kEyeToSquare, glm::dvec3(0.0), 40.0);
  return stage;
}

// By how much float may raise that ground under a ray, and no more, as derived beside kRoundingPerCoordinate: its
// corners are √2 `width` from the middle, its longest edge is 2√2 `width`, and the least sine √½.
double RoundingOfGround(double width) {
  const double coordinate = std::sqrt(2.0) * width + kEyeToSquare, longest = 2.0 * std::sqrt(2.0) * width;
  return kUnit * (2.0 * std::sqrt(3.0) * coordinate + 5.0 * longest + 4.0 * std::sqrt(2.0) * longest);
}

struct GroundCount {
  std::size_t rays = 0;          // towards lights
  std::size_t seen = 0;          // pixels that show the square
  std::size_t wrong = 0;         // of those, in a shadow
  std::size_t wrong_beside = 0;  // pixels of the ground in a shadow that is none of the square's

  std::string ToString() const {
    return std::to_string(wrong) + " of " + std::to_string(seen) + " pixels, beside it " + std::to_string(wrong_beside);
  }
};

// Nothing stands above the square, so every shadow on it is false. Its own falls on the ground: where it is no more
// than 1 mm high, and no light is lower than 10 degrees, no farther than 6 mm.
void CountShadows(const Stage& stage, GroundCount& count) {
  GuidegenOptions options = SmallPicture();
  options.layers.Add(Layer::kPosition);
  const auto result = Render(stage.scene, stage.camera, options);
  const float square = float(IdsForNames(std::vector<std::string>{"thing", "square"})[1]);
  const glm::dmat4 square_from_world = glm::inverse(stage.scene.instances[1].world_from_object);
  count.rays += result.rays.shadow;
  for (std::size_t i = 0; i < result.guides.pixel_count(); ++i) {
    const bool on_square = result.guides.Plane(Layer::kObject)[i] == square;
    const bool shaded = result.guides.Plane(Layer::kShadow)[i] != 0.0f;
    const glm::dvec3 at = At(square_from_world, glm::dvec3(result.guides.Vec3(Layer::kPosition, i)));
    const bool beside = std::max(std::abs(at.x), std::abs(at.y)) > 1.01;
    count.seen += on_square;
    count.wrong += shaded && on_square;
    count.wrong_beside += shaded && !on_square && beside;
  }
}

// A ray of light from the square starts above the square by the square's own height, while float may raise the ground
// by the ground's rounding, which is the larger the larger the ground is. Where the square lies higher than that
// rounding the ground stays below. Expected: every picture shows the square, all of it lit.
TEST(SelfShadow, WhatLiesHigherThanAGroundsRoundingIsNotShadedByIt) {
  for (const double width : {10.0, 1e2, 1e3, 1e4, 1e5}) {
    GroundCount count;
    for (const double times : {1.0, 2.0}) {
      for (int turn = 0; turn < kTurns; ++turn) {
        CountShadows(SquareOnAGround(width, times * RoundingOfGround(width), turn), count);
      }
    }
    EXPECT_EQ(count.wrong, 0u) << "a ground " << width << " times as wide: " << count.ToString();
    EXPECT_GT(count.seen, 2u * kTurns * 400u) << width;  // the square is a third of the picture
  }
}

// The square in the ground itself, and so low above it that rounding may be larger: a decal. Float chooses whether it
// shows the square or the ground there, but nothing blocks any light. Expected: no shadow.
TEST(SelfShadow, WhatLiesInAGroundIsNotShadedByIt) {
  for (const double width : {10.0, 30.0, 1e2, 1e3, 1e4, 1e5}) {
    for (const double gap : {0.0, 1e-6, 1e-5, 1e-4, 1e-3}) {
      GroundCount count;
      for (int turn = 0; turn < kTurns; ++turn) CountShadows(SquareOnAGround(width, gap, turn), count);
      EXPECT_EQ(count.wrong + count.wrong_beside, 0u)
          << "a ground " << width << " times as wide, " << gap << " m below: " << count.ToString();
      EXPECT_GT(count.rays, kTurns * 1600u * 4u);
      std::printf("a square on a ground %g times as wide, %g m above it: in false shadow %s\n", width, gap,
                  count.ToString().c_str());
    }
  }
}

}  // namespace
}  // namespace scumble::testing
