// Sources that may be farther than the nearest by a share of its distance, against brute force.
#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/every_instruction_set.h"
#include "tests/support/scene_exemplar_fixtures.h"
#include "transfer/nearest/guide_tree.h"

namespace scumble {
namespace {

using namespace testing;

std::vector<float> Anywhere(std::size_t count, std::uint64_t seed) {
  std::vector<float> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = 2.0f * UnitFloat(Hash(seed, i)) - 1.0f;
  return values;
}

double Distance(const float* a, const float* b, std::size_t dimensions) {
  double sum = 0.0;
  for (std::size_t d = 0; d < dimensions; ++d) sum += (double(a[d]) - b[d]) * (double(a[d]) - b[d]);
  return std::sqrt(sum);
}

double Least(const std::vector<float>& points, const float* query, std::size_t dimensions) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); i += dimensions)
    least = std::min(least, Distance(&points[i], query, dimensions));
  return least;
}

// The tree rounds on the safe side, so only the rounding of the distances here remains: a few ulps of a double.
constexpr double kUlps = 1.0 + 1e-14;

TEST(ApproximateTree, IsNeverFartherThanAllowedAndSometimesFartherThanTheNearest) {
  for (const std::size_t dimensions : {1u, 3u, 8u, 15u}) {
    const std::vector<float> points = Anywhere(3000 * dimensions, dimensions), queries = Anywhere(300 * dimensions, 77);
    const PointTree tree(static_cast<int>(dimensions), points);
    for (const double error : {1e-6, 0.1, 0.5, 2.0, 10.0}) {
      std::vector<std::uint32_t> first;  // answers of the first instruction set
      OnEveryInstructionSet([&] {
        std::vector<std::uint32_t> found;
        std::uint32_t place = 0;
        int farther = 0;
        for (std::size_t q = 0; q < queries.size(); q += dimensions) {
          const std::uint32_t answer = tree.Nearest({&queries[q], dimensions}, place, error);
          const double distance = Distance(&points[answer * dimensions], &queries[q], dimensions);
          const double least = Least(points, &queries[q], dimensions);
          EXPECT_LE(distance, (1.0 + error) * least * kUlps) << dimensions << " dimensions, error " << error;
          farther += distance > least;
          found.push_back(answer);
        }
        if (first.empty()) first = found;
        EXPECT_EQ(found, first) << "one answer on every machine";
        if (error >= 2.0 && dimensions > 1) {
          EXPECT_GT(farther, 0) << "nothing was left out: the error buys nothing";
        }
      });
    }
  }
}

TEST(ApproximateTree, TheAnswerDoesNotDependOnWhatWasAskedBefore) {
  const std::vector<float> points = Anywhere(2000 * 3, 1), queries = Anywhere(200 * 3, 2);
  const PointTree tree(3, points);
  std::vector<std::uint32_t> forward, backward;
  std::uint32_t place = 0;
  for (std::size_t q = 0; q < 200; ++q) forward.push_back(tree.Nearest({&queries[3 * q], 3}, place, 0.5));
  for (std::size_t q = 200; q-- > 0;) {
    place = static_cast<std::uint32_t>(Hash(q));
    backward.push_back(tree.Nearest({&queries[3 * q], 3}, place, 0.5));
  }
  std::reverse(backward.begin(), backward.end());
  EXPECT_EQ(forward, backward);
}

TEST(ApproximateTree, WithoutErrorItIsTheNearest) {
  const std::vector<float> points = Anywhere(500 * 3, 3), queries = Anywhere(100 * 3, 4);
  const PointTree tree(3, points);
  std::uint32_t place = 0;
  for (std::size_t q = 0; q < queries.size(); q += 3) {
    EXPECT_EQ(tree.Nearest({&queries[q], 3}, place, 0.0), tree.Nearest({&queries[q], 3}));
  }
}

Style RoughStyle(double error) {
  Style style = SceneStyle(WideNoise(60, 44), Blobs(60, 44, 1));
  style.transfer.nearest = NearestSearch::kTree, style.transfer.nearest_error = error, style.transfer.rim = 0.0;
  return style;
}

// Directions and usable normals have length 1, so this compares the tree's own distances.
TEST(ApproximateTree, SourcesOfAStyleKeepToItsError) {
  const auto exact = MustPrepare(RoughStyle(0.0)), rough = MustPrepare(RoughStyle(2.0));
  int farther = 0;
  for (int n = 0; n < 500; ++n) {
    const glm::vec3 direction = AnyDirection(Hash(n));
    const glm::vec3 facing = direction.z < 0.0f ? -direction : direction;
    const auto off = [&](const PreparedExemplar& exemplar) {
      const Source at = exemplar.NearestNeighbour(facing);
      EXPECT_TRUE(exemplar.Usable(at.x, at.y));
      const glm::dvec3 d = glm::dvec3(facing) - glm::dvec3(exemplar.Normal(at.x, at.y));
      return std::sqrt(glm::dot(d, d));
    };
    const double least = off(*exact), found = off(*rough);
    // The query is made a unit vector once more: an ulp of 1 of a float on either distance.
    EXPECT_LE(found, 3.0 * least + 4.0 * 0x1p-23) << n;
    farther += found > least;
  }
  EXPECT_GT(farther, 0);
}

TEST(ApproximateTree, GuidesOfLightKeepToItToo) {
  GuideSet guides = Blobs(50, 40, 2);
  guides.Add(Layer::kLuminance);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) guides.Plane(Layer::kLuminance)[i] = UnitFloat(Hash(i, 5));
  const auto prepare = [&](double error) {
    Style style = SceneStyle(WideNoise(50, 40), guides);
    style.transfer.guide_weights[Layer::kLuminance] = 2.0f;
    style.transfer.nearest_error = error, style.transfer.rim = 0.0;
    const auto prepared = Prepare(style, 100);
    EXPECT_TRUE(prepared.ok());
    return *prepared;
  };
  const PreparedStyle exact = prepare(0.0), rough = prepare(1.0);
  ASSERT_TRUE(exact.space && rough.space);
  int farther = 0;
  for (int n = 0; n < 500; ++n) {
    glm::vec3 normal = AnyDirection(Hash(n, 9));
    normal.z = std::fabs(normal.z);
    const float light = 2.0f * UnitFloat(Hash(n, 1));
    const auto off = [&](const GuideSpace& space) {
      const Source at = space.Nearest(0, normal, &light);
      const glm::dvec3 d = glm::dvec3(normal) - glm::dvec3(exact.exemplar->Normal(at.x, at.y));
      const double l = double(light) - space.ExtraValuesAt(0, at)[0];
      return std::sqrt(glm::dot(d, d) + l * l);
    };
    const double least = off(*exact.space), found = off(*rough.space);
    EXPECT_LE(found, 2.0 * least + 3.0 * 0x1p-23) << n;
    farther += found > least;
  }
  EXPECT_GT(farther, 0);
}

TEST(ApproximateTree, TheStyleIsPaintedTheSameByAnyThreads) {
  Style style = RoughStyle(0.5);
  style.transfer.method = Method::kStyleBlit;
  const GuideSet guides = HillGuides(120, 90);
  TransferOptions options;
  options.threads = 1;
  const Transferred one = MustTransfer(style, guides, options);
  for (const int threads : {2, 3, 7}) {
    options.threads = threads;
    EXPECT_EQ(MustTransfer(style, guides, options).picture.rgba, one.picture.rgba) << threads;
  }
  style.transfer.nearest_error = -0.1;
  EXPECT_FALSE(Prepare(style, 90).ok());
  style.transfer.nearest_error = 11.0;
  EXPECT_FALSE(Prepare(style, 90).ok());
}

}  // namespace
}  // namespace scumble
