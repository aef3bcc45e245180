// Guides without information in normals: a flat wall in the light of a point light, with a shadow across it.
#include <algorithm>
#include <cmath>

#include "tests/support/scene_exemplar_fixtures.h"
#include "transfer/ambiguity.h"

namespace scumble {
namespace {

using namespace testing;

constexpr int kWallWidth = 160, kWallHeight = 120;
constexpr float kShade = 0.05f;

// A wall that faces the viewer, one unit behind a light at `lamp` (in pixels): the luminance of a point light on white
// Lambert is proportional to cos θ / r² = (1 + d²)^(-3/2), d being the distance along the wall in units of the light's.
// Right of `shadow` a screen leaves a twentieth of it.
float LightAt(float x, float y, glm::vec2 lamp, float unit, int shadow) {
  const float d = glm::length(glm::vec2(x + 0.5f, y + 0.5f) - lamp) / unit;
  return (x < shadow ? 1.0f : kShade) / std::pow(1.0f + d * d, 1.5f);
}

GuideSet Wall(int width, int height, glm::vec2 lamp, float unit, int shadow, float strength) {
  GuideSet guides = MakeGuides(width, height, [](int, int) { return glm::vec3(0, 0, 1); });
  guides.Add(Layer::kLuminance), guides.Add(Layer::kLpeLDE);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float light = strength * LightAt(float(x), float(y), lamp, unit, shadow);
      guides.Plane(Layer::kLuminance)[guides.Index(x, y)] = light;
      for (int c = 0; c < 3; ++c) guides.Plane(Layer::kLpeLDE, c)[guides.Index(x, y)] = light;
    }
  }
  return guides;
}

GuideSet LitWallGuides() { return Wall(kWallWidth, kWallHeight, {40, 60}, 60, 100, 30.0f); }

// The exemplar is another wall, lit from its middle and half of it in the shade of another screen.
Style WallStyle(Layer layer, float weight) {
  Style style = SceneStyle(WideNoise(128, 128), Wall(128, 128, {64, 64}, 40, 64, 1.0f));
  style.transfer.rim = 0.0;
  style.transfer.threshold = 0.03f;
  style.transfer.levels = 5;
  style.transfer.guide_weights[layer] = weight;
  return style;
}

struct Lit {
  double mean_stops = 0.0;      // between a pixel's light and its paint's
  double largest_distance = 0;  // of L / (1 + L)
};

Lit Compare(const Style& style, const SourceField& field, const GuideSet& guides, double exposure, double white) {
  Lit lit;
  const GuideSet& own = *style.exemplars[0].guides;
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    const double here = guides.Plane(Layer::kLuminance)[i] * std::exp2(exposure) / white;
    const double there = own.Plane(Layer::kLuminance)[own.Index(field.x[i], field.y[i])] / white;
    lit.mean_stops += std::fabs(std::log2(here / there)) / static_cast<double>(guides.pixel_count());
    lit.largest_distance = std::max(lit.largest_distance, std::fabs(here / (1 + here) - there / (1 + there)));
  }
  return lit;
}

TEST(LitWall, TakesPaintThatIsLitAsItIs) {
  const GuideSet guides = LitWallGuides();
  for (const Layer layer : {Layer::kLuminance, Layer::kLpeLDE}) {
    for (const Method method : {Method::kLitSphere, Method::kStyleBlit}) {
      Style style = WallStyle(layer, 1.0f);
      style.transfer.method = method;
      const auto prepared = Prepare(style, guides.height());
      ASSERT_TRUE(prepared.ok()) << prepared.error().message;
      TransferOptions options;
      options.exposure = *MeasureExposure({&*prepared, 1}, guides);
      EXPECT_LT(options.exposure, -3.0) << "thirty times as bright";
      const SourceField field = MustTransfer(style, guides, options).field;
      const Lit lit = Compare(style, field, guides, options.exposure, prepared->space->white());
      if (method == Method::kLitSphere) {
        EXPECT_LT(lit.mean_stops, 0.05);
      } else {
        EXPECT_LT(lit.mean_stops, 0.3);
        // No pixel of a chunk is farther off than the threshold; three equal channels count √3 of one. What no chunk
        // suits is nearer still. The scene's brightest places are brighter than any of the exemplar's.
        EXPECT_LT(lit.largest_distance, 0.03 + 1e-6);
      }
      // By normals alone every place is as good as any: the first.
      Style before = style;
      before.transfer.guide_weights = {};
      const SourceField plain = MustTransfer(before, guides).field;
      EXPECT_GT(Compare(before, plain, guides, options.exposure, prepared->space->white()).mean_stops, 1.0);
      if (method == Method::kLitSphere) {
        EXPECT_EQ(std::count(plain.x.begin(), plain.x.end(), plain.x[0]), std::ptrdiff_t(guides.pixel_count()));
      }
    }
  }
}

// The number of pairs across the shadow's edge that show one chunk.
int UncutPairs(const SourceField& field) {
  int uncut = 0;
  for (int y = 0; y < kWallHeight; ++y) {
    const std::size_t i = field.Index(99, y), j = field.Index(100, y);
    uncut += field.x[j] == field.x[i] + 1 && field.y[j] == field.y[i];
  }
  return uncut;
}

TEST(LitWall, ShadowsCutChunks) {
  const GuideSet guides = LitWallGuides();
  Style style = WallStyle(Layer::kLuminance, 1.0f);
  const auto prepared = Prepare(style, guides.height());
  ASSERT_TRUE(prepared.ok());
  TransferOptions options;
  options.exposure = *MeasureExposure({&*prepared, 1}, guides);
  EXPECT_EQ(UncutPairs(MustTransfer(style, guides, options).field), 0);
  // A wide search by variety does not avoid it either.
  style.transfer.variety = 30.0;
  EXPECT_EQ(UncutPairs(MustTransfer(style, guides, options).field), 0);
  style.transfer.guide_weights = {};
  style.transfer.variety = 0.0;
  EXPECT_GT(UncutPairs(MustTransfer(style, guides, options).field), kWallHeight / 2);
}

TEST(LitWall, ASphereUnderOneLampShowsEachDirectionInOneLight) {
  GuideSet sphere = SphereGuides(128);
  sphere.Add(Layer::kLuminance);
  const glm::vec3 lamp = glm::normalize(glm::vec3(-0.5f, 0.6f, 0.6f));
  for (std::size_t i = 0; i < sphere.pixel_count(); ++i) {
    sphere.Plane(Layer::kLuminance)[i] = std::fmax(0.0f, glm::dot(lamp, sphere.Vec3(Layer::kNormal, i)));
  }
  Style style = PlainStyle(NoisePicture(128));
  style.exemplars[0].guides = std::move(sphere);
  style.transfer.guide_weights[Layer::kLuminance] = 4.0f;
  const auto of_sphere = Prepare(style, 100), of_wall = Prepare(WallStyle(Layer::kLuminance, 4.0f), 100);
  ASSERT_TRUE(of_sphere.ok() && of_wall.ok());
  const GuideTest test(0.125f, ThresholdMetric::kL2);
  const SpaceAmbiguity a = MeasureAmbiguity(*of_sphere->space, *of_sphere->exemplar, 0, test);
  const SpaceAmbiguity b = MeasureAmbiguity(*of_wall->space, *of_wall->exemplar, 0, test);
  // One light of eight, and the neighbours that the threshold lets through; the wall is one direction in all light.
  EXPECT_GT(a.covered_percent, 100.0 / kLightSteps / 2);
  EXPECT_LT(a.covered_percent, 50.0);
  EXPECT_LT(b.covered_percent, 2.0);
  EXPECT_GT(b.covered_percent, 0.0);
  EXPECT_GT(a.cells_shown, 20 * b.cells_shown);
  EXPECT_LE(a.most_repeats, b.most_repeats);
  EXPECT_GT(b.mean_error, a.mean_error);
  const auto range = of_sphere->space->RangeOf(0, Layer::kLuminance);
  EXPECT_EQ(range.least, 0.0f);
  EXPECT_NEAR(range.largest, 0.52f, 0.02f) << "a little above the 90th percentile's 0.5";
}

}  // namespace
}  // namespace scumble
