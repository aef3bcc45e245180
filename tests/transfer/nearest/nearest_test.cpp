// Nearest neighbours beyond the sphere's formula: trees that are exact, tables within their bound.
#include <limits>
#include <map>

#include "tests/support/scene_exemplar_fixtures.h"
#include "transfer/lookup_table.h"

namespace scumble {
namespace {

using namespace testing;

double Distance(const PreparedExemplar& exemplar, Source source, glm::vec3 n) {
  return glm::length(glm::dvec3(n) - glm::dvec3(exemplar.Normal(source.x, source.y)));
}

TEST(FacingDirection, TurnsWhateverComesIntoADirection) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(FacingDirection({0, 0, -1}), glm::vec3(0, 1, 0));
  EXPECT_EQ(FacingDirection({3, -4, -1}), glm::vec3(0.6f, -0.8f, 0));
  for (const glm::vec3 odd :
       {glm::vec3(0), glm::vec3(nan, 0, 1), glm::vec3(0, inf, 1), glm::vec3(0, 0, nan), glm::vec3(1e30f)}) {
    EXPECT_EQ(FacingDirection(odd), glm::vec3(0, 0, 1));
  }
  for (int i = 0; i < 1000; ++i) {
    const glm::vec3 n = AnyDirection(Hash(i)), facing = FacingDirection(2.0f * n);
    EXPECT_NEAR(glm::length(facing), 1.0, 1e-6);
    EXPECT_GE(facing.z, 0.0f);
    if (n.z >= 0.0f) {
      EXPECT_LT(glm::length(facing - n), 1e-6);
    }
    const glm::vec2 p = ProjectDirection(facing);
    EXPECT_LT(glm::length(DirectionAt(p.x, p.y) - facing), 2e-6) << "the projection and its inverse";
  }
}

// What the search by tree finds is the definition; the table is within its quantisation of it.
TEST(LookUpTable, IsWithinItsQuantisationOfTheTree) {
  const std::vector<GuideSet> scenes = {HillGuides(90, 60), SphereGuides(48), Blobs(50, 70, 2)};
  for (const GuideSet& guides : scenes) {
    for (const int resolution : {1, 2, 7, 64, 512}) {
      Style style = SceneStyle(WideNoise(guides.width(), guides.height()), guides);
      style.transfer.rim = 1.0;
      PrepareOptions options;
      options.table_resolution = resolution;
      const auto table = MustPrepare(style, options);
      style.transfer.nearest = NearestSearch::kTree;
      const auto tree = MustPrepare(style);
      double worst = 0.0;
      for (int i = 0; i < 4000; ++i) {
        const glm::vec3 n = AnyDirection(Hash(resolution, i)), facing = FacingDirection(n);
        const Source found = table->NearestNeighbour(n);
        ASSERT_TRUE(table->Usable(found.x, found.y));
        const double off = Distance(*table, found, facing) - Distance(*tree, tree->NearestNeighbour(n), facing);
        worst = std::max(worst, off);
        ASSERT_GE(off, -1e-6) << "nothing is nearer than the exact one";
        ASSERT_LE(off, LookUpTable::Quantisation(resolution) + 1e-6) << resolution;
      }
      if (resolution == 7) {
        EXPECT_GT(worst, 0.05 * LookUpTable::Quantisation(7)) << "the bound is not far from the truth";
      }
    }
  }
}

TEST(LookUpTable, TreeIsExactOnScenes) {
  for (const GuideSet& guides : {HillGuides(50, 34), Blobs(40, 40, 9)}) {
    Style style = SceneStyle(WideNoise(guides.width(), guides.height()), guides);
    style.transfer.nearest = NearestSearch::kTree;
    const auto exemplar = MustPrepare(style);
    for (int i = 0; i < 500; ++i) {
      const glm::vec3 n = AnyDirection(Hash(i, 77)), facing = FacingDirection(n);
      Source best;
      double least = std::numeric_limits<double>::infinity();
      for (const Source& source : exemplar->UsablePixels()) {
        const glm::dvec3 d = glm::dvec3(facing) - glm::dvec3(exemplar->Normal(source.x, source.y));
        const double distance = d.x * d.x + d.y * d.y + d.z * d.z;
        if (distance < least) least = distance, best = source;
      }
      ASSERT_EQ(exemplar->NearestNeighbour(n), best);
    }
  }
}

// Where the sphere turns away by more than 72°, a pixel across is many degrees and one along the rim few: there the
// exact search goes some pixels along the rim to save a fraction of one across, and the formula does not.
TEST(LookUpTable, AnalyticAgreesWithTheTreeWithinOnePixelInsideTheRim) {
  for (const int size : {16, 17, 64, 255, 512, 1024}) {
    Style style = PlainStyle(PositionPicture(size));
    const auto analytic = MustPrepare(style);
    style.transfer.nearest = NearestSearch::kTree;
    const auto tree = MustPrepare(style);
    int inside = 0;
    for (int i = 0; i < 20000; ++i) {
      glm::vec3 n = AnyDirection(Hash(size, i));
      n.z = std::fabs(n.z);
      if (std::hypot(n.x, n.y) > 1.0 - 6.0 / size) continue;  // two pixels of rim, one to spare
      ++inside;
      const int apart = n.z >= 0.3f ? 1 : 4;
      const Source a = analytic->NearestNeighbour(n), t = tree->NearestNeighbour(n);
      ASSERT_LE(std::abs(a.x - t.x), apart) << size << ": " << n.x << " " << n.y << " " << n.z;
      ASSERT_LE(std::abs(a.y - t.y), apart) << size << ": " << n.x << " " << n.y << " " << n.z;
    }
    EXPECT_GT(inside, 2500);
  }
}

// Stores entries, and counts.
class CountingCache : public TableCache {
 public:
  std::optional<std::vector<std::byte>> Load(const std::string& key) override {
    const auto found = kept.find(key);
    return found == kept.end() ? std::nullopt : std::optional(found->second);
  }
  void Store(const std::string& key, std::span<const std::byte> bytes) override {
    ++stores;
    kept[key].assign(bytes.begin(), bytes.end());
  }
  std::map<std::string, std::vector<std::byte>> kept;
  int stores = 0;
};

TEST(LookUpTable, IsKeptByWhatItDependsOn) {
  CountingCache cache;
  PrepareOptions options;
  options.cache = &cache;
  options.table_resolution = 64;
  Style style = SceneStyle(WideNoise(60, 40), HillGuides(60, 40));
  const auto first = MustPrepare(style, options), second = MustPrepare(style, options);
  EXPECT_EQ(cache.stores, 1) << "the second time it is there";
  for (int i = 0; i < 1000; ++i) {
    const glm::vec3 n = AnyDirection(Hash(i));
    ASSERT_EQ(first->NearestNeighbour(n), second->NearestNeighbour(n));
  }
  const auto stores_more = [&](const Style& other, const PrepareOptions& with) {
    const int before = cache.stores;
    MustPrepare(other, with);
    return cache.stores - before;
  };
  Style repainted = style;
  repainted.exemplars[0].picture = WideNoise(60, 41), repainted.exemplars[0].picture.height = 40;
  EXPECT_EQ(stores_more(repainted, options), 0) << "paint does not matter";
  Style rim = style;
  rim.transfer.rim = 4.0;
  EXPECT_EQ(stores_more(rim, options), 1);
  Style scaled = style;
  scaled.transfer.scale = 0.5;
  EXPECT_EQ(stores_more(scaled, options), 1);
  Style turned = style;
  const std::size_t usable = std::size_t(first->UsablePixels()[0].y) * 60 + std::size_t(first->UsablePixels()[0].x);
  turned.exemplars[0].guides->Plane(Layer::kNormal, 0)[usable] *= -1.0f;
  EXPECT_EQ(stores_more(turned, options), 1) << "one normal of one pixel";
  PrepareOptions finer = options;
  finer.table_resolution = 65;
  EXPECT_EQ(stores_more(style, finer), 1);
  // What does not fit is made anew: cut short, or pointing at pixels that are not usable.
  for (auto& [key, bytes] : cache.kept) bytes.resize(bytes.size() / 2);
  EXPECT_EQ(stores_more(style, options), 1);
  for (auto& [key, bytes] : cache.kept) std::fill(bytes.begin(), bytes.end(), std::byte{0x7f});
  EXPECT_EQ(stores_more(style, options), 1);
  EXPECT_EQ(MustPrepare(style, options)->NearestNeighbour({0.1f, 0.2f, 0.97f}),
            first->NearestNeighbour({0.1f, 0.2f, 0.97f}));
}

TEST(LookUpTable, IsTheSameOnAnyNumberOfThreads) {
  const Style style = SceneStyle(WideNoise(90, 60), HillGuides(90, 60));
  std::vector<std::vector<std::byte>> made;
  for (const int threads : {1, 2, 5}) {
    CountingCache cache;
    PrepareOptions options;
    options.cache = &cache, options.threads = threads, options.table_resolution = 200;
    MustPrepare(style, options);
    ASSERT_EQ(cache.kept.size(), 1u);
    made.push_back(cache.kept.begin()->second);
  }
  EXPECT_EQ(made[0], made[1]);
  EXPECT_EQ(made[0], made[2]);
}

}  // namespace
}  // namespace scumble
