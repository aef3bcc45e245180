// Light at the ends of its scale: the weight of luminance up to where it cuts exactly, and luminances that are none.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/every_instruction_set.h"
#include "tests/support/numbers.h"
#include "tests/support/transfer_fixtures.h"

namespace scumble {
namespace {

using namespace testing;

// Two lights, the sums and differences of which are exact.
constexpr double kBright = 0.75, kDark = 0.25;
constexpr float kMiddleLight = 0.5f, kThreshold = 0.125f;
// Luminances at the middle, a step of float below it and one above.
constexpr float kBelow = 0x1.fffffep-2f, kAbove = 0x1.000002p-1f;

Style TwoLights(int size, float weight, LuminanceError form = LuminanceError::kExcess) {
  Style style = PlainStyle(NoisePicture(size));
  style.transfer.threshold = kThreshold, style.transfer.blend_radius = 0, style.transfer.rim = 0.0;
  style.transfer.luminance_weight = weight, style.transfer.luminance_error = form;
  style.exemplars.push_back(style.exemplars[0]);
  style.exemplars[0].luminance = kBright, style.exemplars[1].luminance = kDark;
  return style;
}

// The exemplar's own normals, so that every offer is at distance 0 and light alone decides; luminances from a list.
GuideSet LitSphere(int size, const std::vector<float>& luminances) {
  GuideSet guides = SphereGuides(size);
  guides.Add(Layer::kLuminance);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kLuminance)[i] = luminances[Hash(i, 5) % luminances.size()];
  }
  return guides;
}

// Covered pixels that are not painted with the exemplar whose light is nearest; in the very middle both are.
std::size_t NotTheBest(const SourceField& field, const GuideSet& guides) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < field.level.size(); ++i) {
    if (field.level[i] == SourceField::kNoSource) continue;
    const float light = guides.Plane(Layer::kLuminance)[i];
    count += light != kMiddleLight && (field.exemplar[i] == 0) != (light > kMiddleLight);
  }
  return count;
}

// The excess of the other exemplar is |L - ¾| - |L - ¼| = 2·|L - ½|, exact in float near ½ (Sterbenz: both differences
// are, and so is that of these). The least that is not 0 is at the float below ½, 2·2^-25 = 2^-24. A weight of 2^21
// makes it 2^-3, the threshold: nothing is left of it, so nothing is accepted from an exemplar that is not the best, at
// this weight and any above. Half of it leaves a half of the threshold, which the distance 0 is below.
TEST(ExtremeLight, TheLimitIsReachedWhereTheLeastExcessUsesUpTheThreshold) {
  const GuideSet guides = LitSphere(128, {kBelow, kMiddleLight, kAbove, 0.1f, 0.9f});
  ASSERT_EQ(2.0f * (kMiddleLight - kBelow), 0x1.0p-24f);
  ASSERT_EQ(0x1.0p21f * 0x1.0p-24f, kThreshold);
  const SourceField limit = MustTransfer(TwoLights(128, kInfinity), guides).field;
  EXPECT_EQ(NotTheBest(limit, guides), 0u) << "it cuts exactly where the best exemplar changes";
  for (const float weight : {0x1.0p21f, 1e9f, 1e38f, std::numeric_limits<float>::max()}) {
    const SourceField field = MustTransfer(TwoLights(128, weight), guides).field;
    EXPECT_TRUE(SameField(field, limit) && field.exemplar == limit.exemplar) << weight;
  }
  EXPECT_GT(NotTheBest(MustTransfer(TwoLights(128, 0x1.0p20f), guides).field, guides), 0u);
}

// Pixels that a seed settled and that are not painted with the exemplar whose light is nearest.
std::size_t TakenInOtherLight(const SourceField& field, const GuideSet& guides) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < field.level.size(); ++i) {
    count += field.level[i] > 0 && (field.exemplar[i] == 0) != (guides.Plane(Layer::kLuminance)[i] > kMiddleLight);
  }
  return count;
}

// Every pixel is as bright as one of the lights, whose errors for the other's pixels are both ½: a weight of the
// threshold takes half of it, exactly, and leaves half. The square of that is 2.5e-41 for 1e-20 and rounds to 0 for the
// others. The sphere's normals are the exemplar's own, so every offer is at distance 0, which is less than what is
// left: the field is that of no weight at all, and in every chunk the pixels in the other light, about half of them,
// are taken above level 0, where each would take its own light's exemplar. Twice the weight leaves nothing, and none
// is.
void ExpectCopiesWithinTinyThresholds(LuminanceError form, float normal_weight) {
  const GuideSet guides = LitSphere(48, {kBright, kDark});
  for (const float threshold : {1e-20f, 1e-30f, 0x1.0p-148f}) {
    for (const ThresholdMetric metric : {ThresholdMetric::kL2, ThresholdMetric::kL1}) {
      const auto field = [&](float weight) {
        Style style = TwoLights(48, weight, form);
        style.transfer.threshold = threshold, style.transfer.threshold_metric = metric;
        style.transfer.guide_weights[Layer::kNormal] = normal_weight;
        return MustTransfer(style, guides).field;
      };
      const SourceField half = field(threshold), all = field(0.0f);
      EXPECT_GT(TakenInOtherLight(half, guides), guides.pixel_count() / 8) << threshold;
      EXPECT_TRUE(SameField(half, all) && half.exemplar == all.exemplar) << threshold;
      EXPECT_EQ(TakenInOtherLight(field(2 * threshold), guides), 0u) << threshold;
    }
  }
}

TEST(ExtremeLight, WhatItLeavesOfATinyThresholdTakesExactCopies) {
  OnEveryInstructionSet([] { ExpectCopiesWithinTinyThresholds(LuminanceError::kExcess, 1.0f); });
  ExpectCopiesWithinTinyThresholds(LuminanceError::kPublished, 1.0f);
}

// By the plain form, which matches in a space: normals that count double are 0 apart, too.
TEST(ExtremeLight, WhatItLeavesOfATinyThresholdTakesExactCopiesInASpace) {
  ExpectCopiesWithinTinyThresholds(LuminanceError::kExcess, 2.0f);
}

// A pixel has one other exemplar and one excess: if a weight rejects it, all larger weights do.
TEST(ExtremeLight, HeavierWeightsOnlyCutMore) {
  const GuideSet guides = LitSphere(96, {kBelow, kAbove, 0.1f, 0.4f, 0.49f, 0.4999f, 0.6f, 0.9f, 4.0f});
  std::size_t last = guides.pixel_count();
  for (const float weight : {0.0f, 1e-40f, 1e-3f, 0.3f, 1.0f, 1e2f, 1e4f, 1e6f, 1e9f}) {
    const std::size_t now = NotTheBest(MustTransfer(TwoLights(96, weight), guides).field, guides);
    EXPECT_LE(now, last) << weight;
    last = now;
  }
  EXPECT_EQ(last, 0u);
}

// A weight of 0 does not change the threshold: the chunks are those of one exemplar.
TEST(ExtremeLight, WithoutWeightLightCutsNothing) {
  const GuideSet guides = LitSphere(96, {0.0f, 0.3f, 0.7f, 1e30f});
  Style one = TwoLights(96, 0.0f);
  one.exemplars.pop_back();
  for (const LuminanceError form : {LuminanceError::kExcess, LuminanceError::kPublished}) {
    EXPECT_TRUE(SameField(MustTransfer(TwoLights(96, 0.0f, form), guides).field, MustTransfer(one, guides).field));
  }
}

// The published error is 0 at an exemplar's own luminance alone, and infinity times 0 counts as 0: such pixels take
// chunks of exemplars of their light, all others their own nearest neighbour.
TEST(ExtremeLight, ThePublishedErrorAtItsLimit) {
  const GuideSet guides = LitSphere(96, {0.75f, 0.25f, 0.3f});
  const SourceField field = MustTransfer(TwoLights(96, kInfinity, LuminanceError::kPublished), guides).field;
  EXPECT_EQ(NotTheBest(field, guides), 0u);
  std::size_t pieces = 0;
  for (std::size_t i = 0; i < field.level.size(); ++i) {
    if (field.level[i] == SourceField::kNoSource) continue;
    if (guides.Plane(Layer::kLuminance)[i] == 0.3f) {
      ASSERT_EQ(field.level[i], 0);
    }
    pieces += field.level[i] > 0;
  }
  EXPECT_GT(pieces, guides.pixel_count() / 8);
}

// An infinite threshold takes any distance, an infinite weight none that light adds to: infinity is not below infinity.
TEST(ExtremeLight, BothInfiniteLightDecides) {
  const GuideSet guides = LitSphere(96, {kBelow, kMiddleLight, kAbove, 0.0f, 7.0f});
  Style style = TwoLights(96, kInfinity);
  style.transfer.threshold = kInfinity;
  EXPECT_EQ(NotTheBest(MustTransfer(style, guides).field, guides), 0u);
  style.transfer.luminance_weight = 1e9f;
  Style without = style;
  without.transfer.luminance_weight = 0.0f;
  const Transferred heavy = MustTransfer(style, guides), none = MustTransfer(without, guides);
  EXPECT_TRUE(SameField(heavy.field, none.field)) << "what is finite is less than an infinite threshold";
}

// ---- luminances that are none --------------------------------------------------------------------------------------

// Values below 0 count as 0, and so does NaN, which compares brighter than no value.
TEST(ExtremeLight, NegativeAndNanAreDarkness) {
  const std::vector<float> dark = {0.0f, -0.0f, -1.0f, -1e30f, -kInfinity, kNan, -kNan};
  const GuideSet odd = LitSphere(96, dark), zero = LitSphere(96, {0.0f});
  for (const LuminanceError form : {LuminanceError::kExcess, LuminanceError::kPublished}) {
    for (const float weight : {0.0f, 0.3f, 1e9f, kInfinity}) {
      const Transferred a = MustTransfer(TwoLights(96, weight, form), odd),
                        b = MustTransfer(TwoLights(96, weight, form), zero);
      EXPECT_TRUE(SameField(a.field, b.field) && a.field.exemplar == b.field.exemplar) << weight;
    }
  }
}

// Whatever is brighter than the brightest exemplar is nearest to it, by (L - e) - (L - b) = b - e however large L is.
// Float rounds L - e and L - b to one value from 2^24 on, and infinity less anything is infinity; the exemplars stand
// with the dark one first, so that a tie would take it.
TEST(ExtremeLight, HoweverBrightTheBrightestIsTaken) {
  for (const LuminanceError form : {LuminanceError::kExcess, LuminanceError::kPublished}) {
    const double luminances[] = {0.15, 0.8, 0.4};
    const Illumination light(luminances, 0.3f, form);
    for (const float bright : {0.8f, 1.0f, 1e3f, 1e7f, 1e8f, 1e30f, std::numeric_limits<float>::max(), kInfinity}) {
      EXPECT_EQ(light.Choose(bright), 1) << bright;
      if (form != LuminanceError::kExcess) continue;
      EXPECT_EQ(light.Error(bright, 1), 0.0f) << bright;
      EXPECT_EQ(light.Error(bright, 0), 0.3f * (0.8f - 0.15f)) << bright;
    }
  }
  const GuideSet bright = LitSphere(96, {1e8f, kInfinity, 3e38f}), unit = LitSphere(96, {1.0f});
  Style style = TwoLights(96, 0.3f);
  std::swap(style.exemplars[0].luminance, style.exemplars[1].luminance);
  const Transferred a = MustTransfer(style, bright), b = MustTransfer(style, unit);
  EXPECT_TRUE(SameField(a.field, b.field) && a.field.exemplar == b.field.exemplar);
}

// The measured exposure uses values above 0; it stays finite whatever the other values are.
TEST(ExtremeLight, TheExposureIsMeasuredOnLight) {
  const float luminances[] = {0.75f, 0.25f};
  for (const float odd : {-1.0f, -kInfinity, kNan, 0.0f}) {
    EXPECT_EQ(MeasureExposure(LitSphere(64, {odd}), luminances), 0.0) << "nothing is lit";
  }
  // A twentieth is odd and as 0: the 90th percentile is 0.5 whatever it is, and exposing it to 0.75 takes log2(1.5)
  // stops.
  std::vector<float> mostly(20, 0.5f);
  for (const float odd : {-1.0f, kNan, -kInfinity, 0.0f}) {
    mostly[0] = odd;
    EXPECT_EQ(MeasureExposure(LitSphere(64, mostly), luminances), 0.58);
  }
  EXPECT_EQ(MeasureExposure(LitSphere(64, {kInfinity}), luminances), 0.0) << "infinite light has no exposure";
}

}  // namespace
}  // namespace scumble
