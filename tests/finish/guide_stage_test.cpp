// Passes that change guides before anything is matched.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/image/color.h"
#include "tests/finish/finish_fixtures.h"

namespace scumble {
namespace {

using Guide = FinishPass::Guide;

FinishStep AtGuides(FinishPass::Effect effect, Guide guide) {
  FinishStep step = StepOf(std::move(effect));
  step.pass.at = FinishPass::Stage::kGuides, step.pass.guide = guide;
  return step;
}

// A ball in stripes of two base colours, with light from 0 at the left to 2 at the right.
GuideSet StripedBall() {
  GuideSet guides = BallGuides(80, 30.0f);
  guides.Add(Layer::kAlbedo), guides.Add(Layer::kLuminance);
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 80; ++x) {
      const std::size_t i = guides.Index(x, y);
      if (!(guides.Plane(Layer::kCoverage)[i] > 0.0f)) continue;
      for (int c = 0; c < 3; ++c) guides.Plane(Layer::kAlbedo, c)[i] = x / 2 % 2 ? 0.30f : 0.34f;
      guides.Plane(Layer::kLuminance)[i] = static_cast<float>(x) / 40.0f;
    }
  }
  return guides;
}

GuideSet Changed(const std::vector<FinishStep>& steps, GuideSet guides, int threads = 0, double bright = 1.0) {
  FinishMeasures measures;
  measures.bright = bright;
  const Status done = ApplyToGuides(steps, {nullptr, measures, 1.0, 3}, threads, {}, guides);
  EXPECT_TRUE(done);
  return guides;
}

std::vector<float> ValuesOf(const GuideSet& guides, Layer layer, int component = 0) {
  const auto plane = guides.Plane(layer, component);
  return {plane.begin(), plane.end()};
}

TEST(GuideStage, ColoursAreLinearAndTheBackgroundStays) {
  const GuideSet given = StripedBall();
  const Rgb16 color = {0x8000, 0x4000, 0xffff};
  const GuideSet made = Changed({AtGuides(FillPass{color}, Guide::kAlbedo)}, given);
  for (std::size_t i = 0; i < given.pixel_count(); ++i) {
    const bool covered = given.Plane(Layer::kCoverage)[i] > 0.0f;
    for (int c = 0; c < 3; ++c) {
      const float expected = covered ? Srgb16ToLinear(color[std::size_t(c)]) : 0.0f;
      ASSERT_NEAR(made.Plane(Layer::kAlbedo, c)[i], expected, 1e-4f);
    }
  }
  EXPECT_EQ(ValuesOf(made, Layer::kLuminance), ValuesOf(given, Layer::kLuminance));
  EXPECT_EQ(ValuesOf(made, Layer::kNormal), ValuesOf(given, Layer::kNormal));
}

TEST(GuideStage, LightAboveWhiteKeepsItsRatio) {
  const GuideSet given = StripedBall();
  const GuideSet made = Changed({AtGuides(FillPass{{0x8000, 0x8000, 0x8000}}, Guide::kLuminance)}, given, 0, 0.5);
  const float grey = 0.5f * Srgb16ToLinear(0x8000);
  for (const int x : {15, 30, 45, 60}) {
    const float light = static_cast<float>(x) / 40.0f;
    EXPECT_NEAR(made.Plane(Layer::kLuminance)[made.Index(x, 40)], grey * std::max(1.0f, light / 0.5f), 1e-4f) << x;
  }
}

TEST(GuideStage, SmoothedBaseColoursAreFlat) {
  const GuideSet given = StripedBall();
  SmoothPass smooth;
  smooth.radius = 6.0, smooth.passes = 3;
  const GuideSet made = Changed({AtGuides(smooth, Guide::kAlbedo)}, given);
  for (int x = 25; x < 55; ++x) EXPECT_NEAR(made.Plane(Layer::kAlbedo)[made.Index(x, 40)], 0.32f, 0.008f) << x;
}

TEST(GuideStage, WhatIsNotNamedKeepsItsBits) {
  const GuideSet given = StripedBall();
  FinishStep step = AtGuides(GradePass{1.0, 1.0, 0.2}, Guide::kLuminance);
  step.only.assign(given.pixel_count(), 0);
  for (std::size_t i = 0; i < step.only.size(); i += 3) step.only[i] = 1;
  const GuideSet made = Changed({step}, given);
  const auto before = ValuesOf(given, Layer::kLuminance), after = ValuesOf(made, Layer::kLuminance);
  int changed = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!step.only[i]) {
      ASSERT_EQ(before[i], after[i]) << i;
    }
    changed += before[i] != after[i];
  }
  EXPECT_GT(changed, 300);
  step.pass.strength = 0.0;
  EXPECT_FALSE(ChangesGuides({&step, 1}));
  EXPECT_EQ(ValuesOf(Changed({step}, given), Layer::kLuminance), before);
}

TEST(GuideStage, LaterPassesSeeEarlierOnes) {
  const GuideSet given = StripedBall();
  const std::vector<FinishStep> steps = {AtGuides(FillPass{{65535, 65535, 65535}}, Guide::kLuminance),
                                         AtGuides(GradePass{1.0, 1.0, -0.2}, Guide::kLuminance),
                                         AtGuides(FillPass{{0, 0, 0}}, Guide::kAlbedo)};
  const GuideSet made = Changed(steps, given);
  const float light = made.Plane(Layer::kLuminance)[made.Index(20, 40)];
  EXPECT_GT(light, 0.4f);
  EXPECT_LT(light, 0.7f);
  EXPECT_EQ(made.Plane(Layer::kAlbedo)[made.Index(20, 40)], 0.0f);
  EXPECT_EQ(ValuesOf(made, Layer::kLuminance), ValuesOf(Changed(steps, given, 1), Layer::kLuminance));
}

TEST(GuideStage, NumbersThatAreNoneEndThere) {
  GuideSet given = StripedBall();
  const float odd[] = {std::nanf(""), INFINITY, -1.0f};
  for (int k = 0; k < 3; ++k) {
    given.Plane(Layer::kLuminance)[given.Index(38 + k, 40)] = odd[k];
    given.Plane(Layer::kAlbedo)[given.Index(38 + k, 40)] = odd[k];
  }
  const GuideSet made =
      Changed({AtGuides(TonesPass(), Guide::kLuminance), AtGuides(SmoothPass(), Guide::kAlbedo)}, given);
  EXPECT_TRUE(std::isfinite(made.Plane(Layer::kLuminance)[made.Index(41, 40)]));
  EXPECT_TRUE(std::isfinite(made.Plane(Layer::kAlbedo)[made.Index(38, 40)]));
  EXPECT_TRUE(std::isfinite(made.Plane(Layer::kAlbedo)[made.Index(41, 40)]));
}

TEST(GuideStage, MissingLayersAreNamed) {
  GuideSet guides = BallGuides(20, 8.0f);
  const std::vector<FinishStep> steps = {AtGuides(GradePass(), Guide::kAlbedo)};
  const Status done = ApplyToGuides(steps, {}, 0, {}, guides);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().message.find("albedo"), std::string::npos);
}

}  // namespace
}  // namespace scumble
