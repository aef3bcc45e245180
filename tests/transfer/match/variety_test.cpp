// Source variation on flat surfaces: the sources of the paint, and the course of the borders.
#include "transfer/match/variety.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "bench/wall_measures.h"
#include "core/image/hash.h"
#include "measure/flat_surfaces.h"
#include "tests/support/transfer_fixtures.h"
#include "transfer/exemplar/paint_by_normal.h"
#include "transfer/seeds/seeds.h"

namespace scumble {
namespace {

using namespace testing;

constexpr double kRadians = 3.14159265358979323846 / 180.0;

// Light on the left, dark on the right, with grain.
Picture TwoTones(int width, int height) {
  Picture picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::uint16_t* texel = picture.At(x, y);
      texel[0] = texel[1] = texel[2] = static_cast<std::uint16_t>((2 * x < width ? 50000 : 10000) + Hash(x, y) % 4000);
      texel[3] = 65535;
    }
  }
  return picture;
}

TEST(SourceVariation, ToneIsTheMeanOfTheUsablePixelsAround) {
  const PreparedExemplar exemplar(NoisePicture(100), 2.0, 100);  // small: sums of single pixels
  const SourceVariation variation(exemplar);
  int empty = 0;
  for (const Source at : {Source{50, 50}, Source{12, 40}, Source{3, 50}, Source{80, 20}, Source{0, 0}}) {
    for (const int half : {1, 4, 9}) {
      double sum = 0.0, count = 0.0;
      for (int y = at.y - half; y < at.y + half; ++y) {
        for (int x = at.x - half; x < at.x + half; ++x) {
          if (exemplar.Usable(x, y)) sum += exemplar.picture().At(x, y)[1], count += 1.0;
        }
      }
      const auto tone = variation.ToneAround(at, 0, half);
      ASSERT_EQ(tone.has_value(), count > 0.0);
      if (!tone) {
        ++empty;
        continue;
      }
      EXPECT_NEAR((*tone)[1], sum / count, 1.0);
      EXPECT_EQ((*tone)[3], 65535);
    }
  }
  EXPECT_GT(empty, 0) << "a corner outside the disc has no tone";
}

TEST(SourceVariation, ToneOfAPixelIsSmooth) {
  // A ramp of 100 a pixel in a large exemplar, whose sums are of squares of 2 pixels: bilinear between them is exact.
  Picture ramp(300, 300);
  for (int y = 0; y < 300; ++y) {
    for (int x = 0; x < 300; ++x) {
      std::uint16_t* texel = ramp.At(x, y);
      texel[0] = texel[1] = texel[2] = static_cast<std::uint16_t>(1000 + 100 * x + 50 * y), texel[3] = 65535;
    }
  }
  const PreparedExemplar exemplar(ramp, 2.0, 300);
  const SourceVariation variation(exemplar);
  for (int y = 100; y < 200; y += 7) {
    for (int x = 100; x < 200; ++x) EXPECT_NEAR(variation.ToneAt({x, y}, 0)[0], ramp.At(x, y)[0], 2.0);
  }
}

TEST(SourceVariation, ChoosesWithinTheConeAndOfTheWantedTone) {
  const PreparedExemplar exemplar(TwoTones(256, 256), 2.0, 256);
  const SourceVariation variation(exemplar);
  const Source own{112, 120};  // light, near the dark half, which most of the cone is
  const glm::vec3 normal = exemplar.Normal(own.x, own.y);
  std::set<std::pair<int, int>> chosen;
  for (std::uint64_t hash = 0; hash < 300; ++hash) {
    const Source source = variation.Choose(exemplar, {own, 0, 25.0, 12, Mix64(hash)});
    ASSERT_TRUE(exemplar.Usable(source.x, source.y));
    EXPECT_GE(glm::dot(normal, exemplar.Normal(source.x, source.y)), std::cos(25.0 * kRadians) - 1e-6);
    EXPECT_LE(source.x, 124) << "dark paint within its square";
    EXPECT_EQ(source, variation.Choose(exemplar, {own, 0, 25.0, 12, Mix64(hash)}));
    chosen.insert({source.x, source.y});
  }
  EXPECT_GT(chosen.size(), 250u);
}

// An exemplar that is a scene: two flat panes side by side, 30 degrees apart, each with one normal.
TEST(SourceVariation, ASceneOffersAllOfAFlatFace) {
  const glm::vec3 left = glm::normalize(glm::vec3(-std::tan(15.0 * kRadians), 0, 1)), right{-left.x, 0, left.z};
  const GuideSet panes = MakeGuides(200, 120, [&](int x, int) { return x < 100 ? left : right; });
  Picture paint = NoisePicture(200);
  paint.height = 120, paint.rgba.resize(4u * 200 * 120);
  const Picture* const pictures[] = {&paint};
  auto exemplar = PreparedExemplar::OfScene(pictures, panes, 0.0, 200, 120, "panes");
  ASSERT_TRUE(exemplar.ok());
  const SourceVariation variation(*exemplar);
  std::set<int> tenths, both;
  for (std::uint64_t hash = 0; hash < 2000; ++hash) {
    const Source source = variation.Choose(*exemplar, {{0, 0}, 0, 20.0, 10, Mix64(hash)});
    EXPECT_LT(source.x, 100) << "the other pane is 30 degrees away";
    tenths.insert(source.x / 10 * 100 + source.y / 10);
    const Source any = variation.Choose(*exemplar, {{0, 0}, 0, 31.0, 10, Mix64(hash)});
    both.insert(any.x / 10 * 100 + any.y / 10);
  }
  EXPECT_GT(tenths.size(), 100u) << "of 120 squares of the left pane";
  EXPECT_GT(both.size(), 200u) << "of 240 of both";
}

TEST(Seeds, TheTwoNearestAreThoseOfASearch) {
  const Region region{0, 0, 150, 90};
  for (const int level : {0, 1, 3, 5}) {
    const SeedGrid grid({7, 0, level == 3 ? 0.0f : 1.0f, 0}, level, region);
    for (int y = 0; y < 90; ++y) {
      for (int x = 0; x < 150; ++x) {
        std::vector<std::pair<std::int64_t, int>> order;  // by distance, then in row order
        for (int dy = -1; dy <= 1; ++dy) {
          for (int dx = -1; dx <= 1; ++dx) {
            const PixelPosition seed =
                SeedOfCell({7, 0, level == 3 ? 0.0f : 1.0f, 0}, level, (x >> level) + dx, (y >> level) + dy);
            const std::int64_t ex = seed.x - x, ey = seed.y - y;
            order.emplace_back(ex * ex + ey * ey, 3 * dy + dx);
          }
        }
        std::sort(order.begin(), order.end());
        const SeedGrid::Two two = grid.NearestTwo(x, y);
        ASSERT_EQ(two.nearest, grid.Nearest(x, y));
        ASSERT_EQ(two.excess, order[1].first - order[0].first);
        const PixelPosition at = grid.Position(two.second);
        const std::int64_t ex = at.x - x, ey = at.y - y;
        ASSERT_EQ(ex * ex + ey * ey, order[1].first);
        ASSERT_NE(two.second, two.nearest);
      }
    }
  }
}

TEST(Borders, GoWhereThePaintFitsBetter) {
  using internal::InBorderBand;
  using internal::SecondWins;
  EXPECT_FALSE(SecondWins(6, 0, 0)) << "the nearest seed wins where nothing speaks against it";
  EXPECT_TRUE(SecondWins(6, 0, 1)) << "midway the tone alone decides";
  EXPECT_FALSE(SecondWins(6, 1, -5));
  // Farther from the middle it takes more, in proportion; equally on every level at an equal share of the grid.
  for (const int level : {3, 6, 9}) {
    const std::int64_t h2 = std::int64_t{1} << (2 * level);
    EXPECT_TRUE(InBorderBand(level, 0));
    EXPECT_FALSE(InBorderBand(level, h2));
    int least = 0;
    while (!SecondWins(level, h2 / 4, least)) least += 10;
    int least_half = 0;
    while (!SecondWins(level, h2 / 8, least_half)) least_half += 10;
    EXPECT_NEAR(least, 2 * least_half, 30) << level;
  }
}

// A wall that the exemplar paints light and dark side by side.
TEST(Variety, KeepsTheToneOfTheWall) {
  const GuideSet wall = MakeGuides(400, 300, [](int, int) { return glm::normalize(glm::vec3(-0.25f, 0.0f, 1.0f)); });
  Style style = PlainStyle(TwoTones(512, 512));
  style.transfer.levels = 6;
  const PictureRegion all{0, 0, 400, 300};
  const Transferred before = MustTransfer(style, wall);
  style.transfer.variety = 30.0;
  const Transferred after = MustTransfer(style, wall);
  EXPECT_NE(after.picture.rgba, before.picture.rgba);
  EXPECT_LT(ToneSpread(after.picture, all, 8.0), 0.02)
      << "the dark half is within 30 degrees, and would show as patches";
  std::set<std::pair<int, int>> sources, own;
  for (std::size_t i = 0; i < after.field.x.size(); ++i) {
    sources.insert({after.field.x[i], after.field.y[i]});
    own.insert({before.field.x[i], before.field.y[i]});
  }
  EXPECT_GT(sources.size(), 2 * own.size());
}

// A preview of half the size has the choices of the final picture.
TEST(Variety, APreviewShowsTheFinalPicturesPieces) {
  const auto field_at = [](int size, std::uint64_t seed) {
    Style style = PlainStyle(TwoTones(512, 512));
    style.transfer.reference_height = 512, style.transfer.levels = 6, style.transfer.variety = 25.0;
    TransferOptions options;
    options.seed = seed;
    const GuideSet wall =
        MakeGuides(size, size, [](int, int) { return glm::normalize(glm::vec3(-0.25f, 0.1f, 1.0f)); });
    return MustTransfer(style, wall, options).field;
  };
  const SourceField full = field_at(512, 0);
  const auto shared = [&](const SourceField& half) {
    int same = 0;
    for (int y = 0; y < 256; ++y) {
      for (int x = 0; x < 256; ++x) {
        const std::size_t p = half.Index(x, y), q = full.Index(2 * x, 2 * y);
        same += std::abs(full.x[q] - 2 * half.x[p]) <= 6 && std::abs(full.y[q] - 2 * half.y[p]) <= 6;
      }
    }
    return same / (256.0 * 256.0);
  };
  const double same_seeds = shared(field_at(256, 0)), other_seeds = shared(field_at(256, 1));
  EXPECT_GT(same_seeds, 0.6);
  EXPECT_LT(other_seeds, 0.3 * same_seeds);
}

// What measures call a flat surface (measure/flat_surfaces.h) is where the transfer finds one, there or a reach
// away.
TEST(Variety, MeasuresFindTheSameFlatPlaces) {
  constexpr int kSide = 40, kReach = 3;
  GuideSet guides(kSide, kSide);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kObject}) guides.Add(layer);
  std::vector<std::uint8_t> active(guides.pixel_count());
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {  // blocks of some normals and objects, some of them holes
      const std::size_t i = guides.Index(x, y);
      const std::uint64_t block = Hash(x / 9, y / 7), angle = block % 3;
      active[i] = block % 5 != 0;
      guides.Plane(Layer::kCoverage)[i] = active[i];
      guides.Plane(Layer::kObject)[i] = float(block / 16 % 2);
      guides.Plane(Layer::kNormal, 0)[i] =
          float(std::sin(0.4 * kRadians * double(angle)));  // 0.4 degrees are flat, 0.8 not
      guides.Plane(Layer::kNormal, 2)[i] = float(std::cos(0.4 * kRadians * double(angle)));
    }
  }
  const PreparedExemplar exemplar(NoisePicture(32), 2.0, 32);
  const Illumination none;
  const internal::MatchInput input{guides,
                                   active,
                                   exemplar,
                                   none,
                                   {},
                                   GuideTest(0.1f, ThresholdMetric::kL2),
                                   {},
                                   4,
                                   15.0,
                                   kReach,
                                   {0, 0, kSide, kSide}};
  const auto is_flat = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= kSide || y >= kSide || !active[guides.Index(x, y)]) return false;
    return internal::IsFlat(input, {x, y}, kReach);
  };
  const auto found = FlatSurfaces(guides, kReach);
  int flat = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const std::size_t i = guides.Index(x, y);
      if (is_flat(x, y)) {
        EXPECT_EQ(found[i], 1);
        ++flat;
      }
      if (!found[i]) continue;
      bool near = false;
      for (const int dy : {-kReach, 0, kReach}) {
        for (const int dx : {-kReach, 0, kReach}) near = near || is_flat(x + dx, y + dy);
      }
      EXPECT_TRUE(near) << x << ", " << y;
    }
  }
  EXPECT_GT(flat, 50);
  EXPECT_LT(flat, kSide * kSide / 2);
}

}  // namespace
}  // namespace scumble
