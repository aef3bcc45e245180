// Masks, against their formulas.
#include "finish/mask.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "tests/finish/finish_fixtures.h"

namespace scumble {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// One row of pixels of these depths.
GuideSet RowOf(const std::vector<float>& depths) {
  GuideSet guides(static_cast<int>(depths.size()), 1);
  guides.Add(Layer::kDepth);
  std::copy(depths.begin(), depths.end(), guides.Plane(Layer::kDepth).begin());
  return guides;
}

std::vector<std::uint16_t> SharesOf(const FinishMask& mask, const std::vector<float>& depths) {
  const GuideSet guides = RowOf(depths);
  return MaskShares(mask, &guides, guides.width(), 1);
}

TEST(Mask, OfNothingIsNone) { EXPECT_TRUE(SharesOf({}, {1.0f, 2.0f}).empty()); }

TEST(Mask, OfDepthIsAStepAtBothEnds) {
  FinishMask mask;
  mask.near = 2.0, mask.far = 4.0;
  const std::vector<float> depths{0.5f, 1.999f, 2.0f, 3.0f, 4.0f, 4.001f, kInfinity, std::nanf("")};
  EXPECT_EQ(SharesOf(mask, depths), (std::vector<std::uint16_t>{0, 0, 65535, 65535, 65535, 0, 0, 0}));
  mask.far = 0.0;
  EXPECT_EQ(SharesOf(mask, depths), (std::vector<std::uint16_t>{0, 0, 65535, 65535, 65535, 65535, 65535, 0}));
  mask.near = 0.0, mask.far = 4.0;
  EXPECT_EQ(SharesOf(mask, depths), (std::vector<std::uint16_t>{65535, 65535, 65535, 65535, 65535, 0, 0, 0}));
  mask.invert = true;
  EXPECT_EQ(SharesOf(mask, depths), (std::vector<std::uint16_t>{0, 0, 0, 0, 0, 65535, 65535, 65535}));
}

TEST(Mask, OfDepthFadesOverSoft) {
  FinishMask mask;
  mask.near = 2.0, mask.far = 6.0, mask.soft = 1.0;
  std::vector<float> depths;
  for (int i = 0; i <= 160; ++i) depths.push_back(0.05f * static_cast<float>(i));
  const auto shares = SharesOf(mask, depths);
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const double up = std::clamp(depths[i] - 1.5, 0.0, 1.0), down = std::clamp(6.5 - depths[i], 0.0, 1.0);
    EXPECT_NEAR(shares[i], 65535.0 * up * down, 0.51) << depths[i];
  }
}

TEST(Mask, RadialGoesFromTheMiddleToTheEdges) {
  FinishMask mask;
  mask.shape = kRadialMask;
  const auto shares = MaskShares(mask, nullptr, 101, 51);
  const auto at = [&](int x, int y) { return shares[std::size_t(y) * 101 + std::size_t(x)]; };
  EXPECT_EQ(at(50, 25), 0);
  EXPECT_EQ(at(0, 0), 65535);
  EXPECT_GT(at(0, 25), 65400);
  EXPECT_GT(at(50, 0), 65000);
  for (int x = 0; x < 101; ++x) {
    const double u = (x + 0.5 - 50.5) / 50.5, r = u * u;
    EXPECT_NEAR(at(x, 25), 65535.0 * (3.0 * r * r - 2.0 * r * r * r), 0.51);
    EXPECT_EQ(at(x, 3), at(100 - x, 47)) << "the same upside down";
  }
}

TEST(Mask, OfAPictureIsItsRedAtAnySize) {
  Picture picture = PlainPicture(6, 4, 0, 0, 0);
  for (int y = 0; y < 4; ++y)
    for (int x = 3; x < 6; ++x) picture.At(x, y)[0] = 65535;
  picture.At(0, 0)[0] = 12345;
  FinishMask mask;
  mask.picture = std::make_shared<const Picture>(picture), mask.shape = "m.png";
  const auto same = MaskShares(mask, nullptr, 6, 4);
  for (std::size_t i = 0; i < same.size(); ++i) EXPECT_EQ(same[i], picture.rgba[4 * i]);
  const auto large = MaskShares(mask, nullptr, 60, 40);
  EXPECT_NEAR(large[20 * 60 + 50], 65535, 2500);  // but for the ringing of Lanczos-3
  EXPECT_NEAR(large[30 * 60 + 10], 0, 2500);
}

TEST(Mask, MultipliesWhatItHolds) {
  FinishMask mask;
  mask.shape = kRadialMask, mask.near = 5.0;
  GuideSet guides(8, 8);
  guides.Add(Layer::kDepth);
  auto depth = guides.Plane(Layer::kDepth);
  for (std::size_t i = 0; i < depth.size(); ++i) depth[i] = i % 2 ? 4.0f : 6.0f;
  const auto both = MaskShares(mask, &guides, 8, 8);
  mask.near = 0.0;
  const auto radial = MaskShares(mask, nullptr, 8, 8);
  for (std::size_t i = 0; i < both.size(); ++i) EXPECT_EQ(both[i], i % 2 ? 0 : radial[i]);
}

// An outline has the share of the surface that it belongs to, on both its sides.
TEST(Mask, OfDepthDoesNotCutLinesInHalf) {
  const GuideSet guides = BallGuides(80, 25.0f);  // 5 m away
  OutlinePass ink;
  ink.width = 6.0, ink.ink = {0, 0, 0};
  FinishStep step = StepOf(ink);
  const Picture white = PlainPicture(80, 80, 65535, 65535, 65535);
  const Picture plain = Finished(step, &guides, white);
  FinishMask mask;
  mask.far = 6.0;
  step.share = MaskShares(mask, &guides, 80, 80);
  EXPECT_EQ(Finished(step, &guides, white).rgba, plain.rgba);
  mask.near = 5.5;
  step.share = MaskShares(mask, &guides, 80, 80);
  EXPECT_EQ(Finished(step, &guides, white).rgba, white.rgba);
}

// Lines that the mask hides take nothing from the ones beside them, whichever form they have.
TEST(Mask, HiddenLinesStandBeforeNoOther) {
  const auto seen = [](glm::vec2 at) {
    if (std::fabs(at.y - 40.0f) >= 30.0f || at.x < 20.0f || at.x >= 60.0f) return SeenPoint{};
    const bool is_left = at.x < 40.0f;
    return SeenPoint{true, {0.0f, 0.0f, 1.0f}, 5.0f, is_left ? 1.0f : 2.0f};
  };
  const GuideSet guides = GuidesOf(80, 80, seen);
  OutlinePass pass;
  pass.width = 8.0;
  for (const auto form : {OutlinePass::Form::kStrokes, OutlinePass::Form::kField}) {
    pass.form = form;
    FinishStep step = StepOf(pass);
    step.share.assign(guides.pixel_count(), 0);
    for (std::size_t i = 0; i < step.share.size(); ++i) {
      if (guides.Plane(Layer::kObject)[i] == 2.0f) step.share[i] = 65535;
    }
    const Picture made = Finished(step, &guides, PlainPicture(80, 80, 60000, 60000, 60000));
    // The upper line of the right square, up to the hidden line that both squares share.
    for (int x = 40; x < 60; ++x) EXPECT_LT(made.At(x, 10)[0], 20000) << x << " " << int(form);
    EXPECT_EQ(made.At(30, 10)[0], 60000) << "the left square's";
    EXPECT_EQ(made.At(42, 40)[0], 60000) << "the one between them";
  }
}

TEST(Mask, MakesInkAsFaintAsItSays) {
  const GuideSet guides = BallGuides(80, 25.0f);
  const Picture white = PlainPicture(80, 80, 65535, 65535, 65535);
  for (const FinishPass::Effect& effect : {FinishPass::Effect(OutlinePass()), FinishPass::Effect(HatchPass())}) {
    FinishStep step = StepOf(effect);
    if (auto* const hatch = std::get_if<HatchPass>(&step.pass.effect)) hatch->tone = HatchPass::Tone::kPaint;
    const Picture grey = PlainPicture(80, 80, 20000, 20000, 20000);
    step.share.assign(guides.pixel_count(), 65535 / 5);
    const Picture masked = Finished(step, &guides, grey);
    step.share.clear(), step.pass.strength = 0.2;
    const Picture faint = Finished(step, &guides, grey);
    EXPECT_NE(faint.rgba, grey.rgba);
    for (std::size_t i = 0; i < faint.rgba.size(); ++i) EXPECT_NEAR(masked.rgba[i], faint.rgba[i], 1);
  }
}

TEST(Mask, OfDepthWantsNearBeforeFar) {
  FinishStep step = StepOf(GradePass());
  step.pass.mask.near = 5.0, step.pass.mask.far = 5.0;
  GuideSet guides(2, 2);
  guides.Add(Layer::kDepth);
  const Status done = CheckFinish(std::span(&step, 1), &guides);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().message,
            "finish it: mask_near is 5 m, mask_far is 5 m: set mask_near below mask_far, or one of them to 0, which is "
            "open");
  EXPECT_TRUE(RequiredLayers(step.pass).Has(Layer::kDepth));
}

}  // namespace
}  // namespace scumble
