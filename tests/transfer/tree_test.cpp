// Trees over points against brute force, and the usable pixels of a painted scene.
#include <algorithm>
#include <cstring>
#include <limits>
#include <span>

#include "tests/support/every_instruction_set.h"
#include "tests/support/scene_exemplar_fixtures.h"
#include "transfer/exemplar/usable_mask.h"
#include "transfer/nearest/guide_tree.h"

namespace scumble {
namespace {

using namespace testing;

// ---- trees ---------------------------------------------------------------------------------------------------------

double SquaredDistance(const float* a, const float* b, int dimensions) {
  double sum = 0.0;
  for (int d = 0; d < dimensions; ++d) sum += (double(a[d]) - b[d]) * (double(a[d]) - b[d]);
  return sum;
}

// The first index with the least distance.
std::uint32_t BruteForce(const std::vector<float>& points, const float* query, int dimensions) {
  std::uint32_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < points.size() / dimensions; ++i) {
    const double distance = SquaredDistance(points.data() + std::size_t(i) * dimensions, query, dimensions);
    if (distance < least) least = distance, best = i;
  }
  return best;
}

void ExpectExact(const std::vector<float>& points, int dimensions, const std::vector<float>& queries) {
  const PointTree tree(dimensions, points);
  std::vector<std::uint32_t> expected;
  for (std::size_t q = 0; q + dimensions <= queries.size(); q += dimensions) {
    expected.push_back(BruteForce(points, queries.data() + q, dimensions));
  }
  OnEveryInstructionSet([&] {
    std::uint32_t last = 0, anywhere = 0;
    for (std::size_t q = 0; q < expected.size(); ++q) {
      const std::span<const float> query{queries.data() + q * dimensions, std::size_t(dimensions)};
      anywhere = static_cast<std::uint32_t>(Hash(q, anywhere) % (2 * points.size()));
      ASSERT_EQ(tree.Nearest(query), expected[q]) << dimensions << " dimensions, query " << q;
      ASSERT_EQ(tree.Nearest(query, last), expected[q]) << "from the last, query " << q;
      ASSERT_EQ(tree.Nearest(query, anywhere), expected[q]) << "from anywhere, query " << q;
    }
  });
}

// Values on a lattice of `steps` (so that ties and repeats abound), or anywhere in [-1, 1] for 0.
std::vector<float> Scatter(std::size_t count, int steps, std::uint64_t seed) {
  std::vector<float> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    const float u = UnitFloat(Hash(seed, i));
    values[i] = steps > 0 ? std::floor(u * steps) : 2.0f * u - 1.0f;
  }
  return values;
}

TEST(PointTree, EqualsBruteForceOnRandomPoints) {
  for (const int dimensions : {1, 2, 3, 4, 7, 15, 23, 40}) {
    for (const int count : {1, 2, 13, 16, 17, 200, 256, 257, 1500, 5000}) {
      const auto points = Scatter(std::size_t(count) * dimensions, 0, 11 + dimensions);
      ExpectExact(points, dimensions, Scatter(std::size_t(200) * dimensions, 0, 5));
      const std::size_t some = std::size_t(std::min(count, 500)) * std::size_t(dimensions);
      ExpectExact(points, dimensions, {points.begin(), points.begin() + std::ptrdiff_t(some)});
    }
  }
}

TEST(PointTree, TiesGoToTheFirstPoint) {
  for (const int dimensions : {1, 2, 3, 5}) {
    for (const int steps : {1, 2, 3, 5}) {
      const auto points = Scatter(std::size_t(900) * dimensions, steps, 3 + steps);
      auto queries = Scatter(std::size_t(300) * dimensions, 2 * steps, 8);
      for (float& value : queries) value *= 0.5f;  // halfway between the lattice's points: up to 2^dimensions ties
      ExpectExact(points, dimensions, queries);
    }
  }
}

TEST(PointTree, DegenerateSets) {
  EXPECT_EQ(PointTree(3, std::vector<float>(3 * 5000, 0.25f)).distinct(), 1u);
  ExpectExact(std::vector<float>(3 * 5000, 0.25f), 3, Scatter(30, 0, 1));
  ExpectExact({0.0f, -0.0f, 0.0f, -0.0f, 0.0f, -0.0f}, 3, {0, 0, 0, 1, 1, 1});
  EXPECT_EQ(PointTree(3, {0.0f, -0.0f, 0.0f, -0.0f, 0.0f, -0.0f}).distinct(), 1u);
  std::vector<float> line;  // all on one line, exponentially ever closer, and a copy of each
  for (int copy = 0; copy < 2; ++copy) {
    for (int i = 0; i < 120; ++i) line.insert(line.end(), {std::ldexp(1.0f, -i), 0.0f, 0.0f});
  }
  ExpectExact(line, 3, line);
  ExpectExact(line, 3, {0, 0, 0, 0.7f, 1e-3f, 0, -1, 0, 0, 0.75f, 0, 0, 1e30f, -1e30f, 1e30f});
  ExpectExact({1e30f, 1e30f, 1e30f, -1e30f, 0, 0, 1e-40f, 0, 0, 0, 0, 0}, 3, {0, 0, 0, 1e30f, 0, 0, 1e-41f, 0, 0});
}

// What guides are like: a surface in many dimensions; queries on it, a little off it, and far off.
TEST(PointTree, SurfacesInManyDimensions) {
  constexpr int kDimensions = 15, kSide = 120;
  const auto surface = [](float u, float v, float noise, std::uint64_t seed) {
    std::vector<float> point;
    for (int d = 0; d < kDimensions; ++d) {
      point.push_back(std::sin(float(d % 4) * u + d) * std::cos(float(d % 3) * v) + noise * UnitFloat(Hash(seed, d)));
    }
    return point;
  };
  std::vector<float> points, queries;
  for (int i = 0; i < kSide * kSide; ++i) {
    const auto point = surface(float(i % kSide) / kSide, float(i / kSide) / kSide, 0.0f, 0);
    points.insert(points.end(), point.begin(), point.end());
  }
  for (int q = 0; q < 300; ++q) {
    const float noise = q % 3 == 0 ? 0.0f : q % 3 == 1 ? 0.05f : 2.0f;
    const auto query = surface(UnitFloat(Hash(q, 1)), UnitFloat(Hash(q, 2)), noise, std::uint64_t(q));
    queries.insert(queries.end(), query.begin(), query.end());
  }
  ExpectExact(points, kDimensions, queries);
}

// ---- masks ---------------------------------------------------------------------------------------------------------

TEST(UsableMask, EqualsBruteForce) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 40}, {40, 1}, {37, 53}, {64, 20}}) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      const GuideSet guides = Blobs(width, height, seed);
      const auto coverage = guides.Plane(Layer::kCoverage);
      for (const double rim : {0.0, 1.0, 1.4, 1.5, 2.0, 3.7}) {
        const auto mask = internal::UsableMask(guides, rim);
        for (int i = 0; i < width * height; ++i) {
          bool usable = coverage[i] > 0.0f;
          for (int j = 0; j < width * height && usable; ++j) {
            const double dx = i % width - j % width, dy = i / width - j / width;
            if (!(coverage[j] > 0.0f) && dx * dx + dy * dy < rim * rim) usable = false;
          }
          ASSERT_EQ(mask[i], usable) << width << "×" << height << " rim " << rim << " at " << i % width << ", "
                                     << i / width;
        }
      }
    }
  }
}

TEST(UsableMask, PaintIsExtendedFromTheNearestUsablePixel) {
  Picture picture = NoisePicture(48);
  const GuideSet guides = Blobs(48, 48, 3);
  const auto mask = internal::UsableMask(guides, 2.0);
  const Picture extended = internal::ExtendPaint(picture, mask);
  for (int i = 0; i < 48 * 48; ++i) {
    const std::uint16_t* texel = extended.At(i % 48, i / 48);
    int nearest = std::numeric_limits<int>::max();
    bool found = false;
    for (int j = 0; j < 48 * 48; ++j) {
      if (!mask[j]) continue;
      const int dx = i % 48 - j % 48, dy = i / 48 - j / 48, distance = dx * dx + dy * dy;
      const bool same = std::memcmp(texel, picture.At(j % 48, j / 48), 8) == 0;
      if (distance < nearest)
        nearest = distance, found = same;
      else if (distance == nearest)
        found |= same;
    }
    ASSERT_TRUE(found) << i % 48 << ", " << i / 48;
  }
}

}  // namespace
}  // namespace scumble
