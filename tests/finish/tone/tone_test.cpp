// Effects that treat every pixel by itself, against their formulas.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>

#include "core/filter/oklab_rows.h"
#include "core/image/color.h"
#include "core/image/oklab.h"
#include "finish/tone/point_effect.h"
#include "finish/tone/sigmoid.h"
#include "tests/finish/finish_fixtures.h"

namespace scumble {
namespace {

glm::vec3 LabOf(const std::uint16_t* texel) {
  return OklabFromLinear({Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])});
}

std::uint16_t GreyOf(double lightness) {  // Oklab's lightness of a grey is the cube root of its linear value
  return Srgb16FromLinear(static_cast<float>(lightness * lightness * lightness));
}

TEST(OklabRows, AreTheScalarFormulasAndComeBack) {
  const Picture picture = ColorfulPicture(64, 64);
  for (int y = 0; y < 64; ++y) {
    internal::OklabBlock block;
    internal::OklabFromTexels(picture.At(0, y), 61, block);
    std::vector<std::uint16_t> texels(picture.At(0, y), picture.At(0, y) + 4 * 64);
    for (std::size_t x = 0; x < 61; ++x) {
      const glm::vec3 lab = LabOf(picture.At(int(x), y));
      EXPECT_NEAR(block.lightness[x], lab.x, 2e-6);
      EXPECT_NEAR(block.a[x], lab.y, 2e-6);
      EXPECT_NEAR(block.b[x], lab.z, 2e-6);
    }
    internal::TexelsFromOklab(block, 61, texels.data());
    for (std::size_t i = 0; i < texels.size(); ++i) {
      EXPECT_LE(std::abs(int(texels[i]) - int(picture.At(0, y)[i])), i < 4 * 61 ? 8 : 0) << i;
    }
  }
}

TEST(OklabRows, ColoursThatDoNotExistLoseChromaAndKeepHue) {
  internal::OklabBlock block;
  block.lightness[0] = 0.6f, block.a[0] = 0.5f, block.b[0] = 0.25f;
  block.lightness[1] = 1.5f, block.a[1] = 0.0f, block.b[1] = 0.0f;
  std::uint16_t texels[8] = {0, 0, 0, 7, 0, 0, 0, 8};
  internal::TexelsFromOklab(block, 2, texels);
  const glm::vec3 lab = LabOf(texels);
  EXPECT_NEAR(lab.x, 0.6, 1e-3);
  EXPECT_NEAR(lab.z / lab.y, 0.5, 0.01);
  EXPECT_EQ(texels[3], 7);
  EXPECT_THAT(texels, ::testing::Contains(65535).Times(3)) << "white";
}

TEST(Tones, LevelsAndMiddlesStayAndTheCurveRises) {
  for (const double sharpness : {0.5, 4.0, 64.0}) {
    TonesPass pass;
    pass.bins = 5, pass.sharpness = sharpness;
    Picture greys(8193, 1);
    for (int x = 0; x <= 8192; ++x) {
      std::fill_n(greys.At(x, 0), 3, GreyOf(x / 8192.0));
      greys.At(x, 0)[3] = 65535;
    }
    const Picture made = Finished(StepOf(pass), nullptr, greys);
    for (int x = 1; x <= 8192; ++x) EXPECT_GE(made.At(x, 0)[0] + 1, made.At(x - 1, 0)[0]) << sharpness << ' ' << x;
    for (int x = 0; x <= 8192; x += 2048) EXPECT_NEAR(LabOf(made.At(x, 0)).x, x / 8192.0, 2e-4) << sharpness;
    for (int x = 1024; x <= 8192; x += 2048) {
      // The hard curve jumps there.
      const double reach = sharpness < 10.0 ? 2e-3 : 0.2;
      EXPECT_NEAR(LabOf(made.At(x, 0)).x, x / 8192.0, reach) << sharpness;
    }
  }
}

// Only hard steps are the same when taken twice. Soft ones, taken again and again, bring all greys to levels, but for
// those in the middle between two, which stay.
TEST(Tones, TakenAgainAndAgainComeToLevels) {
  TonesPass pass;
  pass.bins = 5, pass.sharpness = 4.0;
  Picture greys(41, 1);
  for (int x = 0; x <= 40; ++x) {
    std::fill_n(greys.At(x, 0), 3, GreyOf(x / 40.0));
    greys.At(x, 0)[3] = 65535;
  }
  const auto off_level = [](const Picture& picture, int x) {
    const double level = 4.0 * double(LabOf(picture.At(x, 0)).x);
    return std::abs(level - std::round(level));
  };
  const Picture once = Finished(StepOf(pass), nullptr, greys), twice = Finished(StepOf(pass), nullptr, once);
  Picture often = twice;
  for (int i = 0; i < 8; ++i) often = Finished(StepOf(pass), nullptr, often);
  for (int x = 0; x <= 40; ++x) {
    if (x % 10 == 5) continue;
    EXPECT_LE(off_level(twice, x), off_level(once, x) + 1e-3) << x;
    EXPECT_LT(off_level(often, x), 1e-3) << x;
    EXPECT_NEAR(LabOf(often.At(x, 0)).x, std::round(x / 10.0) / 4.0, 1e-3) << x;
  }
}

TEST(Sigmoid, IsNearTheHyperbolicTangent) {
  for (int i = -500; i <= 500; ++i) {
    const float x = float(i) / 100.0f;
    EXPECT_NEAR(internal::Sigmoid(x), std::tanh(double(x)), 0.024) << x;
    EXPECT_GE(internal::Sigmoid(x) + 1e-6f, internal::Sigmoid(x - 0.01f)) << x;
  }
  EXPECT_EQ(internal::Sigmoid(3.0f), 1.0f);
}

TEST(Tones, AreTheFormula) {
  for (const double sharpness : {1e-9, 1e-5, 0.01, 0.011, 0.5, 4.0, 64.0}) {
    for (const int bins : {2, 5, 32}) {
      TonesPass pass;
      pass.bins = bins, pass.sharpness = sharpness;
      internal::OklabBlock block{};
      for (std::size_t i = 0; i < internal::kOklabBlock; ++i) block.lightness[i] = float(i) / 255.0f;
      internal::MakeTones(pass)(0, internal::kOklabBlock, block);
      for (std::size_t i = 0; i < internal::kOklabBlock; ++i) {
        const double given = double(float(i) / 255.0f), width = 1.0 / (bins - 1);
        const double middle = (std::min(std::floor(given / width), bins - 2.0) + 0.5) * width;
        const double step = PlainSigmoid(2.0 * sharpness * (given - middle) / width) / PlainSigmoid(sharpness);
        // Next to a middle a hard step turns the rounding of its place into `sharpness` times as much.
        EXPECT_NEAR(block.lightness[i], middle + 0.5 * width * step, 8e-6 + 4e-7 * sharpness)
            << sharpness << ' ' << bins << ' ' << i;
      }
    }
  }
}

TEST(Tones, HardStepsAreWhatTheBinsSay) {
  TonesPass pass;
  pass.bins = 4, pass.sharpness = 64.0;
  std::set<int> levels;
  for (int i = 0; i <= 300; ++i) {
    if (i % 100 > 45 && i % 100 < 55) continue;  // near a border the curve goes on
    const Picture made =
        Finished(StepOf(pass), nullptr, PlainPicture(1, 1, GreyOf(i / 300.0), GreyOf(i / 300.0), GreyOf(i / 300.0)));
    levels.insert(int(std::lround(LabOf(made.At(0, 0)).x * 300.0)));
  }
  EXPECT_THAT(levels, ::testing::ElementsAre(0, 100, 200, 300));
}

// Strokes of the paint do not cross a step, which is the light's.
TEST(Tones, OfTheLightLeaveNoSpecksInPaint) {
  GuideSet guides = FlatGuides(60, 8);
  Picture paint(60, 8);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 60; ++x) {
      guides.Plane(Layer::kLuminance)[guides.Index(x, y)] = x < 30 ? 0.2f : 0.9f;
      std::fill_n(paint.At(x, y), 3, GreyOf(x * 5 % 7 < 3 ? 0.45 : 0.53));
      paint.At(x, y)[3] = 65535;
    }
  }
  TonesPass pass;
  pass.bins = 3, pass.sharpness = 64.0;
  const auto steps = [&](const Picture& made) {
    int count = 0;
    for (int x = 1; x < 60; ++x) count += std::fabs(LabOf(made.At(x, 4)).x - LabOf(made.At(x - 1, 4)).x) > 0.15;
    return count;
  };
  ASSERT_EQ(steps(paint), 0);
  pass.bins = 2;
  EXPECT_GT(steps(Finished(StepOf(pass), &guides, paint)), 5) << "of the paint";
  pass.tone = TonesPass::Tone::kLight;
  EXPECT_EQ(steps(Finished(StepOf(pass), &guides, paint)), 1) << "of the light";
  EXPECT_TRUE(RequiredLayers(StepOf(pass).pass).Has(Layer::kLuminance));
}

TEST(Tones, NoSharpnessIsTheSameBytes) {
  TonesPass pass;
  pass.sharpness = 0.0;
  const Picture picture = ColorfulPicture(300, 20);
  const Picture made = Finished(StepOf(pass), nullptr, picture);
  EXPECT_EQ(made.rgba, picture.rgba);
}

TEST(Shadows, FullLightIsTheSameBytes) {
  const GuideSet guides = FlatGuides(64, 8);
  const Picture picture = ColorfulPicture(64, 8);
  using Mode = ShadowsPass::Mode;
  for (const Mode mode : {Mode::kBlack, Mode::kDarker, Mode::kColor, Mode::kComplement, Mode::kNegative}) {
    ShadowsPass pass;
    pass.mode = mode;
    EXPECT_EQ(Finished(StepOf(pass), &guides, picture).rgba, picture.rgba) << int(mode);
  }
}

TEST(Shadows, FullShadeIsBlack) {
  GuideSet guides = FlatGuides(64, 8);
  for (float& value : guides.Plane(Layer::kShadow)) value = 1.0f;
  ShadowsPass pass;
  pass.mode = ShadowsPass::Mode::kBlack, pass.source = ShadowsPass::Source::kCast;
  const Picture made = Finished(StepOf(pass), &guides, ColorfulPicture(64, 8));
  for (std::size_t i = 0; i < made.rgba.size(); ++i) EXPECT_EQ(made.rgba[i], i % 4 == 3 ? 65535 : 0);
}

TEST(Shadows, ComplementTwiceIsThePaintAgain) {
  GuideSet guides = FlatGuides(16, 1);
  for (float& value : guides.Plane(Layer::kShadow)) value = 1.0f;
  ShadowsPass pass;
  pass.mode = ShadowsPass::Mode::kComplement, pass.source = ShadowsPass::Source::kCast;
  const Picture paint = PlainPicture(16, 1, 38000, 30000, 27000);
  const Picture once = Finished(StepOf(pass), &guides, paint);
  const glm::vec3 was = LabOf(paint.At(0, 0)), is = LabOf(once.At(0, 0));
  EXPECT_NEAR(is.x, was.x, 1e-4);
  EXPECT_NEAR(is.y, -was.y, 1e-4);
  EXPECT_NEAR(is.z, -was.z, 1e-4);
  const Picture twice = Finished(StepOf(pass), &guides, once);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(twice.At(0, 0)[c], paint.At(0, 0)[c], 2);
}

// Grey has no opposite hue, and stays grey unless the pass gives one.
TEST(Shadows, ComplementOfGreyIsGrey) {
  GuideSet guides = FlatGuides(1, 1);
  guides.Plane(Layer::kShadow)[0] = 1.0f;
  ShadowsPass pass;
  pass.mode = ShadowsPass::Mode::kComplement;
  const Picture grey = PlainPicture(1, 1, 32896, 32896, 32896);
  const Picture made = Finished(StepOf(pass), &guides, grey);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(made.At(0, 0)[c], grey.At(0, 0)[c], 2);
}

TEST(Shadows, ComplementOfGreyHasTheGivenHue) {
  GuideSet guides = FlatGuides(1, 1);
  guides.Plane(Layer::kShadow)[0] = 1.0f;
  ShadowsPass pass;
  pass.mode = ShadowsPass::Mode::kComplement, pass.color = {0x2020, 0x2020, 0x8080}, pass.tint = 1.0;
  const Picture made = Finished(StepOf(pass), &guides, PlainPicture(1, 1, 30000, 30000, 30000));
  EXPECT_GT(made.At(0, 0)[2], made.At(0, 0)[0] + 3000);
}

TEST(Shadows, MoreShadeIsDarker) {
  GuideSet guides = FlatGuides(101, 1);
  for (int x = 0; x <= 100; ++x) guides.Plane(Layer::kShadow)[std::size_t(x)] = x / 100.0f;
  for (const auto mode : {ShadowsPass::Mode::kBlack, ShadowsPass::Mode::kDarker, ShadowsPass::Mode::kChiaroscuro}) {
    ShadowsPass pass;
    pass.mode = mode, pass.source = ShadowsPass::Source::kCast;
    const Picture made = Finished(StepOf(pass), &guides, PlainPicture(101, 1, 50000, 40000, 30000));
    for (int x = 1; x <= 100; ++x) EXPECT_LT(made.At(x, 0)[0], made.At(x - 1, 0)[0] + (x > 95)) << x;
  }
}

// A ball under light from the viewer's right: with sharp limits form shade begins where it turns from the light.
TEST(Shadows, FormShadeBeginsAtTheTerminator) {
  GuideSet guides = BallGuides(200, 90.0f);
  guides.Add(Layer::kLuminance);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i)
    guides.Plane(Layer::kLuminance)[i] = std::max(0.0f, guides.Plane(Layer::kNormal)[i]);
  ShadowsPass pass;
  pass.mode = ShadowsPass::Mode::kBlack, pass.source = ShadowsPass::Source::kForm;
  pass.full = 0.0, pass.none = 0.02;
  const Picture made = Finished(StepOf(pass), &guides, PlainPicture(200, 200, 60000, 60000, 60000));
  int border = 12;
  while (border < 200 && made.At(border, 100)[0] < 30000) ++border;
  EXPECT_NEAR(std::asin((border - 100) / 90.0) * 57.29578, 0.0, 1.0);
}

// Guides whose depth rises by 1 m a pixel from 5 m.
GuideSet Ramp(int width) {
  GuideSet guides = FlatGuides(width, 1);
  for (int x = 0; x < width; ++x) guides.Plane(Layer::kDepth)[std::size_t(x)] = 5.0f + static_cast<float>(x);
  return guides;
}

TEST(Depth, DesaturatesByTheFormula) {
  const GuideSet guides = Ramp(41);
  const Picture paint = PlainPicture(41, 1, 40000, 25000, 20000);
  const glm::vec3 was = LabOf(paint.At(0, 0));
  for (const double gamma : {1.0, 2.0, 0.5}) {
    DepthPass pass;
    pass.near = 15.0, pass.far = 35.0, pass.gamma = gamma, pass.desaturate = 0.8;
    const Picture made = Finished(StepOf(pass), &guides, paint);
    for (int x = 0; x < 41; ++x) {
      const double u = std::pow(std::clamp(std::fabs(5.0 + x - 15.0) / 20.0, 0.0, 1.0), gamma);
      const glm::vec3 is = LabOf(made.At(x, 0));
      EXPECT_NEAR(is.y / was.y, 1.0 - 0.8 * u, 2e-3) << x;
      EXPECT_NEAR(is.x, was.x, 2e-5) << "lightness stays";
    }
    EXPECT_THAT(std::vector(made.At(10, 0), made.At(10, 0) + 4), ::testing::ElementsAreArray(paint.At(10, 0), 4))
        << "in focus";
  }
}

TEST(Depth, LayersAreSoManyValues) {
  const GuideSet guides = Ramp(200);
  DepthPass pass;
  pass.near = 5.0, pass.far = 204.0, pass.layers = 4, pass.desaturate = 1.0;
  const Picture made = Finished(StepOf(pass), &guides, PlainPicture(200, 1, 40000, 25000, 20000));
  std::set<std::uint16_t> values;
  for (int x = 0; x < 200; ++x) values.insert(made.At(x, 0)[0]);
  EXPECT_EQ(values.size(), 4u);
}

TEST(Depth, SharesAreTheFormula) {
  const GuideSet guides = Ramp(200);
  DepthPass pass;
  pass.near = 15.0, pass.far = 135.0, pass.desaturate = 1.0;
  internal::OklabBlock block{};
  std::fill_n(block.a.begin(), 200, 1.0f);
  FinishFrame frame;
  frame.guides = &guides;
  internal::MakeDepth(pass, FinishPass::Stage::kPaint, frame)(0, 200, block);
  for (int x = 0; x < 200; ++x)
    EXPECT_NEAR(block.a[std::size_t(x)], 1.0 - std::clamp(std::fabs(x - 10.0) / 120.0, 0.0, 1.0), 1e-5) << x;
}

TEST(Depth, AirHasLayersToo) {
  const GuideSet guides = Ramp(200);
  DepthPass pass;
  pass.near = 5.0, pass.far = 204.0, pass.layers = 3, pass.desaturate = 0.0, pass.air = 0.75;
  const Picture made = Finished(StepOf(pass), &guides, PlainPicture(200, 1, 0, 0, 0));
  std::set<std::uint16_t> values;
  for (int x = 0; x < 200; ++x) values.insert(made.At(x, 0)[0]);
  EXPECT_EQ(values.size(), 3u);
  EXPECT_EQ(made.At(0, 0)[0], 0) << "near there is none";
}

TEST(Depth, AirFollowsBeerAndLambert) {
  GuideSet guides = Ramp(41);
  guides.Plane(Layer::kDepth)[40] = std::numeric_limits<float>::infinity();
  DepthPass pass;
  pass.near = 5.0, pass.far = 25.0, pass.desaturate = 0.0, pass.air = 0.75, pass.color = {65535, 65535, 65535};
  const Picture made = Finished(StepOf(pass), &guides, PlainPicture(41, 1, 0, 0, 0));
  for (int x = 0; x < 40; ++x) {
    EXPECT_NEAR(LabOf(made.At(x, 0)).x, 1.0 - std::pow(0.25, x / 20.0), 2e-3) << x;  // lightness goes to white's
  }
  EXPECT_EQ(made.At(40, 0)[0], made.At(20, 0)[0]) << "the background is as far as far";
}

// A sky is the painter's own; on a sheet, behind the paint, all is air.
TEST(Depth, SkyTakesTheAirAtFarAndASheetAllOfIt) {
  GuideSet guides = Ramp(41);
  guides.Plane(Layer::kDepth)[40] = std::numeric_limits<float>::infinity();
  guides.Plane(Layer::kCoverage)[40] = 0.0f;
  for (const DepthPass::Metric metric : {DepthPass::Metric::kLinear, DepthPass::Metric::kInverse}) {
    for (const int layers : {0, 3}) {
      DepthPass pass;
      pass.near = 5.0, pass.far = 25.0, pass.desaturate = 0.0, pass.air = 0.3, pass.color = {65535, 65535, 65535};
      pass.metric = metric, pass.layers = layers;
      FinishStep step = StepOf(pass);
      const Picture sky = PlainPicture(41, 1, 10000, 20000, 40000), made = Finished(step, &guides, sky);
      for (int c = 0; c < 3; ++c) EXPECT_EQ(made.At(40, 0)[c], made.At(20, 0)[c]) << int(metric) << ' ' << layers;
      if (metric == DepthPass::Metric::kInverse) continue;
      step.pass.at = FinishPass::Stage::kSheet;
      Picture sheet = sky;
      FinishFrame frame;
      frame.guides = &guides;
      ASSERT_TRUE(ApplyFinish(std::span(&step, 1), FinishPass::Stage::kSheet, frame, 0, {}, sheet));
      for (int c = 0; c < 3; ++c) EXPECT_EQ(sheet.At(40, 0)[c], 65535);
    }
  }
}

// Where no surface has been measured, near is far.
TEST(Depth, SkyAloneIsAsFarAsBehindSurfaces) {
  GuideSet guides(2, 1);
  for (const Layer layer : {Layer::kCoverage, Layer::kDepth}) guides.Add(layer);
  DepthPass pass;
  pass.desaturate = 0.0, pass.air = 0.3, pass.color = {65535, 65535, 65535};
  const Picture sky = PlainPicture(2, 1, 10000, 20000, 40000);
  EXPECT_EQ(Finished(StepOf(pass), &guides, sky).rgba, Finished(StepOf(pass), &guides, sky, {5, 9, 25, 1, 1}).rgba);
  EXPECT_NE(Finished(StepOf(pass), &guides, sky).rgba, sky.rgba);
}

TEST(Depth, InverseMetricIsEvenInReciprocals) {
  GuideSet guides = Ramp(3);
  auto depth = guides.Plane(Layer::kDepth);
  depth[0] = 1.0f, depth[1] = 4.0f / 3.0f, depth[2] = 2.0f;  // reciprocals 1, 3/4, 1/2
  DepthPass pass;
  pass.near = 1.0, pass.far = 2.0, pass.metric = DepthPass::Metric::kInverse, pass.desaturate = 1.0;
  const Picture paint = PlainPicture(3, 1, 40000, 25000, 20000);
  const Picture made = Finished(StepOf(pass), &guides, paint);
  EXPECT_NEAR(LabOf(made.At(1, 0)).y / LabOf(paint.At(0, 0)).y, 0.5, 1e-3);
}

TEST(Depth, MeasuresStandInForWhatIsNotGiven) {
  const GuideSet guides = Ramp(101);
  const FinishMeasures measures = MeasureFinish(guides);
  EXPECT_EQ(measures.near, 7.0);
  EXPECT_EQ(measures.middle, 55.0);
  EXPECT_EQ(measures.far, 103.0);
  EXPECT_EQ(measures.bright, 1.0);
  DepthPass pass, given;
  given.near = 7.0, given.far = 103.0;
  const Picture paint = ColorfulPicture(101, 1);
  EXPECT_EQ(Finished(StepOf(pass), &guides, paint, measures).rgba, Finished(StepOf(given), &guides, paint).rgba);
}

TEST(Depth, FarLiesBeyondNear) {
  const GuideSet guides = Ramp(41);
  DepthPass pass;
  pass.near = 60.0;
  const FinishStep step = StepOf(pass);
  const Status wrong = CheckFinish(std::span(&step, 1), &guides, MeasureFinish(guides));
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message, ::testing::HasSubstr("near is 60 m, far is 44 m, as measured"));
  pass.far = 80.0;
  const FinishStep right = StepOf(pass);
  EXPECT_TRUE(CheckFinish(std::span(&right, 1), &guides, MeasureFinish(guides)));
}

TEST(Grade, ScalesChromaAndLightness) {
  GradePass pass;
  pass.saturation = 0.0, pass.contrast = 0.5, pass.lift = 0.1;
  const Picture paint = PlainPicture(1, 1, 40000, 25000, 20000);
  const glm::vec3 was = LabOf(paint.At(0, 0)), is = LabOf(Finished(StepOf(pass), nullptr, paint).At(0, 0));
  EXPECT_NEAR(is.x, 0.5 + 0.5 * (was.x - 0.5) + 0.1, 1e-3);
  EXPECT_NEAR(is.y, 0.0, 1e-3);
}

TEST(Fill, IsItsColour) {
  FillPass pass;
  pass.color = {0x2424, 0x4848, 0x7f7f};
  const Picture made = Finished(StepOf(pass), nullptr, ColorfulPicture(9, 9));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(made.At(4, 4)[c], pass.color[std::size_t(c)], 8);
}

}  // namespace
}  // namespace scumble
