// What holds for every effect: strength, masks, alpha, threads, missing layers, odd numbers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/image/color.h"
#include "core/image/oklab.h"
#include "core/style/finish_keys.h"
#include "tests/finish/finish_fixtures.h"

namespace scumble {
namespace {

class EveryEffect : public ::testing::TestWithParam<std::string> {
 protected:
  FinishStep Step(double strength = 1.0) {
    if (GetParam() == "grade") return StepOf(GradePass{0.5, 1.2, 0.1}, strength);  // its defaults change nothing
    FinishPass::Effect effect = FindFinishEffect(GetParam())->defaults;
    if (auto* const palette = std::get_if<PalettePass>(&effect)) palette->target = ColorSpread{{0.4, 0.1, 0.0}, {0.02}};
    return StepOf(effect, strength);
  }
  GuideSet guides_ = AllGuides(90);
  Picture picture_ = CoveredPicture(guides_);
  FinishMeasures measures_ = MeasureFinish(guides_);
};

TEST_P(EveryEffect, WithoutStrengthChangesNoByte) {
  EXPECT_EQ(Finished(Step(0.0), &guides_, picture_, measures_).rgba, picture_.rgba);
}

TEST_P(EveryEffect, IsTheSameOnAnyNumberOfThreads) {
  EXPECT_EQ(Finished(Step(), &guides_, picture_, measures_, 1).rgba,
            Finished(Step(), &guides_, picture_, measures_, 4).rgba);
}

TEST_P(EveryEffect, LeavesClearPixelsClearButForLines) {
  const Picture made = Finished(Step(), &guides_, picture_, measures_);
  for (std::size_t i = 0; i < picture_.rgba.size(); i += 4) {
    const bool draws_outside = GetParam() == "outline" || GetParam() == "pigment";  // which trembles
    if (!draws_outside && picture_.rgba[i + 3] == 0) {
      EXPECT_EQ(made.rgba[i], 0);
    }
    if (!draws_outside) {
      EXPECT_EQ(made.rgba[i + 3], picture_.rgba[i + 3]);
    }
  }
}

TEST_P(EveryEffect, OfNoPixelsChangesNone) {
  FinishStep step = Step();
  step.only.assign(guides_.pixel_count(), 0);
  EXPECT_EQ(Finished(step, &guides_, picture_, measures_).rgba, picture_.rgba);
}

TEST_P(EveryEffect, OfFullSharesIsAsWithoutAndOfNoneChangesNothing) {
  for (const double strength : {1.0, 0.3}) {
    FinishStep step = Step(strength);
    const Picture plain = Finished(step, &guides_, picture_, measures_);
    step.share.assign(guides_.pixel_count(), 65535);
    EXPECT_EQ(Finished(step, &guides_, picture_, measures_).rgba, plain.rgba);
    step.share.assign(guides_.pixel_count(), 0);
    EXPECT_EQ(Finished(step, &guides_, picture_, measures_).rgba, picture_.rgba);
  }
}

// Texel by texel, within what 16 bits round, of opaque pixels: between what was and what would be.
TEST_P(EveryEffect, OfHalfAShareLiesBetween) {
  FinishStep step = Step();
  const Picture whole = Finished(step, &guides_, picture_, measures_);
  step.share.assign(guides_.pixel_count(), 32768);
  const Picture half = Finished(step, &guides_, picture_, measures_);
  EXPECT_NE(half.rgba, whole.rgba);
  EXPECT_NE(half.rgba, picture_.rgba);
  double apart = 0.0, to_whole = 0.0, to_given = 0.0;
  for (std::size_t i = 0; i < half.rgba.size(); ++i) {
    apart += std::fabs(double(whole.rgba[i]) - picture_.rgba[i]);
    to_whole += std::fabs(double(whole.rgba[i]) - half.rgba[i]);
    to_given += std::fabs(double(half.rgba[i]) - picture_.rgba[i]);
  }
  EXPECT_NEAR(to_whole / apart, 0.5, 0.15);
  EXPECT_NEAR(to_given / apart, 0.5, 0.15);
}

TEST_P(EveryEffect, HalfStrengthLiesBetween) {
  const Picture half = Finished(Step(0.5), &guides_, picture_, measures_);
  EXPECT_NE(half.rgba, picture_.rgba);
  EXPECT_NE(half.rgba, Finished(Step(), &guides_, picture_, measures_).rgba);
}

TEST_P(EveryEffect, TakesWhatBackgroundAndEdgesHold) {
  // Infinite depth under paint, as a sky that a renderer painted.
  Picture opaque = ColorfulPicture(90, 90);
  EXPECT_FALSE(Finished(Step(), &guides_, opaque, measures_).empty());
  GuideSet one(1, 1);
  for (const LayerInfo& info : AllLayers()) one.Add(info.layer);
  EXPECT_FALSE(Finished(Step(), &one, PlainPicture(1, 1, 1, 2, 3), measures_).empty());
}

// Of a picture that is opaque everywhere, as a renderer's with a sky.
TEST_P(EveryEffect, LeavesASkyAsItIsWhereItHasNoGuides) {
  const std::string name = GetParam();
  for (const char* of_all : {"fill", "grade", "palette", "pigment", "tones", "depth", "smooth"}) {
    if (name == of_all) return;
  }
  const Picture opaque = PlainPicture(90, 90, 60000, 61000, 62000);
  const Picture made = Finished(Step(), &guides_, opaque, measures_);
  for (int c = 0; c < 4; ++c) EXPECT_EQ(made.At(2, 2)[c], opaque.At(2, 2)[c]);
  EXPECT_NE(made.rgba, opaque.rgba);
}

TEST_P(EveryEffect, NamesTheLayersThatAreMissing) {
  const FinishStep step = Step();
  if (RequiredLayers(step.pass).empty()) {
    EXPECT_TRUE(CheckFinish(std::span(&step, 1), nullptr));
    return;
  }
  Picture picture = picture_;
  const Status done = ApplyFinish(std::span(&step, 1), FinishPass::Stage::kPaint, {}, 0, {}, picture);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().kind, ErrorKind::kInput);
  EXPECT_THAT(done.error().message, ::testing::HasSubstr("finish it needs"));
  EXPECT_EQ(picture.rgba, picture_.rgba);
}

INSTANTIATE_TEST_SUITE_P(All, EveryEffect, ::testing::ValuesIn([] {
                           std::vector<std::string> names;
                           for (const FinishEffect& effect : FinishEffects()) names.push_back(effect.name);
                           return names;
                         }()),
                         [](const auto& one) { return one.param; });

TEST(Chain, GoesInOrder) {
  FillPass white, red;
  white.color = {65535, 65535, 65535}, red.color = {65535, 0, 0};
  const FinishStep steps[] = {StepOf(red), StepOf(white)};
  EXPECT_EQ(Finished(steps, nullptr, PlainPicture(3, 3, 0, 0, 0)).At(1, 1)[1], 65535);
  const FinishStep other[] = {StepOf(white), StepOf(red)};
  EXPECT_LT(Finished(other, nullptr, PlainPicture(3, 3, 0, 0, 0)).At(1, 1)[1], 1000);
}

TEST(Chain, LinesStopAndStartTheLoopOverPixels) {
  const GuideSet guides = BallGuides(60, 20.0f);
  FillPass grey;
  grey.color = {0x8080, 0x8080, 0x8080};
  OutlinePass ink;
  ink.ink = {0, 0, 0}, ink.width = 6.0;
  const FinishStep steps[] = {StepOf(grey), StepOf(ink), StepOf(GradePass{1.0, 1.0, 0.3})};
  const Picture made = Finished(steps, &guides, PlainPicture(60, 60, 0, 0, 0));
  EXPECT_GT(made.At(30, 10)[0], 5000) << "the line was lifted, too";
  EXPECT_LT(made.At(30, 10)[0], made.At(30, 30)[0]);
}

// A pixel that a surface covers by a quarter: where the picture is as transparent the effect is whole, on an opaque one
// it changes a quarter. `changed`: of all that the effect changes on a covered pixel.
double ShareChanged(const FinishPass::Effect& effect, std::uint16_t alpha) {
  GuideSet guides = AllGuides(8);
  for (const LayerInfo& info : AllLayers()) {
    for (int c = 0; guides.Has(info.layer) && c < ChannelCount(info.layer); ++c) {
      const auto plane = guides.Plane(info.layer, c);
      std::fill(plane.begin(), plane.end(), guides.Plane(info.layer, c)[guides.Index(4, 4)]);
    }
  }
  std::fill(guides.Plane(Layer::kShadow).begin(), guides.Plane(Layer::kShadow).end(), 1.0f);
  const auto lightness = [&](float coverage) {
    const auto plane = guides.Plane(Layer::kCoverage);
    std::fill(plane.begin(), plane.end(), coverage);
    Picture picture = PlainPicture(8, 8, 40000, 30000, 20000);
    for (std::size_t i = 3; i < picture.rgba.size(); i += 4) picture.rgba[i] = alpha;
    const Picture made = Finished(StepOf(effect), &guides, picture, {1.0, 2.0, 3.0, 1.0, 1.0});
    const std::uint16_t* const texel = made.At(4, 4);
    return double(OklabFromLinear({Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])}).x);
  };
  const double none = double(OklabFromLinear({Srgb16ToLinear(40000), Srgb16ToLinear(30000), Srgb16ToLinear(20000)}).x);
  const double whole = lightness(1.0f) - none;
  EXPECT_GT(std::fabs(whole), 0.02);
  return (lightness(0.25f) - none) / whole;
}

TEST(Chain, ASurfacesEffectIsOnItsShareOfAPixel) {
  ToonPass toon;
  toon.bands = 1;
  ShadowsPass shadows;
  shadows.mode = ShadowsPass::Mode::kBlack, shadows.source = ShadowsPass::Source::kCast;
  EdgesPass edges;  // ink all over
  edges.fill = edges.threshold = 1.0, edges.slope = 100.0;
  for (const FinishPass::Effect& effect :
       {FinishPass::Effect(toon), FinishPass::Effect(shadows), FinishPass::Effect(edges)}) {
    EXPECT_NEAR(ShareChanged(effect, 16384), 1.0, 1e-6) << effect.index();
    EXPECT_NEAR(ShareChanged(effect, 16448), 1.0, 1e-6) << "alpha of 8 bits; " << effect.index();
    EXPECT_NEAR(ShareChanged(effect, 65535), 0.25, 2e-3) << effect.index();
  }
}

// A renderer has mixed the background, which is infinitely far, into it.
TEST(Chain, DepthTakesTheBackgroundsShareOfAPixelAsFar) {
  DepthPass haze;
  haze.air = 1.0, haze.near = 1.0, haze.far = 1000.0, haze.color = {65535, 65535, 65535};
  GuideSet guides = GuidesOf(8, 8, [](glm::vec2) { return SeenPoint{true, {0, 0, 1}, 1.0f, 1.0f}; });
  const auto red = [&](float coverage, std::uint16_t alpha) {
    std::fill(guides.Plane(Layer::kCoverage).begin(), guides.Plane(Layer::kCoverage).end(), coverage);
    Picture picture = PlainPicture(8, 8, 10000, 10000, 10000);
    for (std::size_t i = 3; i < picture.rgba.size(); i += 4) picture.rgba[i] = alpha;
    return int(Finished(StepOf(haze), &guides, picture, {1.0, 2.0, 3.0, 1.0, 1.0}).At(4, 4)[0]);
  };
  EXPECT_NEAR(red(1.0f, 65535), 10000, 20) << "near";
  EXPECT_EQ(red(0.5f, 32768), red(1.0f, 65535)) << "as transparent as its surface";
  EXPECT_GT(red(0.5f, 65535), 25000) << "half of it is far";
  EXPECT_LT(red(0.5f, 65535), 45000);
}

TEST(Chain, StagesAreApart) {
  FinishStep sheet = StepOf(FillPass());
  sheet.pass.at = FinishPass::Stage::kSheet;
  Picture picture = PlainPicture(2, 2, 0, 0, 0);
  ASSERT_TRUE(ApplyFinish(std::span(&sheet, 1), FinishPass::Stage::kPaint, {}, 0, {}, picture));
  EXPECT_EQ(picture.At(0, 0)[0], 0);
  ASSERT_TRUE(ApplyFinish(std::span(&sheet, 1), FinishPass::Stage::kSheet, {}, 0, {}, picture));
  EXPECT_GT(picture.At(0, 0)[0], 50000);
}

TEST(Chain, FillOfTheSheetFillsWhatIsClear) {
  FinishStep sheet = StepOf(FillPass{{65535, 0, 0}});
  sheet.pass.at = FinishPass::Stage::kSheet;
  Picture picture(2, 2);
  ASSERT_TRUE(ApplyFinish(std::span(&sheet, 1), FinishPass::Stage::kSheet, {}, 0, {}, picture));
  EXPECT_THAT(picture.rgba, ::testing::Contains(65535).Times(8));
}

TEST(Chain, StepsHaveTheirOwnLengths) {
  const GuideSet guides = BallGuides(120, 40.0f);
  FinishStep step = StepOf(OutlinePass());
  const auto ink = [&] {
    double sum = 0.0;
    const Picture made = Finished(step, &guides, Picture(120, 120));
    for (std::size_t i = 3; i < made.rgba.size(); i += 4) sum += made.rgba[i];
    return sum;
  };
  const double plain = ink();
  step.reference_height = 60;
  EXPECT_NEAR(ink() / plain, 2.0, 0.05);
}

TEST(Chain, CanBeCancelled) {
  const FinishStep step = StepOf(FillPass());
  Picture picture = PlainPicture(8, 64, 0, 0, 0);
  const Status done = ApplyFinish(
      std::span(&step, 1), FinishPass::Stage::kPaint, {}, 0, [](double) { return false; }, picture);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().kind, ErrorKind::kCancelled);
}

TEST(MeasureFinish, OfNothingAreDefaults) {
  GuideSet empty(8, 8);
  for (const Layer layer : {Layer::kCoverage, Layer::kDepth, Layer::kLuminance}) empty.Add(layer);
  const FinishMeasures measures = MeasureFinish(empty);
  EXPECT_EQ(measures.near, 0.0);
  EXPECT_EQ(measures.bright, 1.0);
}

// The picture of a frame, 24 a second.
template <class Effect>
Picture AtFrame(const Effect& effect, std::int64_t frame, const GuideSet& guides) {
  Picture picture = PlainPicture(guides.width(), guides.height(), 50000, 30000, 20000);
  const FinishStep step = StepOf(effect);
  const FinishFrame whole{&guides, {}, 1.0, 7, frame};
  return ApplyFinish({&step, 1}, FinishPass::Stage::kPaint, whole, 0, {}, picture) ? picture : Picture();
}

TEST(Jitter, DrawsAnewSoManyTimesASecond) {
  GuideSet guides = BallGuides(120, 50.0f);
  guides.Add(Layer::kLuminance);
  for (float& value : guides.Plane(Layer::kLuminance)) value = 0.2f;
  OutlinePass outline;
  outline.wobble = 4.0;
  HatchPass hatch;
  PigmentPass pigment;
  const auto check = [&](auto effect) {
    const Picture still = AtFrame(effect, 0, guides);
    EXPECT_EQ(AtFrame(effect, 5, guides).rgba, still.rgba);
    effect.jitter_fps = 12;
    EXPECT_EQ(AtFrame(effect, 1, guides).rgba, still.rgba);
    const Picture second = AtFrame(effect, 2, guides);
    EXPECT_NE(second.rgba, still.rgba);
    EXPECT_EQ(AtFrame(effect, 3, guides).rgba, second.rgba);
    EXPECT_NE(AtFrame(effect, 4, guides).rgba, second.rgba);
    effect.jitter_fps = -1;
    EXPECT_NE(AtFrame(effect, 1, guides).rgba, still.rgba);
    EXPECT_NE(AtFrame(effect, 3, guides).rgba, AtFrame(effect, 2, guides).rgba);
  };
  check(outline), check(hatch), check(pigment);
  // Strokes move even where nothing else is left to chance.
  hatch.along = HatchPass::Along::kFixed, hatch.wobble = 0.0;
  check(hatch);
}

}  // namespace
}  // namespace scumble
