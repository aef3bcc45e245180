// Bands of light and the tone-mapped render against their formulas.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/image/color.h"
#include "core/image/oklab.h"
#include "tests/finish/finish_fixtures.h"

namespace scumble {
namespace {

// A ball under light from the viewer, of one grey.
GuideSet LitBall(int size, float radius) {
  GuideSet guides = BallGuides(size, radius);
  guides.Add(Layer::kLuminance), guides.Add(Layer::kAlbedo);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kLuminance)[i] = guides.Plane(Layer::kNormal, 2)[i];
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kAlbedo, c)[i] = 0.5f;
  }
  return guides;
}

double LightnessOf(const std::uint16_t* texel) {
  return OklabFromLinear({Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])}).x;
}

TEST(Toon, BordersOfBandsLieWhereTheLightSays) {
  const GuideSet guides = LitBall(240, 100.0f);
  ToonPass pass;
  pass.bands = 4, pass.tint = 0.0, pass.shade = 0.4;
  const Picture made = Finished(StepOf(pass), &guides, PlainPicture(240, 240, 9, 9, 9));
  const double base = std::cbrt(0.5);
  for (int b = 1; b < 4; ++b) {
    // Halfway between the lightness of the two bands.
    const double middle = base * (0.4 + 0.6 * (b - 0.5) / 3.0);
    int x = 120;
    while (LightnessOf(made.At(x, 119)) > middle) ++x;
    const double from = LightnessOf(made.At(x - 1, 119)), to = LightnessOf(made.At(x, 119));
    const double border = x - 0.5 + (from - middle) / (from - to) - 120.0;
    EXPECT_NEAR(border, 100.0 * std::sqrt(1.0 - b * b / 16.0), 0.5) << b;
  }
}

TEST(Toon, ThresholdsSayWhereBandsBegin) {
  const GuideSet guides = LitBall(240, 100.0f);
  ToonPass pass;
  pass.thresholds = {0.2, 0.75}, pass.tint = 0.0, pass.shade = 0.4;
  const Picture made = Finished(StepOf(pass), &guides, PlainPicture(240, 240, 9, 9, 9));
  const double base = std::cbrt(0.5);
  for (const auto& [middle, at] : {std::pair(base * 0.85, 0.75), {base * 0.55, 0.2}}) {
    int x = 120;
    while (LightnessOf(made.At(x, 119)) > middle) ++x;
    const double from = LightnessOf(made.At(x - 1, 119)), to = LightnessOf(made.At(x, 119));
    EXPECT_NEAR(x - 0.5 + (from - middle) / (from - to) - 120.0, 100.0 * std::sqrt(1.0 - at * at), 0.5) << at;
  }
  pass.bands = 4;
  const FinishStep step = StepOf(pass);
  const Status checked = CheckFinish(std::span(&step, 1), &guides);
  ASSERT_FALSE(checked);
  EXPECT_THAT(checked.error().message, ::testing::HasSubstr("set finish.it.bands to 3"));
}

TEST(Toon, InsideABandNothingVaries) {
  const GuideSet guides = LitBall(240, 100.0f);
  ToonPass pass;
  pass.softness = 0.0;
  const Picture made = Finished(StepOf(pass), &guides, PlainPicture(240, 240, 9, 9, 9));
  std::set<std::uint16_t> values;
  for (int x = 25; x < 215; ++x) values.insert(made.At(x, 120)[0]);
  EXPECT_EQ(values.size(), 3u);
}

TEST(Toon, ManyBandsAreTheLightItself) {
  const GuideSet guides = LitBall(240, 100.0f);
  ToonPass pass;
  pass.bands = 64, pass.shade = 0.0, pass.tint = 0.0;
  const Picture made = Finished(StepOf(pass), &guides, PlainPicture(240, 240, 9, 9, 9));
  for (int x = 30; x < 210; ++x) {
    const double light = guides.Plane(Layer::kLuminance)[guides.Index(x, 120)];
    EXPECT_NEAR(LightnessOf(made.At(x, 120)) / std::cbrt(0.5), light, 1.5 / 63.0) << x;
  }
}

TEST(Toon, OneBandIsTheBaseColour) {
  GuideSet guides = LitBall(40, 15.0f);
  ToonPass pass;
  pass.bands = 1;
  const Picture made = Finished(StepOf(pass), &guides, PlainPicture(40, 40, 9, 9, 9));
  EXPECT_NEAR(made.At(20, 20)[0], Srgb16FromLinear(0.5f), 10);
  EXPECT_EQ(made.At(20, 20)[0], made.At(10, 20)[0]);
}

// A step of the light that stays above the border, however near to it.
TEST(Toon, LightThatOnlyBendsMakesNoLine) {
  GuideSet guides = FlatGuides(40, 8);
  guides.Add(Layer::kAlbedo);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i)
    guides.Plane(Layer::kLuminance)[i] = i % 40 < 20 ? 0.67f : 0.95f;
  const Picture made = Finished(StepOf(ToonPass()), &guides, PlainPicture(40, 8, 9, 9, 9));
  for (int x = 1; x < 40; ++x) EXPECT_EQ(made.At(x, 4)[0], made.At(0, 4)[0]) << x;
}

TEST(Toon, BordersAreSoftAndObjectsApart) {
  GuideSet guides = FlatGuides(40, 8);
  guides.Add(Layer::kAlbedo);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    const int x = int(i % 40);
    guides.Plane(Layer::kLuminance)[i] = x < 20 ? 0.5f + 0.0166f * static_cast<float>(x) : 0.1f;
    guides.Plane(Layer::kObject)[i] = x < 20 ? 1.0f : 2.0f;
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kAlbedo, c)[i] = 0.5f;
  }
  ToonPass pass;
  pass.softness = 2.0;
  const Picture made = Finished(StepOf(pass), &guides, PlainPicture(40, 8, 9, 9, 9));
  std::set<std::uint16_t> left, right;
  for (int x = 0; x < 20; ++x) left.insert(made.At(x, 4)[0]);
  for (int x = 20; x < 40; ++x) right.insert(made.At(x, 4)[0]);
  EXPECT_THAT(left.size(), ::testing::AllOf(::testing::Ge(4u), ::testing::Le(6u))) << "two bands, and 4 pixels between";
  EXPECT_EQ(right.size(), 1u) << "another object's light does not reach over";
}

TEST(Toon, BandsShadeThePaintWhereAsked) {
  GuideSet guides = FlatGuides(8, 1);
  for (std::size_t x = 0; x < 4; ++x) guides.Plane(Layer::kLuminance)[x] = 0.0f;
  ToonPass pass;
  pass.base = ToonPass::Color::kPaint, pass.tint = 0.0, pass.shade = 0.5;
  const Picture paint = PlainPicture(8, 1, 50000, 30000, 20000);
  const Picture made = Finished(StepOf(pass), &guides, paint);
  EXPECT_NEAR(LightnessOf(made.At(0, 0)), 0.5 * LightnessOf(paint.At(0, 0)), 1e-3);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(made.At(7, 0)[c], paint.At(7, 0)[c], 10);
}

TEST(Render, IsReinhardsCurve) {
  GuideSet guides = FlatGuides(8, 1);
  guides.Add(Layer::kLpeFull);
  for (int x = 0; x < 8; ++x) {
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kLpeFull, c)[std::size_t(x)] = 0.5f * static_cast<float>(x);
  }
  FinishMeasures measures;
  measures.full = 2.0;
  const Picture made = Finished(StepOf(RenderPass()), &guides, PlainPicture(8, 1, 9, 9, 9), measures);
  for (int x = 0; x < 8; ++x) {
    const double light = 0.5 * x * 0.8 / 2.0, expected = light * (1.0 + light / 16.0) / (1.0 + light);
    EXPECT_NEAR(Srgb16ToLinear(made.At(x, 0)[1]), expected, 1e-3) << x;
  }
  RenderPass brighter;
  brighter.exposure = 1.0;
  const double light = 0.5 * 2 * 0.8 / 2.0 * 2.0;
  EXPECT_NEAR(Srgb16ToLinear(Finished(StepOf(brighter), &guides, PlainPicture(8, 1, 9, 9, 9), measures).At(2, 0)[0]),
              light * (1.0 + light / 16.0) / (1.0 + light), 1e-3);
}

TEST(Render, BrightestTenthIsMeasured) {
  GuideSet guides = FlatGuides(11, 1);
  guides.Add(Layer::kLpeFull);
  for (int x = 0; x < 11; ++x) {
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kLpeFull, c)[std::size_t(x)] = static_cast<float>(x);
  }
  EXPECT_NEAR(MeasureFinish(guides).full, 9.0, 1e-5);
}

}  // namespace
}  // namespace scumble
