// Nearest neighbours beyond the sphere: trees against brute force, tables within their bound, painted scenes,
// ambiguity.
#include <cstring>
#include <limits>
#include <map>
#include <numbers>

#include "tests/transfer_fixtures.h"
#include "transfer/ambiguity.h"
#include "transfer/guide_tree.h"
#include "transfer/look_up_table.h"
#include "transfer/usable_mask.h"

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
  for (std::size_t q = 0; q + dimensions <= queries.size(); q += dimensions) {
    ASSERT_EQ(tree.Nearest({queries.data() + q, std::size_t(dimensions)}),
              BruteForce(points, queries.data() + q, dimensions))
        << dimensions << " dimensions, query " << q / dimensions;
  }
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
  for (const int dimensions : {1, 2, 3, 4, 7, 16}) {
    for (const int count : {1, 2, 13, 200, 1500}) {
      const auto points = Scatter(std::size_t(count) * dimensions, 0, 11 + dimensions);
      ExpectExact(points, dimensions, Scatter(std::size_t(200) * dimensions, 0, 5));
      ExpectExact(points, dimensions, points);
    }
  }
}

TEST(PointTree, TiesGoToTheFirstPoint) {
  for (const int dimensions : {1, 2, 3, 5}) {
    for (const int steps : {1, 2, 3, 5}) {
      const auto points = Scatter(std::size_t(900) * dimensions, steps, 3 + steps);
      auto queries = Scatter(std::size_t(300) * dimensions, 2 * steps, 8);
      for (float& value : queries) value *= 0.5f;  // half way between the lattice's points: up to 2^dimensions ties
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

TEST(GuideTree, WeighsLayersAndEqualsBruteForce) {
  GuideSet guides = HillGuides(40, 30);
  for (const Layer layer : {Layer::kLuminance, Layer::kLpeLDE}) {
    guides.Add(layer);
    for (int c = 0; c < ChannelCount(layer); ++c) {
      auto plane = guides.Plane(layer, c);
      for (std::size_t i = 0; i < plane.size(); ++i)
        plane[i] = std::floor(8.0f * UnitFloat(Hash(int(layer), c, i))) / 4.0f;
    }
  }
  GuideSet target = guides;
  for (float& value : target.Plane(Layer::kLuminance)) value = 2.0f - value;
  const std::vector<std::vector<WeightedLayer>> choices = {
      {{Layer::kNormal, 1.0f}},
      {{Layer::kLuminance, 1.0f}},
      {{Layer::kNormal, 1.0f}, {Layer::kLuminance, 0.3f}},
      {{Layer::kNormal, 0.5f}, {Layer::kLuminance, 2.0f}, {Layer::kLpeLDE, 1.0f}},
      {{Layer::kNormal, 0.0f}, {Layer::kLpeLDE, 0.0f}}};  // nothing counts: every pixel is equally near
  for (const auto& layers : choices) {
    const auto tree = GuideTree::Build(guides, layers, {}, "g.exr");
    ASSERT_TRUE(tree.ok()) << tree.error().message;
    const auto values = [&](const GuideSet& set, std::size_t i) {
      std::vector<float> all;
      for (const WeightedLayer& each : layers) {
        for (int c = 0; c < ChannelCount(each.layer); ++c) all.push_back(set.Plane(each.layer, c)[i] * each.weight);
      }
      return all;
    };
    for (std::size_t p = 0; p < guides.pixel_count(); p += 7) {
      const auto query = values(target, p);
      double least = std::numeric_limits<double>::infinity();
      Source best;
      for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
        if (!(guides.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
        const double d = SquaredDistance(values(guides, i).data(), query.data(), int(query.size()));
        if (d < least) least = d, best = {int(i) % 40, int(i) / 40};
      }
      ASSERT_EQ(tree->Nearest(target, p), best) << layers.size() << " layers, pixel " << p;
    }
  }
}

TEST(GuideTree, RefusesWhatHasNoDistance) {
  GuideSet guides = HillGuides(8, 8);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto refusal = [&](const GuideSet& set, WeightedLayer layer) {
    const auto tree = GuideTree::Build(set, {&layer, 1}, {}, "g.exr");
    return tree.ok() ? std::string() : tree.error().message;
  };
  EXPECT_EQ(refusal(guides, {Layer::kNormal, 1.0f}), "");
  EXPECT_NE(refusal(guides, {Layer::kLuminance, 1.0f}).find("g.exr has no layer luminance"), std::string::npos);
  EXPECT_NE(refusal(guides, {Layer::kObject, 1.0f}).find("ids"), std::string::npos);
  for (const float weight : {-1.0f, nan, std::numeric_limits<float>::infinity()}) {
    EXPECT_NE(refusal(guides, {Layer::kNormal, weight}).find("weight"), std::string::npos) << weight;
  }
  GuideSet bad = guides;
  bad.Plane(Layer::kNormal, 1)[2] = nan;
  EXPECT_NE(refusal(bad, {Layer::kNormal, 1.0f}).find("NaN or infinite at (2, 0)"), std::string::npos);
  bad.Plane(Layer::kCoverage)[2] = 0.0f;
  EXPECT_EQ(refusal(bad, {Layer::kNormal, 1.0f}), "") << "not covered, not looked at";
  EXPECT_NE(refusal(MakeGuides(4, 4, [](int, int) { return glm::vec3(0); }), {Layer::kNormal, 1.0f}).find("covered"),
            std::string::npos);
  EXPECT_FALSE(GuideTree::Build(guides, {}, {}, "g.exr").ok());
  // A target's NaN counts as 0.
  const WeightedLayer normal{Layer::kNormal, 1.0f};
  const auto tree = GuideTree::Build(guides, {&normal, 1}, {}, "g.exr");
  ASSERT_TRUE(tree.ok());
  GuideSet target = guides, zero = guides;
  target.Plane(Layer::kNormal, 0)[5] = nan, zero.Plane(Layer::kNormal, 0)[5] = 0.0f;
  EXPECT_EQ(tree->Nearest(target, 5), tree->Nearest(zero, 5));
}

// ---- masks ---------------------------------------------------------------------------------------------------------

// Blobs, holes and single pixels.
GuideSet Blobs(int width, int height, std::uint64_t seed) {
  return MakeGuides(width, height, [=](int x, int y) {
    const bool background = Hash(seed, x / 5, y / 7) % 4 == 0 || Hash(seed, x, y) % 61 == 0;
    if (background) return glm::vec3(0.0f);
    glm::vec3 n = AnyDirection(Hash(seed, x, y, 1));
    n.z = std::fabs(n.z);
    return n;
  });
}

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

// ---- tables --------------------------------------------------------------------------------------------------------

Style SceneStyle(Picture picture, GuideSet guides) {
  Style style = PlainStyle(std::move(picture));
  style.exemplars[0].guides = std::move(guides);
  style.exemplars[0].is_sphere = false;
  return style;
}

Picture WideNoise(int width, int height) {
  Picture picture(width, height);
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) {
    picture.rgba[i] = i % 4 == 3 ? 65535 : static_cast<std::uint16_t>(Hash(width, i) & 0xffff);
  }
  return picture;
}

std::shared_ptr<const PreparedExemplar> MustPrepare(const Style& style, const PrepareOptions& options = {}) {
  const auto prepared = Prepare(style, 100, options);
  EXPECT_TRUE(prepared.ok()) << (prepared.ok() ? "" : prepared.error().message);
  return prepared->exemplar;
}

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

// Keeps what is stored, and counts.
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

// ---- painted scenes ------------------------------------------------------------------------------------------------

// Sphere guides given as those of any scene give what the formula gives, but for the rim's staircase.
TEST(SceneExemplar, ASpherePaintedAsASceneIsASphere) {
  constexpr int kSize = 128;
  Style sphere = PlainStyle(NoisePicture(kSize)), scene = SceneStyle(NoisePicture(kSize), SphereGuides(kSize));
  scene.transfer.nearest = sphere.transfer.nearest = NearestSearch::kTree;
  sphere.transfer.rim = scene.transfer.rim = 0.0;
  const GuideSet target = HillGuides(150, 100);
  const Transferred a = MustTransfer(sphere, target), b = MustTransfer(scene, target);
  EXPECT_TRUE(SameField(a.field, b.field));
  EXPECT_EQ(a.picture.rgba, b.picture.rgba);
  EXPECT_FALSE(MustPrepare(scene)->is_sphere());
}

TEST(SceneExemplar, WideAndTallPicturesAtAnyScaleShowUsablePaintOnly) {
  for (const auto& [width, height] : {std::pair{90, 40}, {40, 90}, {64, 64}}) {
    const GuideSet guides = HillGuides(width, height);
    Picture picture(width, height);  // magenta outside, white inside
    for (int i = 0; i < width * height; ++i) {
      const bool covered = guides.Plane(Layer::kCoverage)[i] > 0.0f;
      std::uint16_t* texel = picture.At(i % width, i / width);
      texel[0] = texel[2] = texel[3] = 65535, texel[1] = covered ? 65535 : 0;
    }
    const auto mask = internal::UsableMask(guides, 2.0);
    for (int i = 0; i < width * height; ++i) {
      if (!mask[i]) picture.At(i % width, i / width)[1] = 0;  // the rim is bad paint too
    }
    for (const double scale : {0.3, 0.77, 1.0, 2.5}) {
      for (const Method method : {Method::kLitSphere, Method::kStyleBlit, Method::kBruteForce}) {
        Style style = SceneStyle(picture, guides);
        style.transfer.scale = scale, style.transfer.method = method, style.transfer.blend_radius = 3;
        const auto exemplar = MustPrepare(style);
        EXPECT_EQ(exemplar->width(), ScaledSize(width, scale, 0, 100));
        EXPECT_EQ(exemplar->height(), ScaledSize(height, scale, 0, 100));
        const Transferred result = MustTransfer(style, HillGuides(80, 60));
        for (std::size_t i = 0; i < result.field.level.size(); ++i) {
          if (result.field.level[i] == SourceField::kNoSource) continue;
          ASSERT_TRUE(exemplar->Usable(result.field.x[i], result.field.y[i]));
          ASSERT_EQ(result.picture.rgba[4 * i + 1], 65535) << "paint from outside the mask";
        }
      }
    }
  }
}

TEST(SceneExemplar, GuidesAreSampledAndNeverAveraged) {
  const GuideSet guides = Blobs(60, 60, 4);
  Style style = SceneStyle(NoisePicture(60), guides);
  style.transfer.rim = 0.0;
  for (const double scale : {0.5, 3.0}) {
    style.transfer.scale = scale;
    const auto exemplar = MustPrepare(style);
    for (const Source& source : exemplar->UsablePixels()) {
      const int u = static_cast<int>((source.x + 0.5) / scale), v = static_cast<int>((source.y + 0.5) / scale);
      ASSERT_EQ(exemplar->Normal(source.x, source.y), guides.Vec3(Layer::kNormal, guides.Index(u, v)));
    }
  }
}

std::string Refusal(const Style& style, ErrorKind kind) {
  const auto prepared = Prepare(style, 100);
  EXPECT_FALSE(prepared.ok());
  if (prepared.ok()) return "";
  EXPECT_EQ(int(prepared.error().kind), int(kind)) << prepared.error().message;
  return prepared.error().message;
}

bool Has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(SceneExemplar, WhatIsRefused) {
  const Style good = SceneStyle(WideNoise(40, 30), HillGuides(40, 30));
  Style style = good;
  style.transfer.nearest = NearestSearch::kAnalytic;
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kUsage), "transfer.nearest"));
  style = good;
  style.transfer.rim = 100.0;
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kUsage), "lower transfer.rim"));
  style = good;
  style.exemplars[0].guides = HillGuides(41, 30);
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kInput), "41×30"));
  style = good;
  style.exemplars[0].guides = MakeGuides(40, 30, [](int, int) { return glm::vec3(0.0f); });
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kInput), "A is 0 everywhere"));
  style = good;
  style.exemplars[0].guides->Plane(Layer::kNormal)[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kInput), "normal"));
  style = good;
  style.exemplars[0].is_sphere = true, style.exemplars[0].guides.reset();
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kInput), "40×30"));
  // Exemplars of one style show one scene.
  style = good;
  style.exemplars.push_back(good.exemplars[0]);
  EXPECT_TRUE(Prepare(style, 100).ok());
  style.exemplars[1].guides->Plane(Layer::kNormal, 0)[41] += 0.01f;
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kInput), "differ at (1, 1)"));
  style.exemplars[1] = good.exemplars[0];
  style.exemplars[1].picture = WideNoise(30, 40), style.exemplars[1].guides = HillGuides(30, 40);
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kInput), "30×40"));
  style.exemplars[1] = PlainStyle(NoisePicture(40)).exemplars[0];
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kInput), "one is a sphere"));
  PrepareOptions options;
  options.table_resolution = 0;
  EXPECT_FALSE(Prepare(good, 100, options).ok());
}

TEST(SceneExemplar, LuminanceIsTheGuidesThenThePaints) {
  Style style = SceneStyle(WideNoise(40, 30), HillGuides(40, 30));
  for (std::size_t i = 0; i < style.exemplars[0].picture.rgba.size(); ++i) style.exemplars[0].picture.rgba[i] = 65535;
  style.exemplars.push_back(style.exemplars[0]);
  style.exemplars[1].guides->Add(Layer::kLuminance);
  const auto mask = internal::UsableMask(*style.exemplars[1].guides, 2.0);
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    const float value = 0.5f * UnitFloat(Hash(i));
    style.exemplars[1].guides->Plane(Layer::kLuminance)[i] = mask[i] ? value : 100.0f;
    if (mask[i]) sum += value, count += 1;
  }
  const auto prepared = Prepare(style, 100);
  ASSERT_TRUE(prepared.ok());
  EXPECT_NEAR(prepared->illumination.luminances()[0], 1.0, 1e-6) << "white paint";
  EXPECT_NEAR(prepared->illumination.luminances()[1], sum / count, 1e-6) << "its own guides, without the rim";
  style.exemplars[1].luminance = 0.25;
  EXPECT_FLOAT_EQ(Prepare(style, 100)->illumination.luminances()[1], 0.25f);
}

TEST(SceneExemplar, TheLargestSides) {
  for (const auto& [width, height] : {std::pair{16384, 3}, {3, 16384}}) {
    const int longer = std::max(width, height);
    Style style = SceneStyle(WideNoise(width, height), MakeGuides(width, height, [longer](int x, int y) {
                               const float u =
                                   1.98f * (static_cast<float>(std::max(x, y)) / static_cast<float>(longer) - 0.5f);
                               return glm::vec3(u, 0.0f, std::sqrt(1.0f - u * u));
                             }));
    style.transfer.rim = 0.0;
    const auto exemplar = MustPrepare(style);
    const Source last = exemplar->NearestNeighbour({0.985f, 0.0f, 0.17f});
    EXPECT_GT(std::max(last.x, last.y), 16000);
    style.transfer.scale = 2.0;
    EXPECT_TRUE(Has(Refusal(style, ErrorKind::kUsage), "at most 16384"));
  }
  const Style style = SceneStyle(Picture(16385, 1), MakeGuides(16385, 1, [](int, int) { return glm::vec3(0, 0, 1); }));
  EXPECT_TRUE(Has(Refusal(style, ErrorKind::kInput), "at most 16384"));
}

TEST(SceneExemplar, TheSmallestSizes) {
  for (const int size : {1, 2, 16}) {
    Style style =
        SceneStyle(WideNoise(size, size), MakeGuides(size, size, [](int, int) { return glm::vec3(0, 0, 1); }));
    const auto exemplar = MustPrepare(style);
    EXPECT_EQ(exemplar->UsablePixels().size(), std::size_t(size) * size) << "no edge is in sight, so there is no rim";
    EXPECT_EQ(exemplar->NearestNeighbour({0.6f, 0.0f, 0.8f}), (Source{0, 0}));
    style.transfer.scale = 0.001;
    EXPECT_EQ(MustPrepare(style)->width(), 1);
  }
}

// ---- ambiguity -----------------------------------------------------------------------------------------------------

// A cube seen along its diagonal, orthographic: three faces.
GuideSet CubeGuides(int size) {
  const double third = 1.0 / std::sqrt(3.0), up = std::sqrt(2.0 / 3.0), side = std::sqrt(0.5);
  const glm::vec3 faces[3] = {glm::vec3(0, up, third), glm::vec3(-side, -0.5 * up, third),
                              glm::vec3(side, -0.5 * up, third)};
  return MakeGuides(size, size, [=](int x, int y) {
    const double u = (2.0 * x + 1) / size - 1.0, v = 1.0 - (2.0 * y + 1) / size;
    const double angle = std::fmod(std::atan2(v, u) * 180.0 / std::numbers::pi + 360.0 + 30.0, 60.0) - 30.0;
    if (std::hypot(u, v) * std::cos(angle * std::numbers::pi / 180.0) > 0.8 * std::cos(std::numbers::pi / 6))
      return glm::vec3(0.0f);
    const double turned = std::fmod(std::atan2(v, u) * 180.0 / std::numbers::pi + 360.0 - 30.0, 360.0);
    return faces[turned < 120.0 ? 0 : turned < 240.0 ? 1 : 2];
  });
}

TEST(Ambiguity, OfASphere) {
  // Sources end at the angle whose sine is 1 - rim; a cap of that angle θ has 1 - cos θ of the hemisphere.
  for (const int size : {64, 512}) {
    const AmbiguityReport report = MeasureAmbiguity(*MustPrepare(PlainStyle(NoisePicture(size))));
    const double rim = std::asin(1.0 - 2.0 * 2.0 / size), covered = rim + 5.0 * std::numbers::pi / 180.0;
    EXPECT_NEAR(report.covered_percent, 100.0 * (1.0 - std::cos(covered)), size == 64 ? 5.0 : 2.0) << size;
    EXPECT_NEAR(report.largest_error_degrees, 90.0 - rim * 180.0 / std::numbers::pi, size == 64 ? 5.0 : 2.0) << size;
    EXPECT_EQ(report.flat_percent, 0.0) << size;
    EXPECT_NEAR(double(report.usable_pixels), std::numbers::pi * (size / 2 - 2) * (size / 2 - 2), 0.01 * size * size);
    EXPECT_NEAR(report.mean_repeats * report.cells_shown, double(report.usable_pixels), 0.5);
    if (size < 512) continue;
    EXPECT_NEAR(double(report.cells_shown) / report.cells, 1.0 - std::cos(rim), 0.02);
    // The fullest cell faces the viewer: 8/64² sr of a sphere whose radius is 256 pixels, up to a row and a column.
    EXPECT_NEAR(double(report.most_repeats), 8.0 / 64 / 64 * 256 * 256, 25.0);
  }
  const AmbiguityReport tiny = MeasureAmbiguity(*MustPrepare(PlainStyle(NoisePicture(16))));
  EXPECT_LT(tiny.covered_percent, 50.0) << "three quarters of the radius are usable: 49°";
  EXPECT_EQ(tiny.flat_percent, 0.0);
}

TEST(Ambiguity, OfACubeIsThreeDirections) {
  const GuideSet guides = CubeGuides(200);
  const AmbiguityReport report = MeasureAmbiguity(*MustPrepare(SceneStyle(NoisePicture(200), guides)));
  EXPECT_EQ(report.cells_shown, 3);
  EXPECT_GT(report.cells, 3000);
  EXPECT_EQ(report.flat_percent, 100.0);
  // A cap of 5° around each of three directions, of the hemisphere: 3 (1 - cos 5°).
  EXPECT_NEAR(report.covered_percent, 300.0 * (1.0 - std::cos(5.0 * std::numbers::pi / 180.0)), 0.15);
  // The furthest from all three is the point of the rim half way between two faces: the angle to each has the cosine of
  // 60° times that of the faces' height over the rim.
  const double furthest = 180.0 / std::numbers::pi * std::acos(std::sqrt(2.0 / 3.0) * 0.5);
  EXPECT_NEAR(report.largest_error_degrees, furthest, 1.5);
  EXPECT_NEAR(double(report.most_repeats), double(report.usable_pixels) / 3.0, 0.02 * double(report.usable_pixels));
}

TEST(Ambiguity, OfAnEmptyBoundaryCase) {
  const GuideSet wall = MakeGuides(30, 20, [](int, int) { return glm::vec3(0, 0, 1); });
  const AmbiguityReport report = MeasureAmbiguity(*MustPrepare(SceneStyle(WideNoise(30, 20), wall)));
  EXPECT_EQ(report.cells_shown, 1);
  EXPECT_EQ(report.most_repeats, 600u);
  EXPECT_NEAR(report.largest_error_degrees, 90.0, 1.0);
  EXPECT_NEAR(report.mean_error_degrees, 180.0 / std::numbers::pi, 0.2) << "the mean angle from a pole: 1 radian";
}

}  // namespace
}  // namespace scumble
