// The transfer at the ends of every scale, against the plain engine and against exact arithmetic.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "tests/support/every_instruction_set.h"
#include "tests/support/numbers.h"
#include "tests/support/plain_engine.h"
#include "tests/support/transfer_fixtures.h"

namespace scumble {
namespace {

using namespace testing;

TransferOptions PlainOptions(std::uint64_t seed = kPlainSeed) {
  TransferOptions options;
  options.seed = seed;
  return options;
}

// Chunks of raw sources: nothing votes.
Style ChunkStyle(int exemplar, float threshold, ThresholdMetric metric = ThresholdMetric::kL2) {
  Style style = PlainStyle(NoisePicture(exemplar));
  style.transfer.threshold = threshold, style.transfer.threshold_metric = metric;
  style.transfer.blend_radius = 0;
  return style;
}

int CoarsestLevel(const SourceField& field) { return *std::max_element(field.level.begin(), field.level.end()); }

// Every covered pixel's source and level are the plain engine's. Returns the coarsest level that settled one.
int ExpectPlainField(const Style& style, const GuideSet& guides, const std::string& what,
                     std::uint64_t seed = kPlainSeed) {
  const PreparedExemplar exemplar(style.exemplars[0].picture, style.transfer.rim, style.exemplars[0].picture.width);
  const SourceField field = MustTransfer(style, guides, PlainOptions(seed)).field;
  std::size_t wrong = 0;
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x < guides.width(); ++x) {
      const std::size_t i = guides.Index(x, y);
      if (!(guides.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
      const PlainSource plain = PlainSourceAt(guides, exemplar, style.transfer, x, y, seed);
      wrong += field.x[i] != plain.x || field.y[i] != plain.y || field.level[i] != plain.level;
    }
  }
  EXPECT_EQ(wrong, 0u) << what;
  return CoarsestLevel(field);
}

// ---- the threshold -------------------------------------------------------------------------------------------------

// The test is strict, and no distance is below 0: nothing is accepted, every pixel takes its own nearest neighbour,
// which is the Lit Sphere. -0 is 0.
TEST(ExtremeThreshold, ZeroIsTheLitSphere) {
  const GuideSet guides = HillGuides(150, 110);
  for (const ThresholdMetric metric : {ThresholdMetric::kL2, ThresholdMetric::kL1}) {
    Style lit = ChunkStyle(64, 0.5f, metric);
    lit.transfer.method = Method::kLitSphere;
    const Transferred expected = MustTransfer(lit, guides);
    for (const float zero : {0.0f, -0.0f}) {
      const Transferred found = MustTransfer(ChunkStyle(64, zero, metric), guides);
      EXPECT_TRUE(SameField(found.field, expected.field));
      EXPECT_EQ(found.picture.rgba, expected.picture.rgba);
    }
  }
}

// Below any threshold above 0 lies the distance 0, and nothing else lies below the smallest float. The guides are the
// very normals of the exemplar's pixels, by the same operations in float: each pixel's own source is itself, an offer
// moves the seed's itself by the pixel's way from the seed, which is the pixel: distance 0. So the picture is the
// exemplar, as with any threshold; but a seed settles it now, where at threshold 0 none may.
TEST(ExtremeThreshold, TheSmallestTakesExactCopiesAndNothingElse) {
  constexpr int kSize = 96;
  const GuideSet sphere = SphereGuides(kSize);
  for (const ThresholdMetric metric : {ThresholdMetric::kL2, ThresholdMetric::kL1}) {
    for (const float threshold : {kDenormal, 1e-30f, std::numeric_limits<float>::min(), 1e-7f}) {
      Style style = ChunkStyle(kSize, threshold, metric);
      style.transfer.rim = 0.0;
      const SourceField field = MustTransfer(style, sphere).field;
      std::size_t settled = 0;
      for (int y = 0; y < kSize; ++y) {
        for (int x = 0; x < kSize; ++x) {
          const std::size_t i = sphere.Index(x, y);
          if (field.level[i] == SourceField::kNoSource) continue;
          ASSERT_EQ(field.x[i], x);
          ASSERT_EQ(field.y[i], y);
          settled += field.level[i] > 0;
        }
      }
      EXPECT_GT(settled, sphere.pixel_count() / 2) << threshold;
      // On hills, whose normals are not the exemplar's, hardly any distance is 0: the plain engine finds all of them,
      // too.
      ExpectPlainField(ChunkStyle(64, threshold, metric), HillGuides(150, 110),
                       "threshold " + std::to_string(threshold));
    }
  }
}

// Distances of 2^-75 and less have squares that float rounds to 0 (the smallest is 2^-149; a half of it is rounded to
// even). They count as 0 by the Euclidean metric, so by a threshold of any size above 0 they are accepted; by the sum
// of absolute differences they are themselves.
TEST(ExtremeThreshold, SquaresThatVanishAreZero) {
  const float tiny = std::ldexp(1.0f, -75), more = std::ldexp(1.0f, -74);
  const glm::vec3 zero(0.0f);
  const GuideTest squares(kDenormal, ThresholdMetric::kL2), sums(kDenormal, ThresholdMetric::kL1);
  EXPECT_TRUE(squares.Alike(zero, {tiny, 0, 0}));
  EXPECT_FALSE(squares.Alike(zero, {more, 0, 0})) << "its square is 2^-148";
  EXPECT_FALSE(sums.Alike(zero, {tiny, 0, 0}));
  EXPECT_TRUE(sums.Alike(zero, zero));
  EXPECT_FALSE(sums.Alike(zero, {kDenormal, 0, 0})) << "strict";
}

// So they do in the transfer, by every set of vector instructions. The scene faces (0, 0, 1) and the paint (off, 0, 1):
// everything is `off` away from everything. Where that counts as 0 the field is that of no distance at all, in which
// seeds settle their own pixels at the least; where it does not, nothing is accepted.
TEST(ExtremeThreshold, SquaresThatVanishAreZeroToTheTransfer) {
  const auto facing = [](int width, int height, float off) {
    return MakeGuides(width, height, [off](int, int) { return glm::vec3(off, 0, 1); });
  };
  const GuideSet guides = facing(60, 40, 0.0f);
  const auto field = [&](float off, ThresholdMetric metric) {
    Style style = ChunkStyle(48, kDenormal, metric);
    style.exemplars[0].guides = facing(48, 48, off), style.exemplars[0].is_sphere = false;
    style.transfer.nearest = NearestSearch::kTree, style.transfer.rim = 0.0;
    return MustTransfer(style, guides).field;
  };
  const float tiny = std::ldexp(1.0f, -75), more = std::ldexp(1.0f, -74);
  OnEveryInstructionSet([&] {
    const SourceField same = field(0.0f, ThresholdMetric::kL2);
    EXPECT_GT(CoarsestLevel(same), 0);
    EXPECT_TRUE(SameField(field(tiny, ThresholdMetric::kL2), same));
    EXPECT_EQ(CoarsestLevel(field(more, ThresholdMetric::kL2)), 0) << "its square is 2^-148";
    EXPECT_TRUE(SameField(field(0.0f, ThresholdMetric::kL1), same));
    EXPECT_EQ(CoarsestLevel(field(tiny, ThresholdMetric::kL1)), 0);
  });
}

// The light's part is subtracted from the threshold. The remainder is above 0, so the distance 0 is below it, however
// small its square.
TEST(ExtremeThreshold, WhatLightLeavesOfASmallThresholdStillTakesExactCopies) {
  const glm::vec3 zero(0.0f), off(1e-3f, 0, 0);
  for (const ThresholdMetric metric : {ThresholdMetric::kL2, ThresholdMetric::kL1}) {
    for (const float threshold : {1e-20f, 1e-30f, 2 * kDenormal}) {
      const GuideTest test(threshold, metric);
      EXPECT_TRUE(test.Alike(zero, zero, 0.5f * threshold)) << threshold;
      EXPECT_TRUE(test.Alike(zero, zero, 0.0f, 0.5f * threshold)) << threshold << ", in more dimensions";
      EXPECT_FALSE(test.Alike(zero, zero, threshold)) << "nothing is left";
      EXPECT_FALSE(test.Alike(zero, off, 0.5f * threshold));
    }
  }
}

// Every distance between finite normals is below infinity: the coarsest seed that is on the object and whose source is
// usable settles each pixel, which the plain engine finds without looking at a distance.
TEST(ExtremeThreshold, InfinityTakesTheCoarsestSeedThatIsThere) {
  for (const ThresholdMetric metric : {ThresholdMetric::kL2, ThresholdMetric::kL1}) {
    ExpectPlainField(ChunkStyle(100, kInfinity, metric), HillGuides(150, 110), "infinity");
    // Unit normals are at most 2 apart, and 2√3 by the other metric: all larger thresholds are equal.
    const GuideSet guides = HillGuides(150, 110);
    const SourceField all = MustTransfer(ChunkStyle(100, kInfinity, metric), guides).field;
    for (const float threshold : {3.6f, 1e30f, std::numeric_limits<float>::max()}) {
      EXPECT_TRUE(SameField(MustTransfer(ChunkStyle(100, threshold, metric), guides).field, all)) << threshold;
    }
  }
}

// ---- levels and windows --------------------------------------------------------------------------------------------

TEST(ExtremeLevels, OneToSixteenAreThePlainEngines) {
  for (const auto& guides : {HillGuides(140, 90), HillGuides(600, 9), HillGuides(7, 200)}) {
    for (int levels = 1; levels <= 16; ++levels) {
      Style style = ChunkStyle(64, 0.3f);
      style.transfer.levels = levels;
      ExpectPlainField(style, guides, std::to_string(levels) + " levels");
    }
  }
}

// A cell has one seed, which offers its paint if it stands on the object. By the random seed of the other tests none of
// level 9 or coarser does: both engines pass over those levels. Here each has a random seed by which it does, and then
// settles that seed's own pixel at the least: nothing is nearer to it, and its source is in the same place of the
// exemplar to half a pixel's diagonal, 0.01·√2 on the disc and 0.04 on the sphere, where hills are steepest (their sine
// is 0.91, the cosine 0.39 or more).
TEST(ExtremeLevels, EveryLevelIsReachedAndIsThePlainEngines) {
  const GuideSet guides = HillGuides(72, 50);
  for (int level = 8; level <= 15; ++level) {
    const std::uint64_t seed = SeedThatReaches(level, guides);
    for (const float threshold : {kInfinity, 0.3f}) {
      Style style = ChunkStyle(100, threshold);
      style.transfer.levels = level + 1;
      const std::string what = "level " + std::to_string(level) + ", threshold " + std::to_string(threshold);
      EXPECT_EQ(ExpectPlainField(style, guides, what, seed), level) << what;
    }
  }
}

// One level has a seed on every pixel, which is the Lit Sphere; and no pixel is settled by a level that there is not.
TEST(ExtremeLevels, OneIsTheLitSphereAndNoneIsAboveTheLast) {
  const GuideSet guides = HillGuides(140, 90);
  Style style = ChunkStyle(64, 0.3f);
  for (int levels = 1; levels <= 16; ++levels) {
    style.transfer.levels = levels;
    for (const std::int8_t level : MustTransfer(style, guides).field.level) ASSERT_LT(level, levels);
  }
  style.transfer.levels = 1;
  const SourceField one = MustTransfer(style, guides).field;
  style.transfer.method = Method::kLitSphere;
  EXPECT_TRUE(SameField(one, MustTransfer(style, guides).field));
}

// Radii at the borders between the forms of voting (0, 3 | 4) and the last, whose window holds the whole picture.
TEST(ExtremeRadius, ZeroToSixtyFourAreThePlainEngines) {
  const GuideSet guides = HillGuides(90, 61);
  for (const int radius : {0, 1, 3, 4, 31, 63, 64}) {
    Style style = ChunkStyle(48, 0.3f);
    style.transfer.blend_radius = radius, style.transfer.edge_aware = false;
    EXPECT_TRUE(MustTransfer(style, guides, PlainOptions()).picture.rgba == PlainEngine(style, guides).rgba) << radius;
  }
}

// The mean of equal values is that value: (2·n·v + n) / 2n rounded down is v. So paint of one colour stays that colour,
// whatever votes for it and whatever stops votes.
TEST(ExtremeRadius, OneColourStaysItInEveryWindow) {
  Picture flat(40, 40);
  for (std::size_t i = 0; i < flat.rgba.size(); i += 4) {
    flat.rgba[i] = 65535, flat.rgba[i + 1] = 1, flat.rgba[i + 2] = 32767, flat.rgba[i + 3] = 65535;
  }
  const GuideSet guides = HillGuides(80, 33);
  for (const int radius : {0, 1, 2, 3, 4, 5, 8, 15, 16, 31, 32, 63, 64}) {
    Style style = PlainStyle(flat);
    style.transfer.blend_radius = radius, style.transfer.edge_aware = radius % 3 == 0;
    const Picture picture = MustTransfer(style, guides).picture;
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      const std::uint16_t* const pixel = picture.rgba.data() + 4 * i;
      if (!(guides.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
      ASSERT_TRUE(pixel[0] == 65535 && pixel[1] == 1 && pixel[2] == 32767 && pixel[3] == 65535) << radius;
    }
  }
}

// ---- sizes ---------------------------------------------------------------------------------------------------------

// Single pixels, rows and columns, below, at and beyond the sides of blocks, tiles and bands (16, 512 and 128, 24
// rows).
TEST(ExtremeSizes, RowsAndColumnsAreThePlainEngines) {
  for (const int length : {1, 2, 15, 16, 17, 127, 129, 511, 512, 513, 1100}) {
    for (const auto& [width, height] : {std::pair{length, 1}, {1, length}, {length, 2}, {2, length}}) {
      const GuideSet guides = HillGuides(width, height);
      Style style = ChunkStyle(64, 0.4f);
      style.transfer.blend_radius = length % 2 ? 2 : 5, style.transfer.edge_aware = false;
      EXPECT_TRUE(MustTransfer(style, guides, PlainOptions()).picture.rgba == PlainEngine(style, guides).rgba)
          << width << "×" << height;
    }
  }
}

// Whatever may be asked for of it: a sphere of one pixel has one direction and one colour, so all that is covered has
// that colour. (Oklab's tint and a base colour of 0 would change it; they are not asked for.)
TEST(ExtremeSizes, AnExemplarOfOnePixelPaintsAllInItsColour) {
  Picture one(1, 1);
  one.rgba = {40000, 3, 65535, 65535};
  GuideSet guides = HillGuides(70, 40);
  for (const Layer layer : {Layer::kPref, Layer::kLuminance, Layer::kAlbedo}) guides.Add(layer);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) guides.Plane(Layer::kPref)[i] = static_cast<float>(i % 70);
  using Change = void (*)(Style&);
  const std::pair<const char*, Change> changes[] = {
      {"plain", [](Style&) {}},
      {"Lit Sphere", [](Style& s) { s.transfer.method = Method::kLitSphere; }},
      {"brute force", [](Style& s) { s.transfer.method = Method::kBruteForce; }},
      {"table", [](Style& s) { s.transfer.nearest = NearestSearch::kTable; }},
      {"tree", [](Style& s) { s.transfer.nearest = NearestSearch::kTree; }},
      {"coherent", [](Style& s) { s.transfer.coherent = true; }},
      {"variety", [](Style& s) { s.transfer.variety = 90.0; }},
      {"hybrid", [](Style& s) { s.transfer.hybrid = 3.0; }},
      {"step 8", [](Style& s) { s.transfer.match_step = 8; }},
      {"window of 129", [](Style& s) { s.transfer.blend_radius = 64; }},
      {"threshold 0", [](Style& s) { s.transfer.threshold = 0.0f; }},
      {"four lights", [](Style& s) { s.exemplars.resize(4, s.exemplars[0]), s.exemplars[1].luminance = 0.5; }},
      {"weighed light",
       [](Style& s) {
         s.exemplars[0].guides = MakeGuides(1, 1, [](int, int) { return glm::vec3(0, 0, 1); });
         s.exemplars[0].guides->Add(Layer::kLuminance), s.transfer.guide_weights[Layer::kLuminance] = 1.0f;
         s.exemplars[0].is_sphere = false, s.transfer.rim = 0.0;
       }},
  };
  for (const auto& [name, change] : changes) {
    Style style = PlainStyle(one);
    change(style);
    const Picture picture = MustTransfer(style, guides).picture;
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      const bool covered = guides.Plane(Layer::kCoverage)[i] > 0.0f;
      const std::uint16_t* const pixel = picture.rgba.data() + 4 * i;
      const std::uint16_t expected[4] = {40000, 3, 65535, 65535}, nothing[4] = {0, 0, 0, 0};
      ASSERT_TRUE(std::equal(pixel, pixel + 4, covered ? expected : nothing)) << name;
    }
  }
}

// The prepared exemplar of one pixel that was scaled up is flat, too.
TEST(ExtremeSizes, OnePixelScaledUpIsFlat) {
  Picture one(1, 1);
  one.rgba = {40000, 3, 65535, 65535};
  Style style = PlainStyle(one);
  style.transfer.scale = 64.0;
  const Picture picture = MustTransfer(style, SphereGuides(50)).picture;
  EXPECT_EQ(picture.At(25, 25)[0], 40000);
  EXPECT_EQ(picture.At(3, 25)[2], 65535);
}

// A side of one pixel more than there may be is refused, before anything is made of it.
TEST(ExtremeSizes, SidesBeyondTheLargestAreRefused) {
  for (const auto& [width, height] : {std::pair{kMaxImageSide + 1, 1}, {1, kMaxImageSide + 1}, {0, 5}, {5, 0}}) {
    GuideSet guides(width, height);
    guides.Add(Layer::kCoverage), guides.Add(Layer::kNormal);
    EXPECT_FALSE(guides.Validate("guides")) << width << "×" << height;
  }
  for (const auto& [width, height] : {std::pair{kMaxImageSide, 1}, {1, kMaxImageSide}}) {
    const GuideSet guides = HillGuides(width, height);
    ASSERT_TRUE(guides.Validate("guides"));
    Style style = ChunkStyle(8, 0.4f);
    style.transfer.levels = 16;
    ExpectPlainField(style, guides, std::to_string(width));
  }
}

}  // namespace
}  // namespace scumble
