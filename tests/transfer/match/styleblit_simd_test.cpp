// StyleBlit sixteen pixels at a time equals the plain form, pixel by pixel, with every set of vector instructions that
// this machine has.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "tests/support/every_instruction_set.h"
#include "tests/support/transfer_fixtures.h"
#include "transfer/match/match.h"
#include "transfer/match/seed_tiles.h"

namespace scumble {
namespace {

using testing::AnyDirection;
using testing::HillGuides;
using testing::MakeGuides;
using testing::NoisePicture;
using testing::OnEveryInstructionSet;

struct Case {
  int levels = 7;
  int level_offset = 0;
  int least_level = 1;
  float jitter = 1.0f;
  float threshold = 0.125f;
  ThresholdMetric metric = ThresholdMetric::kL2;
  double variety = 0.0;
  std::int64_t step = 0;
  std::optional<Region> region = std::nullopt;
  bool keep_guide_offset = false;
  std::uint64_t seed = 5;
};

// What both forms leave alone.
constexpr int kUntouched = -7;

SourceField Empty(const GuideSet& guides, bool keep_guide_offset) {
  SourceField field;
  field.Reset(guides.width(), guides.height());
  std::fill(field.x.begin(), field.x.end(), std::int16_t{kUntouched});
  std::fill(field.level.begin(), field.level.end(), std::int8_t{kUntouched});
  if (keep_guide_offset) field.guide_offset.assign(guides.pixel_count(), glm::vec3(9.0f));
  return field;
}

class Matches {
 public:
  Matches(const GuideSet& guides, const PreparedExemplar& exemplar, const Illumination& illumination = {},
          std::vector<float> luminance = {})
      : guides_(guides), exemplar_(exemplar), illumination_(illumination), luminance_(std::move(luminance)) {
    const auto coverage = guides.Plane(Layer::kCoverage);
    for (const float a : coverage) active_.push_back(a > 0.0f);
  }

  std::vector<std::uint8_t>& wanted() { return wanted_; }

  // Both forms, the fast one on some threads.
  // Returns what the plain form finds.
  SourceField ExpectEqual(const Case& c, const std::string& what, int threads = 2) const {
    const Region whole{0, 0, guides_.width(), guides_.height()};
    const SeedRules rules{c.seed, c.step, c.jitter, c.level_offset};
    internal::MatchInput input{
        guides_,  active_,   exemplar_, illumination_,           luminance_, GuideTest(c.threshold, c.metric), rules,
        c.levels, c.variety, 4,         c.region.value_or(whole)};
    input.wanted = wanted_;
    input.least_level = c.least_level;
    SourceField plain = Empty(guides_, c.keep_guide_offset), fast = plain;
    const Progress unheard;
    tbb::task_arena(threads).execute([&] {
      internal::RowProgress progress(unheard, 0.0, 1.0, 1);
      ASSERT_TRUE(internal::MatchStyleBlitPlain(input, plain, progress));
      ASSERT_TRUE(internal::MatchStyleBlitTiles(input, fast, progress));
    });
    ExpectSame(plain, fast, what);
    return plain;
  }

 private:
  static void ExpectSame(const SourceField& plain, const SourceField& fast, const std::string& what) {
    EXPECT_EQ(plain.x, fast.x) << what;
    EXPECT_EQ(plain.y, fast.y) << what;
    EXPECT_EQ(plain.level, fast.level) << what;
    EXPECT_EQ(plain.exemplar, fast.exemplar) << what;
    EXPECT_EQ(plain.guide_offset, fast.guide_offset) << what;
  }

  const GuideSet& guides_;
  const PreparedExemplar& exemplar_;
  Illumination illumination_;
  std::vector<float> luminance_;
  std::vector<std::uint8_t> active_, wanted_;
};

// Flat faces, curved ones, noise, single pixels and holes.
GuideSet MixedGuides(int width, int height, int seed) {
  return MakeGuides(width, height, [=](int x, int y) {
    const std::uint64_t piece = Hash(seed, x / 48, y / 40), pixel = Hash(seed, x, y, 1);
    switch (piece % 5) {
      case 0:
        return glm::vec3(0.0f);
      case 1:
        return AnyDirection(piece >> 3);
      case 2:
        return pixel % 3 == 0 ? AnyDirection(pixel) : glm::vec3(0.0f);
      case 3:
        return AnyDirection(pixel);
      default:
        break;
    }
    const float u = 0.02f * static_cast<float>(x), v = 0.03f * static_cast<float>(y);
    return glm::normalize(glm::vec3(std::sin(u), std::cos(v), 0.4f));
  });
}

std::vector<float> Light(const GuideSet& guides) {
  std::vector<float> light;
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) light.push_back(2.0f * UnitFloat(Hash(i / 50, 3)) - 0.2f);
  light[light.size() / 2] = std::numeric_limits<float>::quiet_NaN();
  light[light.size() / 3] = std::numeric_limits<float>::infinity();
  return light;
}

TEST(TransferTiles, EveryInstructionSetGivesThePlainBytes) {
  const GuideSet guides = MixedGuides(603, 301, 1);
  const PreparedExemplar exemplar(NoisePicture(96), 2.0, 200);
  const Matches matches(guides, exemplar);
  OnEveryInstructionSet([&] { matches.ExpectEqual({}, "mixed"); });
}

TEST(TransferTiles, EveryLevelJitterAndThreshold) {
  const GuideSet guides = MixedGuides(531, 259, 2);
  const PreparedExemplar exemplar(NoisePicture(64), 2.0, 300);
  const Matches matches(guides, exemplar);
  for (const int levels : {1, 2, 3, 6, 7, 8, 9, 10, 16})
    matches.ExpectEqual({.levels = levels}, "levels " + std::to_string(levels));
  for (const float jitter : {0.0f, 0.5f}) matches.ExpectEqual({.jitter = jitter}, "jitter " + std::to_string(jitter));
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float threshold : {0.0f, 1e-40f, 0.5f, 3.0f, infinity}) {
    matches.ExpectEqual({.threshold = threshold}, "threshold " + std::to_string(threshold));
    matches.ExpectEqual({.threshold = threshold, .metric = ThresholdMetric::kL1}, "l1 " + std::to_string(threshold));
  }
  matches.ExpectEqual({.levels = 6, .level_offset = 1, .step = 17}, "preview");
  matches.ExpectEqual({.least_level = 3}, "least level");
}

// A line of pixels as long as a picture may be, along x or y, which is as long as the largest cells: so seeds of theirs
// can stand in it, and the runs of pixels that are near to them can end in it too.
struct Line {
  static constexpr int kLength = kMaxImageSide;
  bool upright;

  int width() const { return upright ? 1 : kLength; }
  int height() const { return upright ? kLength : 1; }
  int Along(PixelPosition p) const { return upright ? p.y : p.x; }
  int Beside(PixelPosition p) const { return upright ? p.x : p.y; }
  PixelPosition At(int along) const { return upright ? PixelPosition{0, along} : PixelPosition{along, 0}; }

  // Where on the line the seed that is nearest to a pixel of it stands; -1: outside the picture.
  int NearestSeed(const SeedRules& rules, int level, int along) const {
    const PixelPosition p = At(along);
    const SeedGrid grid(rules, level, Region{p.x, p.y, p.x + 1, p.y + 1});
    const PixelPosition q = grid.Position(grid.Nearest(p.x, p.y));
    return Beside(q) == 0 && Along(q) >= 0 && Along(q) < kLength ? Along(q) : -1;
  }
};

// A random seed by which a seed of the level stands on the line at `at`, and the pixel `end`, at most `reach` from
// there, is near to another: a run of the first seed's ends between them. One in 2^15 puts a seed of level 15 on the
// line.
struct SeedOnLine {
  std::uint64_t seed = 0;
  int at = 0, end = 0;
};
SeedOnLine FindSeedOnLine(const Line& line, int level, int reach) {
  constexpr std::uint64_t kMost = 1 << 20;
  for (std::uint64_t seed = 0; seed < kMost; ++seed) {
    const SeedRules rules{seed};
    for (int cell = 0; cell << level < Line::kLength; ++cell) {
      const PixelPosition of_cell = line.At(cell), q = SeedOfCell(rules, level, of_cell.x, of_cell.y);
      if (line.Beside(q) != 0) continue;
      const int at = line.Along(q);
      for (const int end : {std::max(0, at - reach), std::min(Line::kLength - 1, at + reach)}) {
        if (line.NearestSeed(rules, level, end) != at) return {seed, at, end};
      }
    }
  }
  ADD_FAILURE() << "no random seed reaches level " << level;
  return {};
}

// The scene faces the viewer; of the paint, a line as long, only the middle does. So each seed's source is the middle.
// Every pixel nearest to the seed takes the paint equally far from the middle, at any distance of normals, and pixels
// without a seed take the middle.
TEST(TransferTiles, SeedsOfTheLargestCells) {
  constexpr int kPaint = 32767, kMiddle = kPaint / 2;
  for (const Line line : {Line{false}, Line{true}}) {
    const GuideSet guides = MakeGuides(line.width(), line.height(), [](int, int) { return glm::vec3(0, 0, 1); });
    const Picture picture(std::min(kPaint, line.width()), std::min(kPaint, line.height()));
    const GuideSet painted = MakeGuides(picture.width, picture.height, [](int x, int y) {
      return x + y == kMiddle ? glm::vec3(0, 0, 1) : glm::vec3(1, 0, 0);
    });
    const std::vector<const Picture*> pictures{&picture};
    Expected<PreparedExemplar> exemplar =
        PreparedExemplar::OfScene(pictures, painted, 0.0, picture.width, picture.height, "line");
    ASSERT_TRUE(exemplar);
    ASSERT_TRUE(exemplar->SearchBy(NearestSearch::kTree, 1, nullptr));
    const Matches matches(guides, *exemplar);
    for (int level = internal::kMaxSpreadLevel + 1; level <= 15; ++level) {
      const SeedOnLine found = FindSeedOnLine(line, level, kMiddle);
      const std::string what = (line.upright ? "column, level " : "row, level ") + std::to_string(level);
      const SourceField field = matches.ExpectEqual({.levels = level + 1,
                                                     .least_level = level,
                                                     .threshold = std::numeric_limits<float>::infinity(),
                                                     .seed = found.seed},
                                                    what);
      const auto source = [&](int p) { return int((line.upright ? field.y : field.x)[std::size_t(p)]); };
      const auto taken_from = [&](int p) {
        return field.level[std::size_t(p)] == level ? p + kMiddle - source(p) : -1;
      };
      EXPECT_EQ(taken_from(found.at), found.at) << what;
      const int other = line.NearestSeed({found.seed}, level, found.end);
      EXPECT_NE(other, found.at) << what;
      EXPECT_EQ(taken_from(found.end), std::abs(found.end - other) <= kMiddle ? other : -1) << what;
    }
  }
}

TEST(TransferTiles, EverySizeAndRegion) {
  const PreparedExemplar exemplar(NoisePicture(32), 1.0, 77);
  for (const auto& [width, height] :
       {std::pair{1, 1}, {1, 90}, {90, 1}, {15, 3}, {16, 16}, {17, 2}, {513, 5}, {1100, 7}, {40, 300}}) {
    const GuideSet guides = HillGuides(width, height);
    Matches matches(guides, exemplar);
    matches.ExpectEqual({}, std::to_string(width) + "×" + std::to_string(height));
  }
  const GuideSet guides = MixedGuides(640, 300, 3);
  const Matches matches(guides, exemplar);
  for (const Region& region : {Region{0, 0, 640, 1}, Region{639, 299, 640, 300}, Region{13, 20, 29, 270},
                               Region{100, 50, 633, 199}, Region{40, 40, 40, 40}}) {
    matches.ExpectEqual({.region = region}, "region from " + std::to_string(region.x0));
  }
}

TEST(TransferTiles, ThreadsDoNotMatter) {
  const GuideSet guides = MixedGuides(1300, 400, 4);
  const PreparedExemplar exemplar(NoisePicture(64), 2.0, 128);
  const Matches matches(guides, exemplar);
  for (const int threads : {1, 2, 3, 7})
    matches.ExpectEqual({.variety = 15.0}, std::to_string(threads) + " threads", threads);
}

TEST(TransferTiles, VarietyAndItsBorders) {
  const GuideSet walls = MakeGuides(
      700, 260, [](int x, int y) { return x % 300 < 3 ? glm::vec3(0.0f) : AnyDirection(Hash(x / 300, y / 200)); });
  const PreparedExemplar exemplar(NoisePicture(96), 2.0, 256);
  const Matches matches(walls, exemplar);
  for (const double degrees : {5.0, 15.0, 90.0}) {
    matches.ExpectEqual({.variety = degrees, .keep_guide_offset = true}, "variety " + std::to_string(degrees));
    matches.ExpectEqual({.levels = 8, .variety = degrees}, "variety with runs " + std::to_string(degrees));
  }
}

TEST(TransferTiles, SeveralExemplarsAndTheirLight) {
  const GuideSet guides = MixedGuides(400, 200, 5);
  const Picture a = NoisePicture(64), b = NoisePicture(64), c = NoisePicture(64), d = NoisePicture(64);
  const std::vector<const Picture*> pictures{&a, &b, &c, &d};
  const PreparedExemplar exemplar(pictures, 2.0, 120);
  const std::vector<double> luminances{0.8, 0.1, 0.4, 0.4};
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float weight : {0.0f, 0.3f, 5.0f, infinity}) {
    for (const LuminanceError form : {LuminanceError::kExcess, LuminanceError::kPublished}) {
      const Matches matches(guides, exemplar, Illumination(luminances, weight, form), Light(guides));
      matches.ExpectEqual({}, "weight " + std::to_string(weight));
      matches.ExpectEqual({.metric = ThresholdMetric::kL1, .variety = 15.0, .keep_guide_offset = true},
                          "l1, weight " + std::to_string(weight));
    }
  }
}

TEST(TransferTiles, PaintedScenes) {
  const GuideSet guides = MixedGuides(400, 200, 6), painted = HillGuides(150, 90);
  const Picture picture = [] {
    Picture wide(150, 90);
    std::fill(wide.rgba.begin(), wide.rgba.end(), std::uint16_t{30000});
    return wide;
  }();
  const std::vector<const Picture*> pictures{&picture};
  Expected<PreparedExemplar> exemplar = PreparedExemplar::OfScene(pictures, painted, 2.0, 211, 127, "hills");
  ASSERT_TRUE(exemplar);
  ASSERT_TRUE(exemplar->SearchBy(NearestSearch::kTable, 64, nullptr));
  const Matches matches(guides, *exemplar);
  matches.ExpectEqual({}, "scene");
  matches.ExpectEqual({.metric = ThresholdMetric::kL1, .variety = 20.0}, "scene, variety");
}

TEST(TransferTiles, OnlyWhatIsWanted) {
  const GuideSet guides = MixedGuides(500, 200, 7);
  const PreparedExemplar exemplar(NoisePicture(64), 2.0, 128);
  Matches matches(guides, exemplar);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    matches.wanted().push_back(guides.Plane(Layer::kCoverage)[i] > 0.0f && Hash(i) % 7 == 0);
  }
  matches.ExpectEqual({.least_level = 2, .keep_guide_offset = true}, "wanted");
}

TEST(TransferTiles, NormalsThatAreNone) {
  GuideSet guides = HillGuides(333, 100);
  const float odd[] = {
      std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 0.0f, 1e-30f, -0.0f, 1e30f};
  for (std::size_t i = 0; i < guides.pixel_count(); i += 3) {
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kNormal, c)[i] = odd[Hash(i, c) % 6];
  }
  for (const int size : {1, 2, 3, 16, 333}) {
    const PreparedExemplar exemplar(NoisePicture(16), 1.0, size);
    const Matches matches(guides, exemplar);
    matches.ExpectEqual({}, "exemplar of " + std::to_string(size));
    matches.ExpectEqual({.threshold = std::numeric_limits<float>::infinity()}, "any distance, " + std::to_string(size));
  }
}

TEST(TransferTiles, SurfacesSeenAlmostEdgeOnAreCopiedInChunks) {
  const float elevation = 0.07f;  // 4 degrees; the exemplar shows none below 27
  const GuideSet guides =
      MakeGuides(320, 180, [&](int, int) { return glm::vec3(0.0f, std::cos(elevation), std::sin(elevation)); });
  const PreparedExemplar exemplar(NoisePicture(64), 3.5, 256);
  const SourceField field = Matches(guides, exemplar).ExpectEqual({}, "edge-on");
  const auto alone = std::count(field.level.begin(), field.level.end(), std::int8_t{0});
  EXPECT_LT(double(alone) / double(guides.pixel_count()), 0.1);
}

TEST(TransferTiles, RowsKnowWhatIsUsable) {
  for (const int size : {1, 2, 3, 7, 16, 101, 256}) {
    for (const double rim : {0.0, 1.0, 3.5, 1e9}) {
      const PreparedExemplar exemplar(NoisePicture(std::max(2, size)), rim, size);
      const ExemplarRows rows = exemplar.Rows();
      for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
          EXPECT_EQ(exemplar.Usable(x, y), rows.first[y] <= x && x <= rows.last[y]) << size << ": " << x << ", " << y;
        }
      }
    }
  }
}

}  // namespace
}  // namespace scumble
