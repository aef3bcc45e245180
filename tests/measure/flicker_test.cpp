// The measure of flicker, on pictures whose motion is known.
#include "measure/flicker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <utility>

#include "core/image/hash.h"

namespace scumble {
namespace {

Picture Painted(int width, int height, const std::function<double(int x, int y)>& grey255) {
  Picture picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::uint16_t* texel = picture.At(x, y);
      texel[0] = texel[1] = texel[2] = static_cast<std::uint16_t>(std::lround(257.0 * grey255(x, y)));
      texel[3] = 65535;
    }
  }
  return picture;
}

double Noise(int x, int y) { return static_cast<double>(Hash(x, y) % 256); }

// Everything covered by object 1, and everything moves alike.
GuideSet Moving(int width, int height, float dx, float dy) {
  GuideSet guides(width, height);
  for (const Layer layer : {Layer::kCoverage, Layer::kDepth, Layer::kObject, Layer::kMotion}) guides.Add(layer);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kCoverage)[i] = 1.0f, guides.Plane(Layer::kDepth)[i] = 4.0f;
    guides.Plane(Layer::kObject)[i] = 1.0f;
    guides.Plane(Layer::kMotion, 0)[i] = dx, guides.Plane(Layer::kMotion, 1)[i] = dy;
  }
  return guides;
}

FlickerReport Must(const Picture& a, const Picture& b, const GuideSet& guides, const GuideSet* next = nullptr) {
  const auto report = MeasureFlicker(a, b, guides, next);
  EXPECT_TRUE(report.ok()) << (report.ok() ? "" : report.error().message);
  return report.ok() ? *report : FlickerReport{};
}

TEST(Flicker, WholePixelsThatMoveTheirColoursScoreNothing) {
  const Picture a = Painted(40, 30, Noise);
  const Picture b = Painted(40, 30, [](int x, int y) { return Noise(x - 5, y + 3); });
  const FlickerReport report = Must(a, b, Moving(40, 30, 5.0f, -3.0f));
  EXPECT_EQ(report.mean, 0.0);
  EXPECT_EQ(report.floor, 0.0);
  EXPECT_EQ(report.pixels, 34u * 26u);  // 40 × 30 less its own edge, 4 columns more on the right and 2 rows on top
  EXPECT_EQ(report.pixels + report.hidden, 40u * 30u);
  ASSERT_EQ(report.changes.size(), 40u * 30u);
  EXPECT_TRUE(std::isnan(report.changes[0])) << "an edge is not compared";
  EXPECT_EQ(report.changes[15 * 40 + 15], 0.0f);
}

TEST(Flicker, StandingStillUnderAMotionScoresTheDifference) {
  const Picture stripes = Painted(40, 30, [](int x, int) { return x % 2 * 100.0; });
  EXPECT_NEAR(Must(stripes, stripes, Moving(40, 30, 1.0f, 0.0f)).mean, 100.0, 0.01);
  EXPECT_NEAR(Must(stripes, stripes, Moving(40, 30, 1.0f, 0.0f)).changes[15 * 40 + 15], 100.0f, 0.01f);
  EXPECT_NEAR(Must(stripes, stripes, Moving(40, 30, 2.0f, 7.0f)).mean, 0.0, 0.01);
  const Picture lighter = Painted(40, 30, [](int x, int) { return x % 2 * 100.0 + 12.0; });
  EXPECT_NEAR(Must(stripes, lighter, Moving(40, 30, 0.0f, 0.0f)).mean, 12.0, 0.01);
}

// b is a by linear interpolation: the score is that of the resampling alone, which is the floor.
TEST(Flicker, HalfPixelsScoreTheFloor) {
  const GuideSet half = Moving(40, 30, 0.5f, 0.0f);
  const Picture ramp = Painted(40, 30, [](int x, int) { return 5.0 * x; });
  const FlickerReport smooth =
      Must(ramp, Painted(40, 30, [](int x, int) { return 5.0 * std::max(0.0, x - 0.5); }), half);
  EXPECT_NEAR(smooth.mean, 0.0, 0.01);
  EXPECT_NEAR(smooth.floor, 0.0, 0.01);
  const Picture stripes = Painted(40, 30, [](int x, int) { return x % 2 * 100.0; });
  const FlickerReport sharp = Must(stripes, Painted(40, 30, [](int, int) { return 50.0; }), half);
  EXPECT_NEAR(sharp.mean, 50.0, 0.01);
  EXPECT_NEAR(sharp.floor, 50.0, 0.01);
  const Picture noise = Painted(40, 30, Noise);
  const auto moved = [](int x, int y) {
    const auto at = [&](int dx, int dy) { return Noise(x - dx, y - dy); };
    return 0.75 * (0.5 * at(2, 1) + 0.5 * at(2, 0)) + 0.25 * (0.5 * at(1, 1) + 0.5 * at(1, 0));
  };
  const FlickerReport both = Must(noise, Painted(40, 30, moved), Moving(40, 30, 1.75f, 0.5f));
  EXPECT_NEAR(both.mean, both.floor, 0.01);
  EXPECT_GT(both.floor, 20.0);
}

TEST(Flicker, WhatIsHiddenInTheNextFrameDoesNotCount) {
  const Picture a = Painted(40, 30, [](int, int) { return 10.0; });
  const Picture b = Painted(40, 30, [](int x, int) { return x < 20 ? 10.0 : 200.0; });
  const GuideSet guides = Moving(40, 30, 0.0f, 0.0f);
  const std::size_t inside = 38 * 28, left = 19 * 28;
  EXPECT_EQ(Must(a, b, guides).pixels, inside);
  EXPECT_GT(Must(a, b, guides).mean, 90.0);
  const auto change = [&](Layer layer, float value) {
    GuideSet next = guides;
    for (std::size_t i = 0; i < next.pixel_count(); ++i) {
      if (i % 40 >= 20) next.Plane(layer)[i] = value;
    }
    return next;
  };
  for (const auto& [layer, value] :
       {std::pair{Layer::kObject, 2.0f}, {Layer::kDepth, 3.0f}, {Layer::kCoverage, 0.5f}}) {
    const GuideSet next = change(layer, value);
    const FlickerReport report = Must(a, b, guides, &next);
    EXPECT_EQ(report.pixels, left);
    EXPECT_EQ(report.mean, 0.0);
  }
  const GuideSet nearer = change(Layer::kDepth, 3.9f);
  EXPECT_EQ(Must(a, b, guides, &nearer).pixels, inside);
}

// Another side of one object at equal depth: pref separates them.
TEST(Flicker, PrefTellsAnotherPlaceOfTheSameObject) {
  const Picture a = Painted(40, 30, Noise), b = Painted(40, 30, [](int x, int y) { return Noise(x - 1, y); });
  GuideSet guides = Moving(40, 30, 1.0f, 0.0f);
  guides.Add(Layer::kPref);
  GuideSet next = guides;
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kPref, 0)[i] = 0.01f * static_cast<float>(i % 40);
    next.Plane(Layer::kPref, 0)[i] = 0.01f * (static_cast<float>(i % 40) - 1.0f) + (i % 40 < 10 ? 0.05f : 0.0f);
  }
  const FlickerReport report = Must(a, b, guides, &next);
  EXPECT_EQ(report.mean, 0.0);
  EXPECT_EQ(report.pixels, 30u * 28u);  // 38 × 28 less the 8 columns that land left of the tenth
}

TEST(Flicker, TransparentPaintLiesOnWhite) {
  Picture a = Painted(20, 20, [](int, int) { return 55.0; }), b = a;
  for (std::size_t i = 3; i < b.rgba.size(); i += 4) b.rgba[i] = 0;
  EXPECT_NEAR(Must(a, b, Moving(20, 20, 0.0f, 0.0f)).mean, 200.0, 0.01);
}

TEST(Flicker, MotionThatIsNoNumberCountsAsHidden) {
  const Picture a = Painted(9, 9, Noise);
  GuideSet guides = Moving(9, 9, 0.0f, 0.0f);
  guides.Plane(Layer::kMotion, 0)[guides.Index(4, 4)] = std::nanf("");
  guides.Plane(Layer::kMotion, 1)[guides.Index(5, 5)] = 1e30f;
  EXPECT_EQ(Must(a, a, guides).pixels, 47u);
}

TEST(Flicker, WhatCannotBeMeasured) {
  const Picture a = Painted(20, 20, Noise), wide = Painted(21, 20, Noise);
  const GuideSet guides = Moving(20, 20, 0.0f, 0.0f);
  EXPECT_FALSE(MeasureFlicker(wide, a, guides).ok());
  EXPECT_FALSE(MeasureFlicker(a, wide, guides).ok());
  const GuideSet next = Moving(21, 20, 0.0f, 0.0f);
  EXPECT_FALSE(MeasureFlicker(a, a, guides, &next).ok());
  GuideSet still = guides;
  still.Remove(Layer::kMotion);
  const auto missing = MeasureFlicker(a, a, still);
  ASSERT_FALSE(missing.ok());
  EXPECT_NE(missing.error().message.find("no layer motion"), std::string::npos);
}

}  // namespace
}  // namespace scumble
