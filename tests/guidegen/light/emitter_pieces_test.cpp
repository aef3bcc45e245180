// Meshes that emit: the choice of their triangles, against the sum over every triangle.
#include "guidegen/light/emitter_pieces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "guidegen/light/sampler.h"
#include "tests/support/guidegen_scenes.h"

namespace scumble::testing {
namespace {

std::vector<Triangle> Globes(int count, double spacing, double radius) {
  const Mesh ball = BallMesh(12);
  std::vector<Triangle> triangles;
  for (int i = 0; i < count; ++i) {
    for (const glm::uvec3& corners : ball.triangles) {
      Triangle triangle;
      for (int k = 0; k < 3; ++k) {
        triangle.corner[k] = radius * glm::dvec3(ball.positions[corners[k]]) + glm::dvec3(spacing * i, 0.0, 0.0);
      }
      triangles.push_back(triangle);
    }
  }
  return triangles;
}

SurfacePoint At(const glm::dvec3& position, const glm::dvec3& normal) {
  SurfacePoint point;
  point.position = position;
  point.facing = point.normal = glm::normalize(normal);
  return point;
}

double AreaOf(const Triangle& triangle) {
  const auto& c = triangle.corner;
  return 0.5 * glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
}

// The irradiance of a place of a triangle per its area, both of its sides shining.
double LightOf(const Triangle& triangle, const SurfacePoint& point, double u, double v) {
  const auto& c = triangle.corner;
  const double root = std::sqrt(u);
  const glm::dvec3 to = c[0] + (c[1] - c[0]) * (root * (1.0 - v)) + (c[2] - c[0]) * (root * v) - point.position;
  const double square = glm::dot(to, to);
  const glm::dvec3 normal = glm::normalize(glm::cross(c[1] - c[0], c[2] - c[0]));
  return std::max(0.0, glm::dot(point.normal, to)) * std::abs(glm::dot(normal, to)) / (square * square);
}

const SurfacePoint kPoints[] = {
    At({0.3, 2.0, -0.4}, {0, -1, 0.2}),   // beside the first
    At({20.0, 0.5, 2.0}, {0, 0, -1}),     // among them
    At({-30.0, 1.0, 5.0}, {1, 0, 0}),     // far away
    At({12.0, 0.0, 0.0}, {1, 0.3, 0.2}),  // inside the third
    At({9.0, 0.0, -0.6}, {1, 0, 0.1}),    // half of them behind it
};

TEST(EmitterPieces, ChosenTrianglesBringWhatAllBring) {
  const std::vector<Triangle> triangles = Globes(9, 6.0, 0.4);
  const EmitterPieces pieces(triangles);
  for (const SurfacePoint& point : kPoints) {
    const Sampler sampler(7);
    double all = 0.0;
    for (const Triangle& triangle : triangles) {
      if (!(AreaOf(triangle) > 0.0)) continue;  // at the globes' poles
      for (std::uint32_t i = 0; i < 8; ++i) {
        const Quad u = sampler.Draw(i, 0);
        all += AreaOf(triangle) * LightOf(triangle, point, u[0], u[1]) / 8;
      }
    }
    const std::uint32_t n = 1 << 12;
    double chosen = 0.0, squares = 0.0;
    for (std::uint32_t i = 0; i < n; ++i) {
      const Quad u = sampler.Draw(i, 1);
      const EmitterPieces::Choice choice = pieces.Choose(point, u[0]);
      if (!(choice.area > 0.0)) continue;
      ASSERT_NEAR(pieces.AreaFor(point, choice.primitive) / choice.area, 1.0, 1e-9);
      const double light = choice.area * LightOf(triangles[choice.primitive], point, choice.remainder, u[1]) / all;
      chosen += light / n, squares += light * light / n;
    }
    EXPECT_NEAR(chosen, 1.0, 0.015) << point.position.x;
    EXPECT_LT(squares - 1.0, 3.0) << point.position.x << ": by area alone up to 22";
  }
}

TEST(EmitterPieces, DensitiesAddUpToOne) {
  const std::vector<Triangle> triangles = Globes(9, 6.0, 0.4);
  const EmitterPieces pieces(triangles);
  for (const SurfacePoint& point : kPoints) {
    double sum = 0.0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      if (AreaOf(triangles[i]) > 0.0) sum += AreaOf(triangles[i]) / pieces.AreaFor(point, std::uint32_t(i));
    }
    EXPECT_LE(sum, 1.0 + 1e-9);  // below 1 where a side was taken of which no piece is above the horizon
    EXPECT_GT(sum, 0.5);
  }
}

TEST(EmitterPieces, ANearGlobeIsTaken) {
  const std::vector<Triangle> triangles = Globes(9, 6.0, 0.4);
  const EmitterPieces pieces(triangles);
  int near = 0;
  const int n = 1000;
  for (int i = 0; i < n; ++i) {
    near += triangles[pieces.Choose(kPoints[0], (i + 0.5) / n).primitive].corner[0].x < 3.0;
  }
  EXPECT_GT(near, 0.8 * n);  // by area a ninth
}

// What has one piece is chosen by area, and what has no area never.
TEST(EmitterPieces, FewTrianglesAreChosenByArea) {
  std::vector<Triangle> triangles(3);
  triangles[0] = {{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}}};
  triangles[1] = {{{1, 1, 1}, {1, 1, 1}, {2, 2, 2}}};
  triangles[2] = {{{0, 0, 5}, {1, 0, 5}, {0, 1, 5}}};
  const EmitterPieces pieces(triangles);
  const SurfacePoint point = At({0, 0, -1}, {0, 0, 1});
  EXPECT_DOUBLE_EQ(pieces.area(), 5.0);
  EXPECT_EQ(pieces.Choose(point, 0.89).primitive, 0u);
  EXPECT_EQ(pieces.Choose(point, 0.91).primitive, 2u);
  EXPECT_DOUBLE_EQ(pieces.Choose(point, 0.5).area, 5.0);
  EXPECT_DOUBLE_EQ(pieces.AreaFor(point, 2), 5.0);
  EXPECT_TRUE(std::isinf(pieces.AreaFor(point, 1)));
  EXPECT_EQ(EmitterPieces(std::vector<Triangle>()).area(), 0.0);
}

}  // namespace
}  // namespace scumble::testing
