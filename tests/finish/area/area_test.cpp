// Filters against formulas and plain sums.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/image/color.h"
#include "core/image/oklab.h"
#include "tests/finish/finish_fixtures.h"

namespace scumble {
namespace {

double LightnessAt(const Picture& picture, int x, int y) {
  const std::uint16_t* const texel = picture.At(x, y);
  return OklabFromLinear({Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])}).x;
}

std::uint16_t CodeOf(double lightness) {
  return Srgb16FromLinear(static_cast<float>(lightness * lightness * lightness));
}

// A grey picture of a lightness by column.
template <class Lightness>
Picture Columns(int width, int height, const Lightness& lightness) {
  Picture picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::fill_n(picture.At(x, y), 3, CodeOf(lightness(x)));
      picture.At(x, y)[3] = 65535;
    }
  }
  return picture;
}

SmoothPass Unbordered() {
  SmoothPass pass;
  pass.borders = false;
  return pass;
}

TEST(Smooth, ConstantsKeepTheirValue) {
  const Picture made = Finished(StepOf(Unbordered()), nullptr, PlainPicture(40, 20, 50000, 20000, 3000));
  for (std::size_t i = 0; i < made.rgba.size(); i += 4) {
    EXPECT_NEAR(made.rgba[i], 50000, 8);
    EXPECT_NEAR(made.rgba[i + 2], 3000, 8);
  }
}

TEST(Smooth, HighStepsStand) {
  const Picture made =
      Finished(StepOf(Unbordered()), nullptr, Columns(60, 20, [](int x) { return x < 30 ? 0.3 : 0.7; }));
  EXPECT_NEAR(LightnessAt(made, 29, 10), 0.3, 0.004);
  EXPECT_NEAR(LightnessAt(made, 30, 10), 0.7, 0.004);
}

TEST(Smooth, LowContrastGoes) {
  const Picture made =
      Finished(StepOf(Unbordered()), nullptr, Columns(60, 20, [](int x) { return x % 2 ? 0.49 : 0.51; }));
  EXPECT_NEAR(LightnessAt(made, 29, 10), LightnessAt(made, 30, 10), 0.001);
}

// With a wide range it is a Gaussian of up to two sigma.
TEST(Smooth, WideRangeIsAGaussian) {
  SmoothPass pass = Unbordered();
  pass.range = 1.0, pass.passes = 1, pass.radius = 3.0;
  const auto lightness = [](int x) { return 0.5 + 0.01 * std::sin(x * 0.7) + (x > 33 ? 0.01 : 0.0); };
  const Picture made = Finished(StepOf(pass), nullptr, Columns(60, 20, lightness));
  for (int x = 0; x < 60; ++x) {
    double sum = 0.0, weights = 0.0;
    for (int u = std::max(0, x - 6); u <= std::min(59, x + 6); ++u) {
      const double weight = std::exp(-0.5 * (u - x) * (u - x) / 9.0);
      sum += weight * lightness(u), weights += weight;
    }
    EXPECT_NEAR(LightnessAt(made, x, 10), sum / weights, 2e-4) << x;
  }
}

TEST(Smooth, ObjectsAndClearPixelsAreNotMixed) {
  GuideSet guides = FlatGuides(60, 20);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) guides.Plane(Layer::kObject)[i] = i % 60 < 30 ? 1.0f : 2.0f;
  Picture picture = Columns(60, 20, [](int x) { return x < 30 ? 0.50 : 0.52; });
  const Picture made = Finished(StepOf(SmoothPass()), &guides, picture);
  EXPECT_NEAR(LightnessAt(made, 29, 10), 0.50, 2e-4);
  EXPECT_NEAR(LightnessAt(made, 30, 10), 0.52, 2e-4);
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    if ((i / 4) % 60 >= 30) std::fill_n(&picture.rgba[i], 4, std::uint16_t{0});
  }
  EXPECT_NEAR(LightnessAt(Finished(StepOf(Unbordered()), nullptr, picture), 29, 10), 0.50, 2e-4);
}

TEST(Smooth, RowsAndColumnsAreAlike) {
  const Picture rows = Columns(40, 40, [](int x) { return 0.5 + 0.03 * std::sin(x * 0.9); });
  Picture columns(40, 40);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) std::copy_n(rows.At(x, y), 4, columns.At(y, x));
  }
  const Picture one = Finished(StepOf(Unbordered()), nullptr, rows);
  const Picture other = Finished(StepOf(Unbordered()), nullptr, columns);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) EXPECT_NEAR(one.At(x, y)[0], other.At(y, x)[0], 8);
  }
}

EdgesPass OfPaint() {
  EdgesPass pass;
  pass.tone = EdgesPass::Tone::kPaint;
  pass.ink = {0, 0, 0};
  return pass;
}

TEST(Edges, EvenToneHasNoLine) {
  const Picture picture = PlainPicture(40, 20, 50000, 20000, 3000);
  EXPECT_EQ(Finished(StepOf(OfPaint()), nullptr, picture).rgba, picture.rgba);
}

TEST(Edges, FillIsTheCurveOfTheTone) {
  EdgesPass pass = OfPaint();
  pass.fill = 1.0, pass.threshold = 0.7, pass.slope = 3.0;
  for (const double tone : {0.2, 0.5, 0.65, 0.8}) {
    const Picture made = Finished(StepOf(pass), nullptr, Columns(20, 20, [&](int) { return tone; }));
    const double ink = tone < 0.7 ? PlainSigmoid(3.0 * (0.7 - tone)) : 0.0;
    EXPECT_NEAR(LightnessAt(made, 10, 10), tone * (1.0 - ink), 1e-3) << tone;
  }
}

// A Gaussian leaves a ramp as it is, so the difference of two has the tone itself.
TEST(Edges, RampIsTheCurveOfTheTone) {
  EdgesPass pass = OfPaint();
  pass.fill = 1.0, pass.threshold = 0.7, pass.slope = 3.0, pass.width = 6.0;
  const auto tone_at = [](int x) { return 0.2 + 0.003 * x; };
  const Picture made = Finished(StepOf(pass), nullptr, Columns(200, 20, tone_at));
  for (int x = 30; x < 170; ++x) {
    const double tone = tone_at(x), ink = tone < 0.7 ? PlainSigmoid(3.0 * (0.7 - tone)) : 0.0;
    EXPECT_NEAR(LightnessAt(made, x, 10), tone * (1.0 - ink), 2e-3) << x;
  }
}

TEST(Edges, TurnWithThePicture) {
  const Picture given = ColorfulPicture(60, 40);
  Picture turned(40, 60);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 60; ++x) std::copy_n(given.At(x, y), 4, turned.At(39 - y, x));
  }
  const Picture made = Finished(StepOf(OfPaint()), nullptr, given);
  const Picture made_turned = Finished(StepOf(OfPaint()), nullptr, turned);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 60; ++x) {
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(made.At(x, y)[c], made_turned.At(39 - y, x)[c], 4) << x << ' ' << y;
    }
  }
}

// The trough of the response beside a step, at -sigma sqrt(2 ln(k (1 + p) / p) / (1 - k^-2)).
TEST(Edges, LineLiesBesideAStep) {
  EdgesPass pass = OfPaint();
  pass.fill = 1.0, pass.threshold = 0.6, pass.slope = 0.1, pass.width = 24.0;
  const double sigma = 24.0 / 2.055;
  const Picture made = Finished(StepOf(pass), nullptr, Columns(240, 4, [](int x) { return x < 120 ? 0.5 : 0.55; }));
  int darkest = 60;
  for (int x = 60; x < 118; ++x) {
    if (LightnessAt(made, x, 2) < LightnessAt(made, darkest, 2)) darkest = x;
  }
  const double before = LightnessAt(made, darkest - 1, 2), here = LightnessAt(made, darkest, 2),
               after = LightnessAt(made, darkest + 1, 2);
  const double at = darkest + 0.5 + 0.5 * (before - after) / (before - 2.0 * here + after);
  const double expected = sigma * std::sqrt(2.0 * std::log(1.6 * 21.0 / 20.0) / (1.0 - 1.0 / 2.56));
  EXPECT_NEAR(120.0 - at, expected, 0.1);
}

TEST(Edges, LookAtLightOrBaseColours) {
  GuideSet guides = FlatGuides(80, 20);
  guides.Add(Layer::kAlbedo);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kLuminance)[i] = i % 80 < 20 ? 0.1f : 1.0f;
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kAlbedo, c)[i] = i % 80 < 60 ? 0.1f : 0.9f;
  }
  EdgesPass pass;
  const Picture paint = PlainPicture(80, 20, 50000, 50000, 50000);
  const auto darkest = [&](const Picture& picture, int from, int to) {
    int least = 65535;
    for (int x = from; x < to; ++x) least = std::min<int>(least, picture.At(x, 10)[0]);
    return least;
  };
  const Picture light = Finished(StepOf(pass), &guides, paint);
  EXPECT_LT(darkest(light, 10, 22), 20000);
  EXPECT_EQ(darkest(light, 40, 80), 50000);
  pass.tone = EdgesPass::Tone::kAlbedo;
  const Picture albedo = Finished(StepOf(pass), &guides, paint);
  EXPECT_EQ(darkest(albedo, 0, 40), 50000);
  EXPECT_LT(darkest(albedo, 50, 62), 20000);
}

TEST(Edges, PaintStaysWhereLinesAre) {
  EdgesPass pass = OfPaint();
  pass.draw = EdgesPass::Draw::kPaint, pass.paper = {65535, 65535, 65535};
  const Picture made = Finished(StepOf(pass), nullptr, Columns(80, 20, [](int x) { return x < 40 ? 0.3 : 0.6; }));
  EXPECT_GT(LightnessAt(made, 5, 10), 0.99);
  EXPECT_GT(LightnessAt(made, 75, 10), 0.99);
  EXPECT_LT(LightnessAt(made, 39, 10), 0.4);
}

}  // namespace
}  // namespace scumble
