// The variants that `scumble tradeoff` measures, and their guides and pictures.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "core/image/hash.h"
#include "core/io/guide_precision.h"
#include "guidegen/guidegen.h"
#include "pipeline/tradeoff/grid.h"
#include "pipeline/tradeoff/stage.h"
#include "tests/support/refusal.h"

namespace scumble {
namespace {

Style SphereStyle() {
  Style style;
  style.exemplars.emplace_back();
  return style;
}

Style SceneStyle() {
  Style style = SphereStyle();
  style.exemplars[0].is_sphere = false;
  return style;
}

Style LitStyle() {
  Style style = SceneStyle();
  style.transfer.guide_weights[Layer::kLuminance] = 1.0f;
  return style;
}

TradeGridOptions Sized(int width = 960, int height = 540) {
  TradeGridOptions options;
  options.width = width, options.height = height, options.samples = 64;
  return options;
}

std::vector<std::string> ValuesOf(const TradeGrid& grid, const std::string& axis) {
  std::vector<std::string> values;
  for (const Variant& variant : grid.variants) {
    if (variant.axis == axis) values.push_back(variant.value);
  }
  return values;
}

using Values = std::vector<std::string>;

Values SettingsOf(const Variant& variant) {
  Values texts;
  for (const StyleOverride& set : variant.settings) texts.push_back(set.text);
  return texts;
}

const Variant& Named(const TradeGrid& grid, const std::string& name) {
  static const Variant none;
  const auto found = std::find_if(grid.variants.begin(), grid.variants.end(),
                                  [&](const Variant& variant) { return variant.name == name; });
  EXPECT_NE(found, grid.variants.end()) << name;
  return found == grid.variants.end() ? none : *found;
}

// The table of a sphere is no reference: its cells are wider than pixels.
TEST(TradeGrid, TheExactWaySearchesByComparisonWhateverTheStyleDoes) {
  for (const NearestSearch nearest : {NearestSearch::kAnalytic, NearestSearch::kTable, NearestSearch::kTree}) {
    Style style = SphereStyle();
    style.transfer.nearest = nearest;
    const Values exact = SettingsOf(MakeTradeGrid(style, Sized()).variants[1]);
    EXPECT_EQ(std::count(exact.begin(), exact.end(), "transfer.nearest=tree"), nearest == NearestSearch::kTree ? 0 : 1);
  }
}

TEST(TradeGrid, OtherSeedsChangeNothingElse) {
  for (const bool quick : {false, true}) {
    TradeGridOptions options = Sized();
    options.quick = quick;
    const TradeGrid grid = MakeTradeGrid(SphereStyle(), options);
    EXPECT_EQ(ValuesOf(grid, "seed"), quick ? Values{"+1"} : (Values{"+1", "+2", "+3"}));
    EXPECT_TRUE(Named(grid, "seed +1").settings.empty());
    EXPECT_EQ(Named(grid, "seed +1").more_seed, 1);
  }
  for (const Method method : {Method::kLitSphere, Method::kBruteForce}) {
    Style flat = SphereStyle();
    flat.transfer.method = method;
    EXPECT_EQ(ValuesOf(MakeTradeGrid(flat, Sized()), "seed"), Values{}) << "nothing is left to chance";
    TradeGridOptions noisy = Sized();
    noisy.chance = true;
    EXPECT_EQ(ValuesOf(MakeTradeGrid(flat, noisy), "seed").size(), 3u) << "the light is";
  }
}

TEST(TradeGrid, OfASphereIsEveryAxisWithoutTheStylesOwnValues) {
  const TradeGrid grid = MakeTradeGrid(SphereStyle(), Sized());
  ASSERT_GE(grid.variants.size(), 2u);
  EXPECT_EQ(grid.variants[0].axis, kStyleAxis);
  EXPECT_TRUE(grid.variants[0].settings.empty()) << "the style changes nothing";
  EXPECT_EQ(grid.variants[1].axis, kExactAxis);
  EXPECT_EQ(SettingsOf(grid.variants[1]), (Values{"transfer.method=bruteforce", "transfer.nearest=tree"}))
      << "the formula is exact to a pixel, guides are floats";
  EXPECT_EQ(ValuesOf(grid, "method"), (Values{"litsphere", "bruteforce"}));
  EXPECT_EQ(ValuesOf(grid, "levels"), (Values{"1", "2", "3", "4", "5", "6", "8", "9"})) << "the style's are 7";
  EXPECT_EQ(ValuesOf(grid, "threshold"), (Values{"0.03125", "0.0625", "0.25", "0.5"}));
  EXPECT_EQ(ValuesOf(grid, "blend_radius"), (Values{"0", "2", "4", "8"}));
  EXPECT_EQ(ValuesOf(grid, "edge_aware"), (Values{"false"}));
  EXPECT_EQ(ValuesOf(grid, "match_step"), (Values{"2", "4"}));
  const Values nearest = ValuesOf(grid, "nearest");
  for (const char* value : {"table 32", "table 64", "table 128", "table 256", "table 512", "table 1024", "tree",
                            "tree within 10%", "tree within 50%", "tree within 200%"}) {
    EXPECT_TRUE(std::count(nearest.begin(), nearest.end(), value)) << value;
  }
  EXPECT_EQ(nearest.size(), 10u);
  EXPECT_EQ(ValuesOf(grid, "precision"), (Values{"8 bits", "half floats"}));
  EXPECT_EQ(ValuesOf(grid, "resolution"), (Values{"0.5", "0.5 scaled up", "2"}));
  EXPECT_EQ(Named(grid, "resolution 0.5 scaled up").guide_scale, 0.5);
  EXPECT_TRUE(Named(grid, "resolution 0.5 scaled up").upscale);
  EXPECT_EQ(ValuesOf(grid, "robust"), Values{"no"});
  EXPECT_TRUE(ValuesOf(grid, "samples").empty()) << "nothing is left to chance";
  EXPECT_EQ(Named(grid, "nearest table 64").table_resolution, 64);
  EXPECT_EQ(SettingsOf(Named(grid, "nearest table 64")), Values{"transfer.nearest=table"});
  EXPECT_EQ(Named(grid, "precision 8 bits").precision, GuidePrecision::kEightBits);
  EXPECT_EQ(Named(grid, "resolution 0.5").guide_scale, 0.5);
  EXPECT_FALSE(Named(grid, "robust no").robust);
  EXPECT_TRUE(grid.left_out.empty());
}

TEST(TradeGrid, CombinationsDifferInTwoThingsOrMore) {
  const TradeGrid grid = MakeTradeGrid(SphereStyle(), Sized());
  // 2 scales × (3 radii of the Lit Sphere + 3 levels × 3 radii), less the style itself and what differs in one thing:
  // of the full size 2 radii, 2 levels and the Lit Sphere with the style's radius, of the half size the style's own.
  EXPECT_EQ(ValuesOf(grid, "grid").size(), 24u - 1u - 2u - 2u - 1u - 1u);
  const Variant& one = Named(grid, "grid styleblit 3 levels radius 4 half size");
  EXPECT_EQ(one.guide_scale, 0.5);
  EXPECT_EQ(SettingsOf(one), (Values{"transfer.method=styleblit", "transfer.levels=3", "transfer.blend_radius=4"}));
}

TEST(TradeGrid, OfAPaintedSceneSearchesWithoutTheFormula) {
  const TradeGrid grid = MakeTradeGrid(SceneStyle(), Sized());
  const Values nearest = ValuesOf(grid, "nearest");
  EXPECT_FALSE(std::count(nearest.begin(), nearest.end(), "analytic"));
  EXPECT_FALSE(std::count(nearest.begin(), nearest.end(), "table 512")) << "the style's own";
  EXPECT_TRUE(std::count(nearest.begin(), nearest.end(), "tree"));
  EXPECT_EQ(SettingsOf(grid.variants[1]), (Values{"transfer.method=bruteforce", "transfer.nearest=tree"}));
}

TEST(TradeGrid, OfGuidesOfLightHasNoTablesAndAsksForSamplesWhereTheyCount) {
  TradeGridOptions options = Sized();
  EXPECT_TRUE(ValuesOf(MakeTradeGrid(LitStyle(), options), "samples").empty());
  options.chance = true;
  const TradeGrid grid = MakeTradeGrid(LitStyle(), options);
  EXPECT_EQ(ValuesOf(grid, "samples"), (Values{"1", "4", "16", "256", "1024"})) << "64 are the style's";
  EXPECT_EQ(ValuesOf(grid, "nearest"), (Values{"tree within 10%", "tree within 50%", "tree within 200%"}));
  EXPECT_EQ(Named(grid, "samples 4").samples, 4);
  EXPECT_EQ(grid.variants[1].samples, 1024) << "converged";
  EXPECT_EQ(SettingsOf(grid.variants[1]), Values{"transfer.method=bruteforce"});
}

TEST(TradeGrid, LeavesOutWhatCannotBeAndSaysSo) {
  const TradeGrid large =
      MakeTradeGrid(SphereStyle(), Sized(1025, 1025));  // odd, and 2049 pixels too many for brute force
  EXPECT_EQ(ValuesOf(large, "method"), Values{"litsphere"});
  EXPECT_EQ(ValuesOf(large, "resolution"), Values{"2"});
  EXPECT_EQ(SettingsOf(large.variants[1]), Values{"transfer.nearest=tree"});
  ASSERT_EQ(large.left_out.size(), 3u);
  EXPECT_NE(large.left_out[0].find("brute force in the exact variant"), std::string::npos);
  EXPECT_NE(large.left_out[1].find("bruteforce"), std::string::npos);
  EXPECT_NE(large.left_out[2].find("even"), std::string::npos);
  for (const Variant& variant : large.variants) EXPECT_NE(variant.guide_scale, 0.5) << variant.name;
  const TradeGrid whole = MakeTradeGrid(SphereStyle(), Sized(1024, 1024));  // a megapixel exactly
  EXPECT_EQ(ValuesOf(whole, "method"), (Values{"litsphere", "bruteforce"}));
  Style single = SphereStyle();
  single.transfer.method = Method::kLitSphere;
  const TradeGrid pixels = MakeTradeGrid(single, Sized());
  EXPECT_TRUE(ValuesOf(pixels, "levels").empty()) << "single pixels have none";
  EXPECT_TRUE(ValuesOf(pixels, "threshold").empty());
  Style infinite = SphereStyle();
  infinite.transfer.threshold = INFINITY;
  EXPECT_TRUE(ValuesOf(MakeTradeGrid(infinite, Sized()), "threshold").empty()) << "four times infinity is infinity";
}

TEST(TradeGrid, NamesAreUniqueAndTheQuickGridIsPartOfTheWhole) {
  for (const Style& style : {SphereStyle(), SceneStyle(), LitStyle()}) {
    TradeGridOptions options = Sized();
    options.chance = true;
    const TradeGrid whole = MakeTradeGrid(style, options);
    std::set<std::string> names;
    for (const Variant& variant : whole.variants) EXPECT_TRUE(names.insert(variant.name).second) << variant.name;
    options.quick = true;
    const TradeGrid quick = MakeTradeGrid(style, options);
    EXPECT_LE(quick.variants.size(), 24u);
    EXPECT_GE(quick.variants.size(), 10u);
    for (const Variant& variant : quick.variants) EXPECT_TRUE(names.count(variant.name)) << variant.name;
  }
}

TEST(ChooseVariants, TakesAxesAndNamesAndAlwaysTheStyle) {
  const TradeGrid grid = MakeTradeGrid(SphereStyle(), Sized());
  const auto names = [&](const std::string& only) {
    Values all;
    const auto chosen = ChooseVariants(grid.variants, only);
    EXPECT_TRUE(chosen.ok()) << only;
    for (const Variant& variant : chosen.ok() ? *chosen : std::vector<Variant>()) all.push_back(variant.name);
    return all;
  };
  EXPECT_EQ(names("").size(), grid.variants.size());
  EXPECT_EQ(names("robust"), (Values{"the style", "robust no"}));
  EXPECT_EQ(names("match_step,robust"), (Values{"the style", "match_step 2", "match_step 4", "robust no"}));
  EXPECT_EQ(names("levels *,robust").size(), 1u + 8u + 1u);
  EXPECT_EQ(names("nearest table 1*"), (Values{"the style", "nearest table 128", "nearest table 1024"}));
  EXPECT_EQ(names("exact"), (Values{"the style", "the exact variant"}));
  ExpectRefusal(ChooseVariants(grid.variants, "levles"), ErrorKind::kUsage,
                {"--only levles", "'levles'", "levels", "nearest", "precision"});
  ExpectRefusal(ChooseVariants(grid.variants, "levels,"), ErrorKind::kUsage, {"''"});
}

// ---- the guides and pictures of variants ----

GuideSet OnePixel(glm::vec3 normal, float luminance) {
  GuideSet guides(1, 1);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kLuminance}) guides.Add(layer);
  guides.Plane(Layer::kCoverage)[0] = 1.0f, guides.Plane(Layer::kDepth)[0] = 1.0f / 3.0f;
  guides.Plane(Layer::kLuminance)[0] = luminance;
  for (int c = 0; c < 3; ++c) guides.Plane(Layer::kNormal, c)[0] = normal[c];
  return guides;
}

// v goes to the nearest of 255 steps, so half a step, 1/510, is the most a colour is off; a normal's component has
// twice the range, 1/255. What is left of a float's rounding is 2^-22. Lengths are off by √3/255 at most; a reader
// makes it a unit vector, which moves it by no more than that again.
TEST(RoundGuides, EightBitsAreOffByHalfAStep) {
  for (int n = 0; n < 2000; ++n) {
    glm::vec3 normal;
    for (int c = 0; c < 3; ++c) normal[c] = 2.0f * UnitFloat(Hash(n, c)) - 1.0f;
    normal /= std::sqrt(normal.x * normal.x + normal.y * normal.y + normal.z * normal.z);
    const float light = UnitFloat(Hash(n, 3));
    GuideSet guides = OnePixel(normal, light);
    RoundGuides(GuidePrecision::kEightBits, guides);
    const glm::vec3 rounded = guides.Vec3(Layer::kNormal, 0);
    for (int c = 0; c < 3; ++c) {
      EXPECT_LE(std::fabs(rounded[c] - normal[c]), (1.0 + std::sqrt(3.0)) / 255.0 + 0x1p-22);
    }
    EXPECT_NEAR(rounded.x * rounded.x + rounded.y * rounded.y + rounded.z * rounded.z, 1.0, 0x1p-19);
    EXPECT_LE(std::fabs(guides.Plane(Layer::kLuminance)[0] - light), 1.0 / 510.0 + 0x1p-22);
    EXPECT_EQ(guides.Plane(Layer::kDepth)[0], 1.0f / 3.0f) << "no file of eight bits holds depths";
  }
  GuideSet along = OnePixel({0.0f, 0.0f, 1.0f}, 7.5f);
  RoundGuides(GuidePrecision::kEightBits, along);
  const double length = std::sqrt(1.0 + 2.0 / (255.0 * 255.0));  // a reader makes it a unit vector
  EXPECT_NEAR(along.Plane(Layer::kNormal, 0)[0], 1.0 / 255.0 / length, 0x1p-22)
      << "0 is 127.5 of 255: there is no such step";
  EXPECT_NEAR(along.Plane(Layer::kNormal, 2)[0], 1.0 / length, 0x1p-22);
  EXPECT_EQ(along.Plane(Layer::kLuminance)[0], 1.0f) << "brighter is cut";
}

// A half float has 11 bits, so 2^-11 of the value is the most it is off by.
TEST(RoundGuides, HalfFloatsAreOffByHalfAStepAndFloatsByNothing) {
  for (int n = 0; n < 2000; ++n) {
    const float z = UnitFloat(Hash(n)), x = std::sqrt(1.0f - z * z), light = 100.0f * UnitFloat(Hash(n, 1)) + 0.01f;
    GuideSet guides = OnePixel({x, 0.0f, z}, light);
    RoundGuides(GuidePrecision::kFloat, guides);
    EXPECT_EQ(guides.Vec3(Layer::kNormal, 0).z, z);
    RoundGuides(GuidePrecision::kHalf, guides);
    // Length is off by no more either, as a share, and a reader takes that back.
    EXPECT_LE(std::fabs(guides.Plane(Layer::kNormal, 2)[0] - z), z * 0x1p-10 + 0x1p-22);
    EXPECT_LE(std::fabs(guides.Plane(Layer::kLuminance)[0] - light), light * 0x1p-11);
  }
}

TEST(RoundGuides, LeavesTheBackgroundAsItIs) {
  GuideSet guides = OnePixel({0.0f, 0.0f, 0.0f}, 0.3f);
  guides.Plane(Layer::kCoverage)[0] = 0.0f;
  RoundGuides(GuidePrecision::kEightBits, guides);
  EXPECT_EQ(guides.Plane(Layer::kNormal, 0)[0], 0.0f) << "not the 1/255 that 0 is packed to";
  EXPECT_EQ(guides.Plane(Layer::kLuminance)[0], 0.3f);
}

TEST(Averaged, WeighsColoursByTheirAlpha) {
  Picture picture(4, 3);  // the third row and, of the right block, nothing is opaque
  const auto set = [&](int x, int y, std::uint16_t value, std::uint16_t alpha) {
    for (int c = 0; c < 3; ++c) picture.At(x, y)[c] = value;
    picture.At(x, y)[3] = alpha;
  };
  set(0, 0, 100, 65535), set(1, 0, 201, 65535), set(0, 1, 300, 65535), set(1, 1, 60000, 0);
  set(2, 0, 5, 0);
  const Picture half = Averaged(picture, 2);
  ASSERT_EQ(half.width, 2);
  ASSERT_EQ(half.height, 1);
  EXPECT_EQ(half.At(0, 0)[0], 200) << "601 / 3 to the nearest, without the clear pixel";
  EXPECT_EQ(half.At(0, 0)[3], 49151) << "three quarters of 65535 are 49151.25";
  EXPECT_EQ(half.At(1, 0)[0], 0);
  EXPECT_EQ(half.At(1, 0)[3], 0);
}

}  // namespace
}  // namespace scumble
