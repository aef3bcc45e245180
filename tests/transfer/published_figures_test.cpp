// The published figures that a number can hold, rebuilt from bundled scenes and styles: chunks by the weight of light
// (illuminated StyleBlit, figure 23) and a pattern of colours that paint keeps (colorized, figure 21). No ghosting at
// any depth tolerance (figure 20) is in tests/transfer/vote/vote_test.cpp.
#include <limits>
#include <tuple>

#include "core/image/color.h"
#include "core/style/style_file.h"
#include "guidegen/framing.h"
#include "guidegen/guidegen.h"
#include "guidegen/load_scene.h"
#include "tests/support/transfer_fixtures.h"
#include "transfer/seeds/seeds.h"

namespace scumble {
namespace {

using namespace testing;

constexpr int kFigureWidth = 320, kFigureHeight = 180;
constexpr std::uint64_t kSeed = 7;

// The still life with the shadows that its things throw on one another, exposed for a style.
const GuideSet& StillLife() {
  static const GuideSet kGuides = [] {
    Expected<Scene> scene = LoadScene(std::string(SCUMBLE_SOURCE_DIR) + "/scenes/stilllife.glb");
    EXPECT_TRUE(scene);
    Expected<PreparedView> view = PrepareView(*scene, "", std::nullopt, double(kFigureWidth) / kFigureHeight, false);
    EXPECT_TRUE(view);
    GuidegenOptions options;
    options.width = kFigureWidth, options.height = kFigureHeight;
    options.layers.Add(Layer::kLuminance);
    return std::move(RenderGuides(*scene, view->camera, options)->guides);
  }();
  return kGuides;
}

Style Bundled(const std::string& name) {
  Expected<Style> style = LoadStyle(std::string(SCUMBLE_SOURCE_DIR) + "/exemplars/" + name);
  EXPECT_TRUE(style) << (style ? "" : style.error().message);
  style->transfer.reference_height = 0;  // lengths are plain pixels
  style->transfer.levels = 5;
  return std::move(*style);
}

SourceField Field(const Style& style) {
  TransferOptions options;
  options.seed = kSeed;
  return MustTransfer(style, StillLife(), options).field;
}

// The exemplar whose luminance is nearest, the first of equals.
int Best(const Style& style, float luminance) {
  int best = 0;
  const auto off = [&](int k) { return std::fabs(luminance - static_cast<float>(*style.exemplars[k].luminance)); };
  for (int k = 1; k < static_cast<int>(style.exemplars.size()); ++k) best = off(k) < off(best) ? k : best;
  return best;
}

// The seed that a pixel of a level belongs to, over the nine cells around it.
PixelPosition SeedOf(int x, int y, int level, float jitter) {
  PixelPosition nearest;
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const PixelPosition seed = SeedOfCell({kSeed, 0, jitter, 0}, level, (x >> level) + dx, (y >> level) + dy);
      const std::int64_t across = seed.x - x, down = seed.y - y, distance = across * across + down * down;
      if (distance < least) least = distance, nearest = seed;
    }
  }
  return nearest;
}

double ShareWithoutChunk(const SourceField& field) {
  std::size_t covered = 0, alone = 0;
  for (const std::int8_t level : field.level) covered += level != SourceField::kNoSource, alone += level == 0;
  return static_cast<double>(alone) / static_cast<double>(covered);
}

TEST(Figure23, WithoutWeightLightChoosesAtTheSeedAndCutsNothing) {
  for (const char* name : {"chiaroscuro", "gouache", "ink", "pastel", "plein-air"}) {
    Style style = Bundled(name);
    style.transfer.luminance_weight = 0.0f;
    style.transfer.variety = 0.0f;  // it picks seeds of like tone, which differ from exemplar to exemplar
    Style first_only = style;
    first_only.exemplars.resize(1);
    const SourceField field = Field(style), alone = Field(first_only);
    EXPECT_TRUE(SameField(field, alone)) << name << ": chunks are those of one exemplar";
    const auto luminance = StillLife().Plane(Layer::kLuminance);
    std::size_t against_own_light = 0;
    for (int y = 0; y < kFigureHeight; ++y) {
      for (int x = 0; x < kFigureWidth; ++x) {
        const std::size_t i = StillLife().Index(x, y);
        if (field.level[i] == SourceField::kNoSource) continue;
        const PixelPosition seed =
            field.level[i] > 0 ? SeedOf(x, y, field.level[i], style.transfer.jitter) : PixelPosition{x, y};
        ASSERT_EQ(field.exemplar[i], Best(style, luminance[StillLife().Index(seed.x, seed.y)])) << x << ", " << y;
        against_own_light += field.exemplar[i] != Best(style, luminance[i]);
      }
    }
    EXPECT_GT(against_own_light, 1000u) << name << ": shadows must have something to lose here";
  }
}

TEST(Figure23, MoreWeightBringsShadowsNearerUntilTheyAreExact) {
  for (const char* name : {"chiaroscuro", "gouache", "ink", "pastel", "plein-air"}) {
    Style style = Bundled(name);
    style.transfer.threshold = 0.15f;
    const auto luminance = StillLife().Plane(Layer::kLuminance);
    std::size_t last = std::numeric_limits<std::size_t>::max(), without = 0;
    for (const float weight : {0.0f, 0.1f, 0.5f, 1e6f, std::numeric_limits<float>::infinity()}) {
      style.transfer.luminance_weight = weight;
      const SourceField field = Field(style);
      std::size_t against = 0;
      for (std::size_t i = 0; i < field.level.size(); ++i) {
        if (field.level[i] == SourceField::kNoSource) continue;
        against += field.exemplar[i] != Best(style, luminance[i]);
      }
      EXPECT_LE(against, last) << name << ", weight " << weight;
      if (weight == 0.0f) without = against;
      if (weight == 0.5f) {
        EXPECT_LT(2 * against, without) << name;
      }
      if (weight == std::numeric_limits<float>::infinity()) {
        EXPECT_EQ(against, 0u) << name;
        EXPECT_LT(ShareWithoutChunk(field), 0.5) << name << ": chunks live on away from the edges";
      }
      last = against;
    }
  }
}

TEST(Figure23, ThePublishedErrorLosesItsChunksWhereTheExcessKeepsThem) {
  Style style = Bundled("plein-air");
  style.transfer.threshold = 0.08f;
  for (const float weight : {0.5f, 5.0f}) {
    style.transfer.luminance_weight = weight;
    style.transfer.luminance_error = LuminanceError::kExcess;
    const double excess = ShareWithoutChunk(Field(style));
    style.transfer.luminance_error = LuminanceError::kPublished;
    const double published = ShareWithoutChunk(Field(style));
    EXPECT_GT(published, excess + 0.05) << "weight " << weight;
  }
}

// A sphere in stripes of red and blue, four pixels each: for any paint and any blend width, each stripe keeps its
// colour up to its last pixel.
TEST(Figure21, StripesAreKept) {
  GuideSet guides = SphereGuides(160);
  guides.Add(Layer::kAlbedo);
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 160; ++x) {
      const std::size_t i = guides.Index(x, y);
      if (!(guides.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
      const bool red = x / 4 % 2 == 0;
      const glm::vec3 albedo = red ? glm::vec3(0.7f, 0.08f, 0.05f) : glm::vec3(0.05f, 0.1f, 0.7f);
      for (int c = 0; c < 3; ++c) guides.Plane(Layer::kAlbedo, c)[i] = albedo[c];
    }
  }
  // The share of pixels that are redder than blue in the red stripes, and the reverse in the others.
  const auto right = [&](const Style& style) {
    const Picture picture = MustTransfer(style, guides).picture;
    double count = 0.0, covered = 0.0;
    for (int y = 0; y < 160; ++y) {
      for (int x = 0; x < 160; ++x) {
        const std::uint16_t* texel = picture.At(x, y);
        if (!(guides.Plane(Layer::kCoverage)[guides.Index(x, y)] > 0.0f)) continue;
        covered += 1.0;
        count += (x / 4 % 2 == 0) ? texel[0] > texel[2] : texel[2] > texel[0];
      }
    }
    return count / covered;
  };
  for (const char* name : {"graphite", "charcoal", "oil"}) {
    Style style = Bundled(name);
    style.transfer.blend_radius = 8;
    style.transfer.edge = EdgeMode::kExact;  // a painted edge has paper in it
    EXPECT_LT(right(style), 0.8) << name << ": without colour no paint has stripes";
    style.transfer.colorize = 1.0f;
    style.transfer.colorize_mode = ColorizeMode::kOklab;
    // Paint that is nearly white or black has no room for colour.
    EXPECT_GE(right(style), 0.97) << name;
    if (std::string(name) == "oil") continue;  // multiply is for grey paint: orange times blue is nearly black
    style.transfer.colorize_mode = ColorizeMode::kMultiply;
    EXPECT_EQ(right(style), 1.0) << name;
  }
}

}  // namespace
}  // namespace scumble
