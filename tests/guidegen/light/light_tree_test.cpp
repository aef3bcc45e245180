// Many lights: the tree's choice of one, against the weights of all lights.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include "core/image/hash.h"
#include "guidegen/light/light_sampling.h"
#include "guidegen/light/sampler.h"

namespace scumble::testing {
namespace {

double Chance(int light, int what) { return UnitFloat(Hash(light, what)); }

// Lights of every kind about the origin.
std::vector<PlacedLight> Swarm(int count) {
  std::vector<PlacedLight> lamps;
  for (int i = 0; i < count; ++i) {
    PlacedLight lamp;
    lamp.type = LightType(i % 4);
    lamp.position = 6.0 * (glm::dvec3(Chance(i, 0), Chance(i, 1), Chance(i, 2)) - 0.5);
    lamp.axis = glm::normalize(glm::dvec3(Chance(i, 3), Chance(i, 4), Chance(i, 5)) - 0.5);
    lamp.color = glm::dvec3(0.1 + Chance(i, 6));
    lamp.cone_scale = 2.0;  // of spots: from a right angle to 60°
    lamp.cone_offset = 0.0;
    if (i % 3 != 0) lamp.radius = lamp.half_angle = 0.2 * Chance(i, 7) + 0.01;
    lamp.half_x = glm::dvec3(0.2, 0.1, 0.0);
    lamp.half_y = glm::dvec3(0.0, 0.0, 0.3);
    if (lamp.type == LightType::kArea)
      lamp.axis = glm::normalize(glm::cross(lamp.half_x, lamp.half_y)) * (i % 8 < 4 ? 1.0 : -1.0);
    lamps.push_back(lamp);
  }
  return lamps;
}

SurfacePoint Somewhere(int which) {
  SurfacePoint point;
  point.position = 4.0 * (glm::dvec3(Chance(which, 20), Chance(which, 21), Chance(which, 22)) - 0.5);
  point.facing = point.normal =
      glm::normalize(glm::dvec3(Chance(which, 23), Chance(which, 24), Chance(which, 25)) - 0.5);
  return point;
}

// A leaf alone, a tree with suns, and a large one.
const int kCounts[] = {3, 40, 500};

TEST(LightTree, ProbabilitiesAreThoseOfTheChoices) {
  for (const int count : kCounts) {
    const LightSet lights(Swarm(count), {}, glm::dvec3(0.0));
    for (int which = 0; which < 4; ++which) {
      const SurfacePoint point = Somewhere(which);
      for (const bool with_delta : {false, true}) {
        double sum = 0.0;
        for (int light = 0; light < count; ++light) sum += lights.Probability(point, light, with_delta);
        // Below 1 where a leaf was taken in which no light reaches the point.
        EXPECT_LE(sum, 1.0 + 1e-9);
        const int n = 4000;
        std::vector<double> taken(std::size_t(count), 0.0);
        double none = 0.0;
        for (int i = 0; i < n; ++i) {
          const LightChoice choice = lights.Choose(point, (i + 0.5) / n, with_delta);
          if (choice.light < 0) {
            none += 1.0 / n;
            continue;
          }
          ASSERT_NEAR(choice.probability, lights.Probability(point, choice.light, with_delta), 1e-9);
          ASSERT_TRUE(with_delta || !lights.IsDelta(choice.light));
          taken[std::size_t(choice.light)] += 1.0 / n;
        }
        EXPECT_NEAR(sum + none, 1.0, 40.0 / n) << count << " " << which;
        for (int light = 0; light < count; ++light) {
          EXPECT_NEAR(taken[std::size_t(light)], lights.Probability(point, light, with_delta), 2.0 / n) << light;
        }
      }
    }
  }
}

// The sum over all lights of the light drawn on each, and its estimate by one light that is chosen.
TEST(LightTree, ChosenLightsBringWhatAllLightsBring) {
  for (const int count : kCounts) {
    const LightSet lights(Swarm(count), {}, glm::dvec3(0.0));
    for (int which = 0; which < 3; ++which) {
      const SurfacePoint point = Somewhere(which);
      const auto irradiance = [&](int light, const Quad& u) {
        const LightDraw draw = lights.Draw(light, point, u[0], u[1]);
        const double cosine = std::max(0.0, glm::dot(point.normal, draw.direction));
        if (draw.is_delta) return draw.radiance.g * cosine;
        return draw.density > 0.0 ? draw.radiance.g * cosine / draw.density : 0.0;
      };
      const Sampler sampler{std::uint32_t(which)};
      double all = 0.0;
      for (int light = 0; light < count; ++light) {
        for (std::uint32_t i = 0; i < 64; ++i) all += irradiance(light, sampler.Draw(i, 1)) / 64;
      }
      double chosen = 0.0;
      const std::uint32_t n = 1 << 15;
      for (std::uint32_t i = 0; i < n; ++i) {
        const Quad u = sampler.Draw(i, 2);
        const LightChoice choice = lights.Choose(point, u[2], true);
        if (choice.light >= 0) chosen += irradiance(choice.light, u) / (choice.probability * n);
      }
      EXPECT_NEAR(chosen / all, 1.0, 0.02) << count << " " << which;
    }
  }
}

TEST(LightTree, RaysMeetTheSameLampsAsWhenEveryOneIsAsked) {
  const std::vector<PlacedLight> lamps = Swarm(500);
  const LightSet all(lamps, {}, glm::dvec3(0.0));
  std::vector<LightSet> alone;
  for (const PlacedLight& lamp : lamps) {
    alone.emplace_back(std::vector<PlacedLight>{lamp}, std::vector<PlacedObject>(), glm::dvec3(0.0));
  }
  std::size_t met = 0;
  for (int which = 0; which < 600; ++which) {
    const SurfacePoint ray = Somewhere(which);
    std::set<int> by_tree;
    all.VisitAnalytic(ray.position, ray.normal, 3.0,
                      [&](int light, const glm::dvec3&, double) { by_tree.insert(light); });
    std::set<int> one_by_one;
    for (int light = 0; light < int(lamps.size()); ++light) {
      alone[std::size_t(light)].VisitAnalytic(ray.position, ray.normal, 3.0,
                                              [&](int, const glm::dvec3&, double) { one_by_one.insert(light); });
    }
    EXPECT_EQ(by_tree, one_by_one) << which;
    met += by_tree.size();
  }
  EXPECT_GT(met, 100u);
}

}  // namespace
}  // namespace scumble::testing
