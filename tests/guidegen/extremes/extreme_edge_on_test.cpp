// Triangles seen edge on, or nearly so. Embree decides in float that a ray hits one of them. The place is computed in
// double, and must be a point of the triangle with the least distance from the ray. The truth is computed in long
// double, from the ray's distance to the three edges; it shares no code with the engine.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "guidegen/surface/surface.h"
#include "tests/support/exact_rays.h"

namespace scumble::testing {
namespace {

using LongVec = glm::vec<3, long double>;

// From the ray's line to a place, and to the whole triangle, metres. A line that crosses a triangle crosses, as seen
// along it, between its edges: then the distance is 0.
long double DistanceTo(const ViewRay& ray, const LongVec& place) {
  const LongVec way(ray.direction);
  return glm::length(glm::cross(place - LongVec(ray.origin), way)) / glm::length(way);
}

long double DistanceTo(const ViewRay& ray, const Triangle& triangle) {
  const LongVec way = glm::normalize(LongVec(ray.direction));
  LongVec across[3];
  for (int i = 0; i < 3; ++i) {
    const LongVec from = LongVec(triangle.corner[i]) - LongVec(ray.origin);
    across[i] = from - way * glm::dot(from, way);
  }
  long double least = INFINITY;
  int left = 0, right = 0;
  for (int i = 0; i < 3; ++i) {
    const LongVec edge = across[(i + 1) % 3] - across[i];
    const long double length = glm::dot(edge, edge);
    const long double share = length > 0 ? glm::clamp(-glm::dot(across[i], edge) / length, 0.0L, 1.0L) : 0.0L;
    least = std::min(least, glm::length(across[i] + edge * share));
    (glm::dot(glm::cross(across[i], edge), way) > 0 ? left : right) += 1;
  }
  return left == 3 || right == 3 ? 0.0L : least;
}

struct Sight {
  Mesh mesh;
  Material material;
  PlacedObject object;
  ViewRay ray;
  double farthest = 0.0;  // corner from the ray's origin, m
};

// A triangle of some 2 m, `cosine` of the ray's angle to its normal, 5 m before the eye; the ray is aimed at a random
// place of it, or of one of its edges, and `beside` metres away.
Sight RandomSight(std::mt19937& random, double cosine, double beside, bool at_edge) {
  std::uniform_real_distribution<double> spread(-1.0, 1.0);
  Sight sight;
  const auto flat = [&] { return glm::vec3(spread(random), 0.0, spread(random)); };
  sight.mesh.positions = {flat(), flat(), flat()};
  sight.mesh.triangles = {{0, 1, 2}};
  const double leaning = std::asin(cosine);
  glm::dmat4 placed =
      glm::rotate(Moved(0.4 * spread(random), 0.4 * spread(random), -5.0), 3.0 * spread(random), glm::dvec3(0, 0, 1));
  placed = glm::rotate(placed, leaning, glm::dvec3(1, 0, 0));
  sight.object = Place(&sight.mesh, &sight.material, {}, placed);
  const Triangle triangle = ViewTriangle(sight.object, 0);
  double weight[3] = {std::abs(spread(random)), std::abs(spread(random)), at_edge ? 0.0 : std::abs(spread(random))};
  const double sum = weight[0] + weight[1] + weight[2];
  glm::dvec3 aim(0.0);
  for (int i = 0; i < 3; ++i) aim += triangle.corner[i] * (weight[i] / sum);
  // The ray runs parallel to the view, so that the cosine is what was asked for wherever the triangle stands.
  sight.ray.origin = {aim.x + beside * spread(random), aim.y + beside * spread(random), 0.0};
  for (const glm::dvec3& corner : triangle.corner) {
    sight.farthest = std::max(sight.farthest, glm::distance(corner, sight.ray.origin));
  }
  return sight;
}

// What is shown lies on the triangle, and is no farther from the ray than the triangle is, but for a step of float of
// the distance: where a triangle is seen as higher than 2^-24 of its length, double's rounding, 2^-47 of the distance
// over that share, is below 2^-23; where it is lower, all its places are as near as its edges, to that share's half.
TEST(EdgeOn, TheRayMeetsWhatItPassesNearest) {
  std::mt19937 random(41);
  for (int power = 0; power <= 56; power += 2) {
    const double cosine = power == 56 ? 0.0 : std::ldexp(0.9, -power);
    double worst = 0.0;
    for (int trial = 0; trial < 600; ++trial) {
      const double beside = trial % 3 == 0 ? 0.0 : std::ldexp(6.0, trial % 3 == 1 ? -24 : -21);
      const Sight sight = RandomSight(random, cosine, beside, trial % 2 == 0);
      const SurfacePoint point = FindSurfacePoint(sight.object, 0, sight.ray);
      const Triangle triangle = ViewTriangle(sight.object, 0);
      const long double extra = DistanceTo(sight.ray, LongVec(point.position)) - DistanceTo(sight.ray, triangle);
      worst = std::max(worst, double(extra) / sight.farthest);
      for (const double share :
           {point.barycentric.x, point.barycentric.y, 1.0 - point.barycentric.x - point.barycentric.y}) {
        ASSERT_GE(share, -1e-15);
        ASSERT_LE(share, 1.0 + 1e-15);
      }
      ASSERT_TRUE(std::isfinite(point.normal.x + point.normal.y + point.normal.z));
    }
    EXPECT_LE(worst, std::ldexp(1.0, -23)) << "cosine " << cosine;
    RecordProperty("worst_2^-24_at_2^-" + std::to_string(power), std::to_string(std::ldexp(worst, 24)));
  }
}

// A wall whose plane holds the eye and the rays of the picture's middle column, from exactly so to a float's step
// beside it. Whatever float decides about that column, the visible part of the wall is where the ray passes it, and
// before the eye.
TEST(EdgeOn, AWallInTheEyesPlaneIsShownOnItsRays) {
  int met = 0;
  for (const double lean : {0.0, 1e-12, 1e-9, 2e-8, 1e-7, 1e-6, 1e-5}) {
    for (const double turn : {0.0, 0.3, 1.1}) {
      for (const double near_end : {-1.5, 2.0}) {  // the wall passes the eye, or begins before it
        Mesh wall = QuadMesh();
        const glm::dmat4 about_view = glm::rotate(glm::dmat4(1.0), turn, glm::dvec3(0, 0, 1));
        glm::dmat4 placed = about_view * Moved(0, 0.13, -near_end - 3.0);
        placed = glm::rotate(placed, glm::radians(90.0) + lean, glm::dvec3(0, 1, 0));
        placed = glm::scale(placed, glm::dvec3(3.0, 3.0, 1.0));
        Scene scene = SceneOf(wall, placed);
        Camera camera = FrontCamera(0.0);
        camera.world_from_camera = about_view;
        const GuideSet guides = Render(scene, camera, Sized(33, 33, {Layer::kPosition})).guides;
        for (int pixel = 0; pixel < 33 * 33; ++pixel) {
          if (guides.Plane(Layer::kCoverage)[std::size_t(pixel)] == 0.0f) continue;
          const ExactRay ray = PixelRay(camera, 33, 33, pixel % 33, pixel / 33);
          const glm::dvec3 at(guides.Vec3(Layer::kPosition, std::size_t(pixel)));
          ++met;
          ASSERT_LE(ray.DistanceTo(at), 10.0 * kFloatSight) << "lean " << lean << ", turn " << turn << ", " << pixel;
          ASSERT_GE(glm::dot(at, ray.direction), -1e-14) << "behind the eye";  // some roundings of its place
        }
      }
    }
  }
  EXPECT_GT(met, 33);
}

}  // namespace
}  // namespace scumble::testing
