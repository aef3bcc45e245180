// The nearest patch by bounds and tiles against one loop over everything.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "tests/measure/energy_fixtures.h"

namespace scumble::testing {
namespace {

struct Found {
  double energy = std::numeric_limits<double>::infinity();
  int exemplar = -1, x = -1, y = -1;
};

bool Inside(const Picture& picture, int x, int y) {
  return x >= 0 && y >= 0 && x < picture.width && y < picture.height;
}

// The header's formula word by word; `reach` is half the patch's side.
Found Plain(const EnergyScene& target, const std::vector<EnergyScene>& exemplars, int x, int y, double lambda,
            int reach) {
  Found found;
  for (std::size_t e = 0; e < exemplars.size(); ++e) {
    const EnergyScene& exemplar = exemplars[e];
    exemplar.ForEach([&](int u, int v) {
      double color = 0.0, guide = 0.0;
      int places = 0;
      for (int dy = -reach; dy <= reach; ++dy) {
        for (int dx = -reach; dx <= reach; ++dx) {
          if (!Inside(target.picture, x + dx, y + dy) || target.coverage[target.Index(x + dx, y + dy)] < 0.999f)
            continue;
          if (!Inside(exemplar.picture, u + dx, v + dy) || !exemplar.usable[exemplar.Index(u + dx, v + dy)]) return;
          for (int c = 0; c < 3; ++c) {
            const double d = (target.picture.At(x + dx, y + dy)[c] - exemplar.picture.At(u + dx, v + dy)[c]) / 65535.0;
            color += d * d;
          }
          ++places;
        }
      }
      const glm::dvec3 n = target.Normal(x, y) - exemplar.Normal(u, v);
      const double beyond = std::max(0.0, glm::length(n) - std::max(target.FreeAt(x, y), exemplar.FreeAt(u, v)));
      guide = beyond * beyond;
      for (std::size_t g = 0; g < target.more.size(); ++g) {
        guide += std::pow(double(target.more[g][target.Index(x, y)]) - exemplar.more[g][exemplar.Index(u, v)], 2);
      }
      const double energy = 25.0 / places * color + lambda * guide;
      if (energy < found.energy) found = {energy, static_cast<int>(e), u, v};
    });
  }
  return found;
}

glm::vec3 SomeNormal(std::uint64_t seed, double bend, int x, int y) {
  return glm::normalize(glm::vec3(bend * std::sin(0.31 * x + double(seed)), bend * std::cos(0.23 * y - 0.1 * x), 1.0));
}

// `smooth` 1 is a ramp, 0 is noise.
EnergyScene Chance(std::uint64_t seed, int width, int height, double smooth, double holes, std::size_t more) {
  EnergyScene scene(width, height);
  scene.Paint([&](int x, int y) {
    auto color = NoiseColor(seed, x, y);
    for (int c = 0; c < 3; ++c) {
      const double ramp = 30000.0 + 20000.0 * std::sin(0.2 * x + 0.3 * y + c);
      color[std::size_t(c)] = static_cast<int>(smooth * ramp + (1.0 - smooth) * color[std::size_t(c)]);
    }
    return color;
  });
  scene.more.assign(more, std::vector<float>(std::size_t(width) * height));
  scene.ForEach([&](int x, int y) {
    const std::size_t i = scene.Index(x, y);
    scene.SetNormal(x, y, SomeNormal(seed, 1.2, x, y));
    for (std::size_t g = 0; g < more; ++g) scene.more[g][i] = 3.0f * UnitFloat(Hash(seed, x / 4, y / 4, 7 + g));
    if (UnitFloat(Hash(seed, x, y, 99)) < holes) scene.coverage[i] = 0.5f, scene.usable[i] = 0;
  });
  return scene;
}

// Exchanges both sides: measured pixels become usable ones.
EnergyScene TurnedRound(EnergyScene scene) {
  for (std::size_t i = 0; i < scene.usable.size(); ++i) {
    const bool was_measured = scene.coverage[i] >= 0.999f;
    scene.coverage[i] = scene.usable[i] ? 1.0f : 0.0f, scene.usable[i] = was_measured;
  }
  return scene;
}

std::array<int, 3> CellOf(glm::dvec3 n) {
  return {int(std::floor(8.0 * n.x + 10.0)), int(std::floor(8.0 * n.y + 10.0)), int(std::floor(8.0 * n.z + 10.0))};
}

// Whether some normal of the target is in this cube of side 1/8 or in one beside it.
bool IsAskedFor(const EnergyScene& target, glm::dvec3 normal) {
  bool is_asked_for = false;
  target.ForEach([&](int x, int y) {
    if (target.coverage[target.Index(x, y)] < 0.999f) return;
    const auto a = CellOf(normal), b = CellOf(target.Normal(x, y));
    is_asked_for |= std::abs(a[0] - b[0]) <= 1 && std::abs(a[1] - b[1]) <= 1 && std::abs(a[2] - b[2]) <= 1;
  });
  return is_asked_for;
}

// The other direction, where `side` is the target's largest patch.
void ExpectMissing(const EnergyScene& target, const std::vector<EnergyScene>& exemplars, double lambda, int side) {
  std::vector<EnergyExemplar> views;
  for (const EnergyScene& exemplar : exemplars) views.push_back(exemplar.Exemplar());
  EnergyOptions options;
  options.lambda = lambda, options.samples = 0;
  const EnergyReport report = MustMeasure(target.Target(), views, options);
  double sum = 0.0;
  std::size_t count = 0;
  for (const EnergyScene& exemplar : exemplars) {
    exemplar.ForEach([&](int u, int v) {
      if (!exemplar.usable[exemplar.Index(u, v)] || !IsAskedFor(target, exemplar.Normal(u, v))) return;
      sum += Plain(TurnedRound(exemplar), {TurnedRound(target)}, u, v, lambda, side / 2).energy, ++count;
    });
  }
  EXPECT_EQ(report.asked_for, count);
  EXPECT_NEAR(report.missing.mean, sum / double(count), 1e-9 * sum / double(count));
  EXPECT_EQ(report.both.mean, report.energy.mean + report.missing.mean);
}

// Every pixel's nearest patch, with and without guesses, must be the plain loop's. The two add up in another order: at
// most 200 terms, whose rounding is below 200 · 2⁻⁵³ of the sum.
void ExpectExact(const EnergyScene& target, const std::vector<EnergyScene>& exemplars, double lambda, int side,
                 const SourcePlanes* guesses = nullptr) {
  std::vector<EnergyExemplar> views;
  for (const EnergyScene& exemplar : exemplars) views.push_back(exemplar.Exemplar());
  EnergyOptions options;
  options.lambda = lambda, options.samples = 0, options.sources = guesses;
  const EnergyReport report = MustMeasure(target.Target(), views, options);
  EXPECT_EQ(report.patch_side, side);
  EXPECT_EQ(report.samples.size(), report.measured);
  double sum = 0.0;
  for (const EnergySample& sample : report.samples) {
    const Found plain = Plain(target, exemplars, sample.x, sample.y, lambda, side / 2);
    ASSERT_NEAR(sample.color + lambda * sample.guide, plain.energy, plain.energy * 200 * 0x1p-53)
        << sample.x << ", " << sample.y;
    ASSERT_EQ(std::tie(sample.exemplar, sample.source_x, sample.source_y), std::tie(plain.exemplar, plain.x, plain.y));
    sum += plain.energy;
  }
  EXPECT_NEAR(report.energy.mean, sum / double(report.measured), 1e-9 * sum / double(report.measured));
  EXPECT_EQ(report.energy.standard_error, 0.0) << "every pixel was looked at";
}

TEST(EnergyExact, NoiseAndRampsAtAnyLambda) {
  for (const double lambda : {0.0, 0.1, 10.0, 3000.0}) {
    for (const double smooth : {0.0, 0.9, 1.0}) {
      ExpectExact(Chance(1, 13, 11, smooth, 0.0, 0), {Chance(2, 37, 29, smooth, 0.0, 0)}, lambda, 5);
      // A picture that is nothing like the exemplar: there bounds help least.
      ExpectExact(Chance(1, 9, 9, 0.0, 0.0, 0), {Chance(2, 37, 29, 1.0, 0.0, 0)}, lambda, 5);
    }
  }
}

TEST(EnergyExact, CutPatchesAndPositionsThatDoNotFit) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    ExpectExact(Chance(seed, 15, 15, 0.8, 0.1, 0), {Chance(seed + 10, 33, 27, 0.8, 0.02, 0)}, 2.0, 5);
  }
  EnergyScene ball = Ball(19), exemplar = Ball(33);
  ball.Paint([](int x, int y) { return NoiseColor(3, x / 2, y / 2); });
  exemplar.Paint([](int x, int y) { return NoiseColor(4, x / 3, y / 2); });
  ExpectExact(ball, {exemplar}, 2.0, 5);
}

TEST(EnergyExact, SeveralExemplarsOfSeveralSizesWithMoreGuides) {
  ExpectExact(Chance(5, 14, 12, 0.7, 0.05, 2), {Chance(6, 21, 18, 0.7, 0.01, 2), Chance(7, 30, 16, 0.7, 0.0, 2)}, 1.0,
              5);
}

// The free distance of normals, small at some pixels and large at some: 0 for half of them, as on curved objects.
EnergyScene WithFreedom(EnergyScene scene, std::uint64_t seed, double most) {
  scene.free.resize(scene.coverage.size());
  for (std::size_t i = 0; i < scene.free.size(); ++i) {
    scene.free[i] = static_cast<float>(std::max(0.0, most * (2.0 * UnitFloat(Hash(seed, i)) - 1.0)));
  }
  return scene;
}

TEST(EnergyExact, WithNormalsThatMayBeOff) {
  for (const double lambda : {0.0, 0.1, 10.0, 3000.0}) {
    for (const double most : {0.01, 0.26, 2.0}) {
      const EnergyScene target = WithFreedom(Chance(1, 13, 11, 0.7, 0.05, 0), 21, most);
      ExpectExact(target, {Chance(2, 37, 29, 0.7, 0.01, 0)}, lambda, 5);
    }
  }
  const EnergyScene target = WithFreedom(Chance(5, 14, 12, 0.7, 0.05, 2), 22, 0.26);
  ExpectExact(target, {Chance(6, 21, 18, 0.7, 0.01, 2), Chance(7, 30, 16, 0.7, 0.0, 2)}, 1.0, 5);
  ExpectMissing(WithFreedom(Chance(1, 19, 14, 0.8, 0.0, 0), 23, 0.26), {Chance(2, 13, 12, 0.8, 0.0, 0)}, 10.0, 5);
  ExpectMissing(target, {Chance(6, 9, 11, 0.7, 0.05, 2), Chance(7, 8, 7, 0.7, 0.0, 2)}, 1.0, 5);
}

TEST(EnergyExact, WhatIsMissing) {
  ExpectMissing(Chance(1, 19, 14, 0.8, 0.0, 0), {Chance(2, 13, 12, 0.8, 0.0, 0)}, 10.0, 5);
  ExpectMissing(Chance(5, 17, 12, 0.7, 0.02, 1), {Chance(6, 9, 11, 0.7, 0.05, 1), Chance(7, 8, 7, 0.7, 0.0, 1)}, 1.0,
                5);
  ExpectMissing(Chance(8, 3, 9, 0.7, 0.0, 0), {Chance(9, 10, 11, 0.7, 0.0, 0)}, 1.0, 3);
}

// Light of a near light source: large guides make the slack of the bounds large, and still no position may be missed.
TEST(EnergyExact, LargeGuides) {
  EnergyScene target = Chance(5, 10, 10, 0.5, 0.0, 1), exemplar = Chance(6, 25, 25, 0.5, 0.0, 1);
  for (float& value : target.more[0]) value = 9e5f + 0.1f * value;
  for (float& value : exemplar.more[0]) value = 9e5f + 0.1f * value;
  ExpectExact(target, {exemplar}, 3.0, 5);
}

TEST(EnergyExact, ExemplarsTooSmallForThePatch) {
  ExpectExact(Chance(8, 9, 7, 0.5, 0.1, 0), {Chance(9, 4, 3, 0.5, 0.0, 0)}, 2.0, 3);
  ExpectExact(Chance(8, 9, 7, 0.5, 0.1, 0), {Chance(9, 2, 12, 0.5, 0.0, 0)}, 2.0, 1);
  ExpectExact(Chance(8, 9, 7, 0.5, 0.1, 0), {Chance(9, 1, 1, 0.5, 0.0, 0)}, 2.0, 1);
}

// Guesses may be anything, wrong exemplars and places outside among them.
TEST(EnergyExact, GuessesDoNotMatter) {
  const EnergyScene target = Chance(11, 16, 12, 0.6, 0.05, 0), exemplar = Chance(12, 26, 26, 0.6, 0.02, 0);
  std::vector<std::int16_t> x(16 * 12), y(16 * 12);
  std::vector<std::uint8_t> covered(16 * 12), which(16 * 12);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = static_cast<std::int16_t>(Hash(i, 0) % 60 - 15), y[i] = static_cast<std::int16_t>(Hash(i, 1) % 60 - 15);
    covered[i] = Hash(i, 2) % 4 != 0, which[i] = Hash(i, 3) % 3;
  }
  const SourcePlanes sources{16, 12, x, y, covered, which};
  ExpectExact(target, {exemplar}, 2.0, 5, &sources);
}

// Where all is equal the first position where the patch fits is the answer, in whatever order the tiles come.
TEST(EnergyExact, OfEqualPatchesTheFirst) {
  EnergyScene flat(40, 40);
  flat.Paint([](int, int) { return std::array<int, 3>{1000, 2000, 3000}; });
  const EnergyExemplar two[] = {flat.Exemplar(), flat.Exemplar()};
  EnergyOptions options;
  options.samples = 0;
  for (const EnergySample& sample : MustMeasure(flat.Target(), two, options).samples) {
    EXPECT_EQ(sample.exemplar, 0);
    EXPECT_EQ(sample.source_x, std::min(sample.x, 2)) << "as far left as the patch, cut at the border, allows";
    EXPECT_EQ(sample.source_y, std::min(sample.y, 2));
  }
}

}  // namespace
}  // namespace scumble::testing
