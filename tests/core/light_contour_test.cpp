// Hard contours of light: the share of a pixel beyond them.
#include "core/filter/light_contour.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/support/light_fixtures.h"

namespace scumble {
namespace {

TEST(LightContour, SlantedShadowsHaveTheAreaOfALine) {
  for (const double slope : {0.03, 0.1, 0.27, 0.5, 0.71, 1.0}) {
    const double at = 24.3 - 24.0 * slope;
    const GuideSet guides = SlantedShadow(64, at, slope);
    const internal::LightContour contour({guides.Plane(Layer::kShadow), 0.1f}, guides);
    const auto shade = [&](int x, int y) {
      const double beyond = contour.BeyondOf(x, y)[0].share;
      return guides.Plane(Layer::kShadow)[guides.Index(x, y)] > 0.5f ? 1.0 - beyond : beyond;
    };
    const Errors steps = ErrorsAlong(
        64, at, slope, [&](int x, int y) { return double(guides.Plane(Layer::kShadow)[guides.Index(x, y)]); });
    const Errors line = ErrorsAlong(64, at, slope, shade);
    EXPECT_LT(line.mean, 0.75 * steps.mean) << slope;
    EXPECT_LT(line.most, 0.3) << slope;
  }
}

TEST(LightContour, UprightShadowsStayAndCornersAreCutByHalfAPixel) {
  GuideSet guides = FlatLight(32);
  const auto shadow = guides.Plane(Layer::kShadow);
  for (int y = 10; y < 20; ++y) {
    for (int x = 8; x < 24; ++x) shadow[guides.Index(x, y)] = 1.0f;
  }
  const internal::LightContour contour({shadow, 0.1f}, guides);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      const bool is_corner = (x == 8 || x == 23) && (y == 10 || y == 19);
      EXPECT_NEAR(contour.BeyondOf(x, y)[0].share, is_corner ? 0.125 : 0.0, 1e-6) << x << " " << y;
    }
  }
}

// A gradient has no contour, whatever its direction, and light of another object makes none.
TEST(LightContour, GradientsAndObjectsMakeNone) {
  GuideSet guides = FlatLight(32);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    const auto x = static_cast<float>(i % 32), y = static_cast<float>(i / 32);
    guides.Plane(Layer::kObject)[i] = x + 0.3f * y < 16.0f ? 1.0f : 2.0f;
    guides.Plane(Layer::kLuminance)[i] = (x + 0.3f * y < 16.0f ? 0.0f : 1.0f) + 0.03f * x + 0.05f * y;
  }
  const internal::LightContour contour({guides.Plane(Layer::kLuminance), 0.1f}, guides);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      EXPECT_EQ(contour.BeyondOf(x, y)[0].share, 0.0f) << x << " " << y;
    }
  }
}

// Soft light, too, is cut by a straight line, and every border has its own.
TEST(LightContour, BordersCutSoftLightByAStraightLine) {
  const double slope = 0.23, at = 40.2;
  GuideSet guides = FlatLight(64);
  const auto light = guides.Plane(Layer::kLuminance);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x)
      light[guides.Index(x, y)] = static_cast<float>(0.5 + 0.02 * (y + 0.5 - at - slope * (x + 0.5)));
  }
  const std::vector<float> borders = {0.1f, 0.5f};
  const internal::LightContour contour({light, 0.0f, 0, 1.0f, borders}, guides);
  const auto share_above = [&](float border) {
    return [&, border](int x, int y) {
      const internal::LightContour::Beyond beyond = contour.BeyondOf(x, y)[0];
      const float own = light[guides.Index(x, y)];
      // Of the other border nothing is seen here.
      const bool is_other = beyond.share > 0.0f && (own < border) == (light[beyond.pixel] < border);
      const double share = is_other ? 0.0 : double(beyond.share);
      return own < border ? 1.0 - share : share;
    };
  };
  EXPECT_LT(ErrorsAlong(64, at, slope, share_above(0.5f)).most, 0.3);
  EXPECT_LT(ErrorsAlong(64, at, slope, share_above(0.5f)).mean, 0.1);
  EXPECT_LT(ErrorsAlong(64, at - 20.0, slope, share_above(0.1f)).most, 0.3);
  int visited = 0, beside = 0;
  for (int y = 0; y < 64; ++y) {
    contour.ForEachInRow(y, 3, 61, [&](int x, std::uint32_t sides) {
      EXPECT_TRUE(x >= 3 && x < 61);
      EXPECT_EQ(contour.BeyondOf(x, y, sides)[0].share, contour.BeyondOf(x, y)[0].share);
      ++visited;
    });
    for (int x = 3; x < 61; ++x) beside += contour.BeyondOf(x, y)[0].share > 0.0f;
  }
  EXPECT_GE(visited, beside);
  EXPECT_LT(visited, 4 * 64);  // two borders with two sides
  EXPECT_GT(beside, 64);
}

// A pixel between two contours: each of its sides gets the area beyond its line.
TEST(LightContour, BothSidesOfANarrowBandAreSeen) {
  GuideSet guides = FlatLight(32);
  const auto light = guides.Plane(Layer::kLuminance);
  const double slope = 0.25;
  const auto left_of = [&](int y) { return 15.2 + slope * (y + 0.5); };  // at the row's middle
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      const double at = x + 0.5 - left_of(y);
      light[guides.Index(x, y)] = at < 0.0 ? 0.0f : at < 1.0 ? 0.5f : 1.0f;
    }
  }
  const internal::LightContour contour({light, 0.1f}, guides);
  double dark = 0.0, bright = 0.0;
  for (int y = 8; y < 24; ++y) {
    for (int x = 1; x < 31; ++x) {
      if (light[guides.Index(x, y)] != 0.5f) continue;
      const auto both = contour.BeyondOf(x, y);
      const double second = double(both[1].share), first = double(both[0].share) * (1.0 - second);
      EXPECT_LE(first + second, 1.0);
      const bool is_first_dark = light[both[0].pixel] == 0.0f;
      dark += is_first_dark ? first : second, bright += is_first_dark ? second : first;
    }
  }
  EXPECT_NEAR(dark / 16.0, 0.125, 0.05);
  EXPECT_NEAR(bright / 16.0, 0.125, 0.05);
}

}  // namespace
}  // namespace scumble
