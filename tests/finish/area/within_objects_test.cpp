// What is evened out or blurred within objects alone: soft shade, edges without borders.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/image/color.h"
#include "tests/finish/finish_fixtures.h"
#include "tests/support/every_instruction_set.h"

namespace scumble {
namespace {

ShadowsPass SoftBlack(double soften) {
  ShadowsPass pass;
  pass.mode = ShadowsPass::Mode::kBlack, pass.source = ShadowsPass::Source::kCast, pass.soften = soften;
  return pass;
}

Picture WhitePicture(const GuideSet& guides) {
  return PlainPicture(guides.width(), guides.height(), 65535, 65535, 65535);
}

// Of white that black shade darkens: Oklab's lightness of a grey is the cube root of its linear value.
double ShadeAt(const Picture& picture, int x, int y) { return 1.0 - std::cbrt(Srgb16ToLinear(picture.At(x, y)[0])); }

template <class Value>
void FillPlane(GuideSet& guides, Layer layer, const Value& value) {
  const auto plane = guides.Plane(layer);
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x < guides.width(); ++x) plane[guides.Index(x, y)] = static_cast<float>(value(x, y));
  }
}

TEST(SoftShade, OfAStraightContourIsTheNormalDistribution) {
  for (const double sigma : {2.0, 6.0, 20.0}) {
    GuideSet across = FlatGuides(161, 9), down = FlatGuides(9, 161);
    FillPlane(across, Layer::kShadow, [](int x, int) { return x < 80; });
    FillPlane(down, Layer::kShadow, [](int, int y) { return y < 80; });
    const Picture columns = Finished(StepOf(SoftBlack(sigma)), &across, WhitePicture(across));
    const Picture rows = Finished(StepOf(SoftBlack(sigma)), &down, WhitePicture(down));
    for (int i = 0; i < 161; ++i) {
      const double expected = 0.5 * std::erfc((i + 0.5 - 80.0) / sigma / std::sqrt(2.0));
      EXPECT_NEAR(ShadeAt(columns, i, 4), expected, 0.01) << sigma << ' ' << i;
      EXPECT_NEAR(ShadeAt(rows, 4, i), expected, 0.01) << sigma << ' ' << i;
    }
  }
}

TEST(SoftShade, LengthsFollowTheScale) {
  GuideSet guides = FlatGuides(161, 9);
  FillPlane(guides, Layer::kShadow, [](int x, int) { return x < 80; });
  EXPECT_EQ(Finished(StepOf(SoftBlack(6.0)), &guides, WhitePicture(guides), {}, 0, 2.0).rgba,
            Finished(StepOf(SoftBlack(12.0)), &guides, WhitePicture(guides)).rgba);
}

TEST(SoftShade, OfEvenShadeIsThatShade) {
  GuideSet guides = FlatGuides(50, 40);
  FillPlane(guides, Layer::kShadow, [](int, int) { return 0.4; });
  FillPlane(guides, Layer::kObject, [](int x, int y) { return 1 + (x / 7 + y / 5) % 3; });
  const Picture made = Finished(StepOf(SoftBlack(9.0)), &guides, WhitePicture(guides));
  const Picture hard = Finished(StepOf(SoftBlack(0.0)), &guides, WhitePicture(guides));
  for (std::size_t i = 0; i < made.rgba.size(); ++i) EXPECT_LE(std::abs(made.rgba[i] - hard.rgba[i]), 1);
}

// Two objects in one picture, and background that is all shade: each object keeps its own, full or none.
TEST(SoftShade, DoesNotLeaveItsObject) {
  GuideSet guides = FlatGuides(90, 60);
  const auto object = [](int x, int y) { return x >= 70 ? 0 : 1 + (x / 4 + y / 6) % 2; };
  FillPlane(guides, Layer::kCoverage, [&](int x, int y) { return object(x, y) > 0; });
  FillPlane(guides, Layer::kObject, object);
  FillPlane(guides, Layer::kShadow, [&](int x, int y) { return object(x, y) != 1; });
  const Picture hard = Finished(StepOf(SoftBlack(0.0)), &guides, WhitePicture(guides));
  EXPECT_EQ(hard.At(5, 0)[0], 0);
  EXPECT_EQ(Finished(StepOf(SoftBlack(8.0)), &guides, WhitePicture(guides)).rgba, hard.rgba);
}

TEST(SoftShade, IsTheSameOnAnyThreadsAndInstructionSet) {
  GuideSet guides = FlatGuides(75, 41);
  FillPlane(guides, Layer::kShadow, [](int x, int y) { return (x * 7 + y * 13) % 11 / 10.0; });
  FillPlane(guides, Layer::kObject, [](int x, int y) { return 1 + (x / 9 + y / 5) % 2; });
  const FinishStep step = StepOf(SoftBlack(3.0));
  const Picture made = Finished(step, &guides, WhitePicture(guides), {}, 1);
  EXPECT_EQ(Finished(step, &guides, WhitePicture(guides), {}, 3).rgba, made.rgba);
  testing::OnEveryInstructionSet([&] { EXPECT_EQ(Finished(step, &guides, WhitePicture(guides)).rgba, made.rgba); });
}

TEST(SoftShade, TakesAnySizeAndNumber) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {17, 2}}) {
    GuideSet guides = FlatGuides(width, height);
    FillPlane(guides, Layer::kShadow, [](int, int) { return NAN; });
    EXPECT_EQ(Finished(StepOf(SoftBlack(64.0)), &guides, WhitePicture(guides)).rgba, WhitePicture(guides).rgba);
  }
}

TEST(SoftShade, ReadsObjects) {
  EXPECT_TRUE(RequiredLayers(StepOf(SoftBlack(1.0)).pass).Has(Layer::kObject));
  EXPECT_FALSE(RequiredLayers(StepOf(SoftBlack(0.0)).pass).Has(Layer::kObject));
}

// Object 1 lies in dim light, object 2 in full light; the upper part of object 1 is darker still.
class LitObjects : public ::testing::TestWithParam<double> {
 protected:
  LitObjects() {
    FillPlane(guides_, Layer::kObject, [](int x, int) { return x < 40 ? 1 : 2; });
    FillPlane(guides_, Layer::kLuminance, [](int x, int) { return x < 40 ? 0.2 : 1.0; });
  }
  Picture Edges(bool borders, int threads = 0) const {
    EdgesPass pass;
    pass.borders = borders, pass.flow = GetParam();
    return Finished(StepOf(pass), &guides_, paint_, {}, threads);
  }
  GuideSet guides_ = FlatGuides(80, 60);
  Picture paint_ = PlainPicture(80, 60, 50000, 40000, 30000);
};

TEST_P(LitObjects, TheirBorderIsALineUnlessBordersAreLeftAlone) {
  EXPECT_LT(Edges(false).At(38, 30)[0], 25000);
  EXPECT_EQ(Edges(true).rgba, paint_.rgba);
}

TEST_P(LitObjects, AStepWithinOneIsALineStill) {
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 40; ++x) guides_.Plane(Layer::kLuminance)[guides_.Index(x, y)] = 0.02f;
  }
  const Picture made = Edges(true);
  EXPECT_LT(made.At(20, 18)[0], 25000);
  EXPECT_LT(made.At(39, 18)[0], 25000) << "up to the border";
  for (int y = 0; y < 60; ++y) EXPECT_EQ(made.At(41, y)[0], paint_.At(41, y)[0]) << "and not beyond";
}

TEST_P(LitObjects, AreTheSameOnAnyThreadsAndInstructionSet) {
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x)
      guides_.Plane(Layer::kLuminance)[guides_.Index(x, y)] *= (x / 9 + (x + 3 * y) / 17) % 2 == 0 ? 1.0f : 0.2f;
  }
  const Picture made = Edges(true, 1);
  EXPECT_NE(made.rgba, paint_.rgba);
  EXPECT_EQ(Edges(true, 3).rgba, made.rgba);
  testing::OnEveryInstructionSet([&] { EXPECT_EQ(Edges(true).rgba, made.rgba); });
}

INSTANTIATE_TEST_SUITE_P(All, LitObjects, ::testing::Values(0.0, 3.0),
                         [](const auto& one) { return one.param > 0.0 ? "Flow" : "Plain"; });

TEST(EdgesBorders, ReadObjects) {
  EdgesPass pass;
  pass.tone = EdgesPass::Tone::kPaint;
  EXPECT_TRUE(RequiredLayers(StepOf(pass).pass).empty());
  pass.borders = true;
  EXPECT_TRUE(RequiredLayers(StepOf(pass).pass).Has(Layer::kObject));
}

}  // namespace
}  // namespace scumble
