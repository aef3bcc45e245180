// Nearest neighbours, the guide test, seeds, and the methods' neutral cases.
#include <limits>

#include "tests/support/transfer_fixtures.h"
#include "transfer/nearest/guide_distance.h"
#include "transfer/seeds/seeds.h"

namespace scumble {
namespace {

using namespace testing;

// The exact argmin over all usable pixels, ties to the lowest (y, x).
Source ExactNearest(const PreparedExemplar& exemplar, glm::vec3 n) {
  Source best;
  double best_distance = std::numeric_limits<double>::max();
  for (int y = 0; y < exemplar.size(); ++y) {
    for (int x = 0; x < exemplar.size(); ++x) {
      if (!exemplar.Usable(x, y)) continue;
      const glm::dvec3 d = glm::dvec3(n) - glm::dvec3(exemplar.Normal(x, y));
      if (const double distance = glm::dot(d, d); distance < best_distance) best_distance = distance, best = {x, y};
    }
  }
  return best;
}

TEST(NearestNeighbour, IsThePixelItselfAtPixelCentres) {
  for (const int size : {1, 2, 3, 16, 63, 64, 255, 512}) {
    const PreparedExemplar exemplar(PositionPicture(size), 0.0, size);
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        if (!exemplar.Usable(x, y)) continue;
        const Source found = exemplar.NearestNeighbour(exemplar.Normal(x, y));
        ASSERT_EQ(found.x, x) << "size " << size << " at " << x << ", " << y;
        ASSERT_EQ(found.y, y) << "size " << size << " at " << x << ", " << y;
      }
    }
  }
}

TEST(NearestNeighbour, IsWithinOnePixelOfTheExactOne) {
  for (const int size : {16, 33, 64}) {
    const PreparedExemplar exemplar(PositionPicture(size), 2.0, size);
    int inside = 0;
    for (int i = 0; i < 2000; ++i) {
      glm::vec3 n = AnyDirection(Hash(size, i));
      n.z = std::fabs(n.z);
      if (std::hypot(n.x, n.y) > 1.0 - 6.0 / size) continue;  // two pixels of rim, one to spare
      ++inside;
      const Source found = exemplar.NearestNeighbour(n), exact = ExactNearest(exemplar, n);
      ASSERT_LE(std::abs(found.x - exact.x), 1) << n.x << " " << n.y << " " << n.z;
      ASSERT_LE(std::abs(found.y - exact.y), 1) << n.x << " " << n.y << " " << n.z;
    }
    EXPECT_GT(inside, 300);
  }
}

TEST(NearestNeighbour, BeyondTheRimIsThePixelAtTheRimInThatDirection) {
  for (const int size : {16, 33, 64, 512}) {
    const PreparedExemplar exemplar(PositionPicture(size), 2.0, size);
    const double rim = size / 2.0 - 2.0;
    for (int i = 0; i < 2000; ++i) {
      const glm::vec3 n = AnyDirection(Hash(size, i));
      const double length = std::hypot(n.x, n.y);
      if (n.z >= 0 && length < 2 * rim / size) continue;
      const Source found = exemplar.NearestNeighbour(n);
      const double dx = found.x + 0.5 - (size / 2.0 + n.x / length * rim);
      const double dy = found.y + 0.5 - (size / 2.0 - n.y / length * rim);
      ASSERT_LT(std::hypot(dx, dy), 1.5) << n.x << " " << n.y << " " << n.z << " size " << size;
    }
  }
}

TEST(NearestNeighbour, LooksNormalsFacingAwayUpOnTheRim) {
  const PreparedExemplar exemplar(PositionPicture(64), 0.0, 64);
  const auto radius = [&](Source s) { return std::hypot(s.x - 31.5, s.y - 31.5); };
  for (int i = 0; i < 500; ++i) {
    glm::vec3 n = AnyDirection(Hash(i));
    n.z = -std::fabs(n.z) - 1e-6f;
    const Source found = exemplar.NearestNeighbour(n);
    EXPECT_GT(radius(found), 29.5);
    const double length = std::hypot(n.x, n.y);
    EXPECT_NEAR((found.x - 31.5) / radius(found), n.x / length, 0.08);
    EXPECT_NEAR((found.y - 31.5) / radius(found), -n.y / length, 0.08);
  }
  const Source behind = exemplar.NearestNeighbour({0, 0, -1});
  EXPECT_LE(behind.y, 1) << "straight away from the viewer is the rim at +Y, the top";
  EXPECT_NEAR(behind.x, 31.5, 1.0);
}

TEST(NearestNeighbour, AnyInputGivesAUsablePixel) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const int size : {1, 2, 5, 64}) {
    for (const double rim : {0.0, 2.0, 1000.0}) {
      const PreparedExemplar exemplar(PositionPicture(size), rim, size);
      for (const float x : {0.0f, 1.0f, -3.0f, 1e30f, nan, inf, -inf, 1e-40f}) {
        for (const float z : {0.0f, 1.0f, -1.0f, nan, inf}) {
          const Source found = exemplar.NearestNeighbour({x, 0.5f, z});
          EXPECT_TRUE(exemplar.Usable(found.x, found.y)) << size << " " << rim << " " << x << " " << z;
        }
      }
    }
  }
}

TEST(NearestNeighbour, TiesGoToTheLowestRowAndColumn) {
  const PreparedExemplar exemplar(PositionPicture(8), 0.0, 8);
  EXPECT_EQ(exemplar.NearestNeighbour({0, 0, 1}), (Source{3, 3}));
}

TEST(NormalsCompared, AreThoseOfTheSphereOrTheNearestOfItsRim) {
  const PreparedExemplar exemplar(PositionPicture(64), 8.0, 64);
  const double rim = 24.0 / 32.0, height = std::sqrt(1.0 - rim * rim);
  int beyond = 0;
  for (int i = 0; i < 2000; ++i) {
    const glm::vec3 n = AnyDirection(Hash(i));
    const glm::vec3 found = exemplar.WithinRim(n);
    const double length = std::hypot(n.x, n.y);
    if (n.z >= 0.0f && length < rim) {
      EXPECT_EQ(found, n);
      continue;
    }
    ++beyond;
    EXPECT_NEAR(found.x, n.x / length * rim, 1e-5);
    EXPECT_NEAR(found.y, n.y / length * rim, 1e-5);
    EXPECT_NEAR(found.z, height, 1e-5);
  }
  EXPECT_GT(beyond, 500);
}

TEST(UsableDisc, EndsAtOneMinusRim) {
  for (const int size : {64, 101}) {
    const PreparedExemplar exemplar(PositionPicture(size), 5.0, size);
    for (int y = -2; y < size + 2; ++y) {
      for (int x = -2; x < size + 2; ++x) {
        const double radius = std::hypot(x + 0.5 - size / 2.0, y + 0.5 - size / 2.0);
        if (std::fabs(radius - (size / 2.0 - 5.0)) < 1e-6) continue;
        EXPECT_EQ(exemplar.Usable(x, y), radius < size / 2.0 - 5.0) << x << " " << y;
      }
    }
  }
}

TEST(GuideTest, IsStrict) {
  const glm::vec3 a{0, 0, 0};
  const GuideTest half(0.5f, ThresholdMetric::kL2);
  EXPECT_FALSE(half.Alike(a, {0.5f, 0, 0}));
  EXPECT_TRUE(half.Alike(a, {std::nextafter(0.5f, 0.0f), 0, 0}));
  const GuideTest l1(0.5f, ThresholdMetric::kL1);
  EXPECT_FALSE(l1.Alike(a, {0.25f, 0.25f, 0}));
  EXPECT_TRUE(l1.Alike(a, {0.25f, 0.2f, 0}));
}

TEST(GuideTest, HoldsAtTheExtremes) {
  const glm::vec3 n{0.6f, 0.0f, 0.8f};
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (const auto metric : {ThresholdMetric::kL1, ThresholdMetric::kL2}) {
    EXPECT_FALSE(GuideTest(0.0f, metric).Alike(n, n)) << "0 accepts nothing, not even equal guides";
    EXPECT_TRUE(GuideTest(1e-44f, metric).Alike(n, n)) << "a denormal threshold accepts equal guides";
    EXPECT_FALSE(GuideTest(1e-44f, metric).Alike(n, {0.6f, 1e-10f, 0.8f})) << "and nothing else";
    EXPECT_TRUE(GuideTest(inf, metric).Alike(n, -n));
    EXPECT_FALSE(GuideTest(inf, metric).Alike(n, {nan, 0, 0}));
  }
}

TEST(Seeds, StayInTheirCellAndFollowTheirInputs) {
  SeedRules rules{7, 3, 1.0f};
  int moved_by_time = 0, moved_by_seed = 0;
  for (int level = 0; level <= 8; ++level) {
    const int h = 1 << level;
    for (int cell = -1; cell < 20; ++cell) {
      const PixelPosition p = SeedOfCell(rules, level, cell, 2 * cell);
      EXPECT_GE(p.x, cell * h);
      EXPECT_LT(p.x, (cell + 1) * h);
      EXPECT_GE(p.y, 2 * cell * h);
      EXPECT_LT(p.y, (2 * cell + 1) * h);
      const PixelPosition later = SeedOfCell({7, 4, 1.0f}, level, cell, 2 * cell);
      const PixelPosition other = SeedOfCell({8, 3, 1.0f}, level, cell, 2 * cell);
      moved_by_time += later.x != p.x || later.y != p.y;
      moved_by_seed += other.x != p.x || other.y != p.y;
      const PixelPosition still = SeedOfCell({7, 3, 0.0f}, level, cell, 2 * cell);
      EXPECT_EQ(still.x, cell * h);
      EXPECT_EQ(still.y, 2 * cell * h);
    }
  }
  EXPECT_GT(moved_by_time, 130);
  EXPECT_GT(moved_by_seed, 130);
}

TEST(Seeds, NearestIsTheFirstOfTheClosestInThreeByThreeCells) {
  const SeedRules rules{1, 0, 1.0f};
  for (const int level : {1, 2, 4, 6}) {
    const SeedGrid grid(rules, level, {0, 0, 150, 90});
    for (int y = 0; y < 90; y += 3) {
      for (int x = 0; x < 150; ++x) {
        PixelPosition best{};
        long best_distance = std::numeric_limits<long>::max();
        for (int cy = (y >> level) - 1; cy <= (y >> level) + 1; ++cy) {
          for (int cx = (x >> level) - 1; cx <= (x >> level) + 1; ++cx) {
            const PixelPosition seed = SeedOfCell(rules, level, cx, cy);
            const long distance = long(seed.x - x) * (seed.x - x) + long(seed.y - y) * (seed.y - y);
            if (distance < best_distance) best_distance = distance, best = seed;
          }
        }
        const PixelPosition found = grid.Position(grid.Nearest(x, y));
        ASSERT_EQ(found.x, best.x);
        ASSERT_EQ(found.y, best.y);
      }
    }
  }
}

TEST(StyleBlit, WithThresholdZeroIsLitSphere) {
  const GuideSet guides = HillGuides(131, 97);
  Style style = PlainStyle(NoisePicture(128));
  style.transfer.threshold = 0.0f;
  const Transferred blit = MustTransfer(style, guides);
  style.transfer.method = Method::kBruteForce;
  const Transferred brute = MustTransfer(style, guides);
  style.transfer.method = Method::kLitSphere;
  const Transferred lit = MustTransfer(style, guides);
  EXPECT_TRUE(SameField(blit.field, lit.field));
  EXPECT_TRUE(brute.field.x == lit.field.x && brute.field.y == lit.field.y);
  EXPECT_EQ(blit.picture.rgba, lit.picture.rgba);
}

// Identity: the sphere's own guides with an exemplar that encodes its position give the exemplar back. A flip, a shift
// or half a pixel anywhere would show.
TEST(StyleBlit, GivesThePaintedSphereBackAtEvenAndOddSizes) {
  for (const int size : {1, 2, 63, 64, 101, 256}) {
    const GuideSet guides = SphereGuides(size);
    for (const auto method : {Method::kLitSphere, Method::kStyleBlit, Method::kBruteForce}) {
      Style style = PlainStyle(PositionPicture(size));
      style.transfer.method = method;
      style.transfer.rim = 0.0;
      const Transferred result = MustTransfer(style, guides);
      for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
          const std::uint16_t* texel = result.picture.At(x, y);
          if (!(guides.Plane(Layer::kCoverage)[guides.Index(x, y)] > 0.0f)) {
            ASSERT_EQ(texel[3], 0);
            continue;
          }
          ASSERT_EQ(texel[0], x) << "size " << size << " method " << static_cast<int>(method);
          ASSERT_EQ(texel[1], y) << "size " << size << " method " << static_cast<int>(method);
        }
      }
    }
  }
}

}  // namespace
}  // namespace scumble
