// Regular patterns against textures that only look alike everywhere.
#include "measure/painting/regularity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "bench/wall_measures.h"
#include "core/image/hash.h"

namespace scumble {
namespace {

constexpr int kSide = 256, kWindow = 128;
constexpr double kTurn = 2.0 * std::numbers::pi;

double Noise(int x, int y, int seed) { return UnitFloat(Hash(x, y, seed)) + UnitFloat(Hash(x, y, seed, 1)) - 1.0; }

RegularityReport Measure(const std::function<double(int x, int y)>& tone) {
  std::vector<float> plane;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) plane.push_back(static_cast<float>(50.0 + 10.0 * tone(x, y)));
  }
  std::vector<PictureRegion> windows;
  for (int i = 0; i < 4; ++i) windows.push_back({i % 2 * kWindow, i / 2 * kWindow, kWindow, kWindow});
  return MeasureRegularity(plane, kSide, windows);
}

TEST(Regularity, PeriodAndDirectionOfLines) {
  for (const double degrees : {0.0, 30.0, 90.0, 150.0}) {
    for (const double period : {6.0, 10.0, 16.0}) {
      const double angle = degrees / 360.0 * kTurn;
      const RegularityReport report =
          Measure([&](int x, int y) { return std::cos(kTurn * (x * std::cos(angle) - y * std::sin(angle)) / period); });
      SCOPED_TRACE(::testing::Message() << degrees << " degrees, " << period);
      EXPECT_GT(report.peak, 0.9);
      EXPECT_GT(report.local_echo, 0.9);
      EXPECT_FALSE(report.grid);
      EXPECT_NEAR(std::remainder(report.direction - degrees, 180.0), 0.0, 5.0);
      EXPECT_NEAR(report.period, period, 0.6);
    }
  }
}

TEST(Regularity, GridsOfAllKinds) {
  const auto checker = [](int x, int y) { return (x / 8 + y / 8) % 2 == 0 ? 1.0 : -1.0; };
  const auto dots = [](int x, int y) { return std::hypot(x % 20 - 10, y % 20 - 10) < 5.0 ? -1.0 : 0.5; };
  const auto weave = [](int x, int y) {
    return std::cos(kTurn * x / 7.0) * std::cos(kTurn * y / 9.0) + 0.5 * Noise(x, y, 1);
  };
  const auto screen = [](int x, int y) {  // a halftone of a tone that changes from left to right
    const double u = 0.9 * x + 0.4 * y, v = 0.9 * y - 0.4 * x;
    return std::cos(kTurn * u / 9.0) + std::cos(kTurn * v / 9.0) > 3.0 * x / kSide - 1.5 ? 1.0 : -1.0;
  };
  const RegularityReport squares = Measure(checker);
  EXPECT_GT(squares.peak, 0.9);
  EXPECT_NEAR(squares.period, 8.0 * std::sqrt(2.0), 0.01);
  EXPECT_NEAR(std::fabs(squares.direction - 90.0), 45.0, 0.01);
  const RegularityReport dotted = Measure(dots);
  EXPECT_GT(dotted.peak, 0.9);
  EXPECT_NEAR(dotted.period, 20.0, 0.01);
  for (const RegularityReport& report : {squares, dotted, Measure(weave), Measure(screen)}) {
    EXPECT_TRUE(report.grid);
    EXPECT_GT(report.peak, 0.5);
    EXPECT_EQ(report.windows, 4);
  }
  // After many periods as similar as after one.
  const RegularityReport woven = Measure(weave);
  EXPECT_GT(woven.echo, 0.85 * woven.peak);
}

TEST(Regularity, ChanceHasNoPeriod) {
  const RegularityReport noise = Measure([](int x, int y) { return Noise(x, y, 1); });
  EXPECT_LT(noise.peak, 0.05);
  EXPECT_EQ(noise.windows, 4);
  const RegularityReport specks = Measure([](int x, int y) { return Noise(x / 5, y / 5, 2); });
  EXPECT_LT(specks.peak, 0.15);
  // Long strokes in one direction that begin anywhere.
  const RegularityReport strokes = Measure([](int x, int y) { return Noise((x + 37 * (y / 3)) / 40, y / 3, 3); });
  EXPECT_LT(strokes.peak, 0.3);
  EXPECT_LT(strokes.local_echo, 0.5);
}

// Lines drawn by hand keep their distance roughly: the first period is seen, the fifth is not.
TEST(Regularity, LinesByHandAreForgottenAfterAFewPeriods) {
  const auto lines = [](double jitter) {
    return Measure([jitter](int x, int y) {
      const double across = x + 0.2 * y;
      double tone = 1.0;
      for (int i = static_cast<int>(across / 10.0) - 2; i <= static_cast<int>(across / 10.0) + 2; ++i) {
        const double at = 10.0 * (i + jitter * (UnitFloat(Hash(i, 5)) - 0.5));
        tone -= 2.0 * std::exp(-0.5 * (across - at) * (across - at));
      }
      return tone;
    });
  };
  EXPECT_GT(lines(0.0).peak, 0.9);
  EXPECT_GT(lines(0.0).echo, 0.9);
  EXPECT_LT(lines(1.0).peak, 0.45);
}

TEST(Regularity, WithoutTextureThereIsNothingToMeasure) {
  for (const double slope : {0.0, 0.01}) {
    const RegularityReport report = Measure([slope](int x, int) { return slope * x; });
    EXPECT_EQ(report.windows, 0);
    EXPECT_EQ(report.peak, 0.0);
    EXPECT_EQ(report.period, 0.0);
  }
}

// The integer sums against plain ones.
TEST(Regularity, AgreesWithThePlainCorrelation) {
  Picture picture(64, 64);
  std::vector<float> plane;
  for (int i = 0; i < 64 * 64; ++i) {
    const double tone = 0.5 + 0.2 * std::cos(kTurn * (i % 64) / 8.0) * std::cos(kTurn * (i / 64) / 8.0) +
                        0.05 * Noise(i % 64, i / 64, 9);
    for (int c = 0; c < 4; ++c)
      picture.rgba[std::size_t(4 * i + c)] = c == 3 ? 65535 : static_cast<std::uint16_t>(65535 * tone);
    plane.push_back(static_cast<float>(100.0 * tone));
  }
  RegularityOptions options;
  options.window = 64;
  const RegularityReport report = MeasureRegularity(plane, 64, {{0, 0, 64, 64}}, options);
  AutocorrelationOptions plain;
  plain.least_shift = 3, plain.subtract_sigma = 6.0;
  const AutocorrelationPeak peak = HighestAutocorrelation(picture, {0, 0, 64, 64}, plain);
  EXPECT_NEAR(report.peak, peak.value, 0.05);
  EXPECT_NEAR(report.period, std::sqrt(32.0), 0.01);
}

}  // namespace
}  // namespace scumble
