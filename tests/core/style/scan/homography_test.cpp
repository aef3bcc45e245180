// Homographies from pairs of points.
#include "core/style/scan/homography.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "core/image/hash.h"

namespace scumble {
namespace {

TEST(Homography, FourPointsAreMetAndMoreAreAveraged) {
  const glm::dmat3 truth(900, 40, 0.2, -60, 800, -0.1, 300, 200, 1);
  std::vector<glm::dvec2> from, to;
  for (int i = 0; i < 40; ++i) {
    from.emplace_back(UnitFloat(Hash(1, i)), UnitFloat(Hash(2, i)));
    to.push_back(Project(truth, from.back()));
    if (i != 3 && i != 39) continue;
    const auto map = FitHomography(from, to);
    ASSERT_TRUE(map);
    for (int k = 0; k < 9; ++k)
      EXPECT_NEAR((*map)[k / 3][k % 3], truth[k / 3][k % 3], 1e-6 * (1 + std::abs(truth[k / 3][k % 3])));
  }
}

TEST(Homography, WhatDoesNotDetermineItGivesNone) {
  const std::array<glm::dvec2, 4> line{{{0, 0}, {1, 1}, {2, 2}, {3, 3}}}, square{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  EXPECT_FALSE(FitHomography(line, square));
  EXPECT_FALSE(FitHomography(std::span(square).first(3), std::span(square).first(3)));
  std::array<double, 4> singular{1, 2, 2, 4};
  std::array<double, 2> right{1, 2};
  EXPECT_FALSE(SolveLinear(singular.data(), right.data(), 2));
}

}  // namespace
}  // namespace scumble
