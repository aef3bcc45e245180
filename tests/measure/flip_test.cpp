// LDR-FLIP against the formulas of its paper, in plain form, and against values that follow from them by hand.
#include "measure/flip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include "core/image/color.h"
#include "core/image/hash.h"

namespace scumble {
namespace {

using Color = std::array<double, 3>;

// Planes are floats. In Lab, whose values are below 250, that is an error below 2e-5; q_c = 0.7 makes at most 5e-4 of
// it and the scale p_t / (p_c c_max) = 0.058 at most 3e-5. In features, 1e-7 and with q_f = 0.5 at most 3e-4 in an
// exponent; the derivative of e^x by x is at most 1/e for e in [0, 1] (of −e ln e), so at most 1.2e-4.
constexpr double kRounding = 1.5e-4;

LinearColors Linear(int width, int height, const std::function<Color(int x, int y)>& color) {
  LinearColors out{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Color rgb = color(x, y);
      for (std::size_t c = 0; c < 3; ++c) out.planes[c].push_back(static_cast<float>(rgb[c]));
    }
  }
  return out;
}

LinearColors Flat(Color color) {
  return Linear(24, 24, [=](int, int) { return color; });
}

LinearColors Chance(std::uint64_t seed, int width, int height) {
  return Linear(width, height, [=](int x, int y) {
    const int patch = int(Hash(seed, x / 7, y / 5) % 3);
    return Color{UnitFloat(Hash(seed, x, y, 0)), patch * 0.4, 0.5 * UnitFloat(Hash(seed, x / 2, y / 2, 1))};
  });
}

FlipReport Must(const LinearColors& a, const LinearColors& b, FlipOptions options = {}) {
  const auto report = MeasureFlip(a, b, options);
  EXPECT_TRUE(report.ok()) << (report.ok() ? "" : report.error().message);
  return report.ok() ? *report : FlipReport{};
}

// ---- The paper, slowly: two-dimensional filters, and the matrix of the authors' code as it stands there. ----

Color Times(const std::array<Color, 3>& rows, const Color& v) {
  Color out{};
  for (std::size_t i = 0; i < 3; ++i) out[i] = rows[i][0] * v[0] + rows[i][1] * v[1] + rows[i][2] * v[2];
  return out;
}

const std::array<Color, 3> kXyzFromRgb = {{{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
                                           {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
                                           {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}}};
const std::array<Color, 3> kRgbFromXyz = {{{3.241003275, -1.537398934, -0.498615861},
                                           {-0.969224334, 1.875930071, 0.041554224},
                                           {0.055639423, -0.204011202, 1.057148933}}};
const Color kWhite = {0.950428545, 1.0, 1.088900371};

Color HuntLab(const Color& rgb) {
  const Color xyz = Times(kXyzFromRgb, rgb);
  Color f{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double t = xyz[i] / kWhite[i];
    f[i] = t > std::pow(6.0 / 29, 3) ? std::pow(t, 1.0 / 3) : t * 841.0 / 108 + 4.0 / 29;
  }
  const double lightness = 116 * f[1] - 16;
  return {lightness, 0.01 * lightness * 500 * (f[0] - f[1]), 0.01 * lightness * 200 * (f[1] - f[2])};
}

double Hyab(const Color& a, const Color& b) { return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]); }

double PlainColorError(const Color& a, const Color& b) {
  const double largest = std::pow(Hyab(HuntLab({0, 1, 0}), HuntLab({0, 0, 1})), 0.7), knee = 0.4 * largest;
  const double error = std::pow(Hyab(HuntLab(a), HuntLab(b)), 0.7);
  return error < knee ? 0.95 * error / knee : 0.95 + 0.05 * (error - knee) / (largest - knee);
}

// weight(dx, dy) over a square of side 2 · radius + 1; borders continued.
double Convolved(const LinearColors& image, int x, int y, int radius, const std::function<double(int, int)>& weight,
                 const std::function<double(const Color&)>& value) {
  double sum = 0.0;
  for (int dy = -radius; dy <= radius; ++dy) {
    for (int dx = -radius; dx <= radius; ++dx) {
      const std::size_t i = std::size_t(std::clamp(y + dy, 0, image.height - 1)) * image.width +
                            std::size_t(std::clamp(x + dx, 0, image.width - 1));
      sum += weight(dx, dy) * value({image.planes[0][i], image.planes[1][i], image.planes[2][i]});
    }
  }
  return sum;
}

double SumOver(int radius, const std::function<double(int, int)>& weight, int sign) {
  double sum = 0.0;
  for (int dy = -radius; dy <= radius; ++dy) {
    for (int dx = -radius; dx <= radius; ++dx) sum += std::max(0.0, sign * weight(dx, dy));
  }
  return sum;
}

Color Opponent(const Color& rgb) {
  const Color xyz = Times(kXyzFromRgb, rgb);
  const double x = xyz[0] / kWhite[0], y = xyz[1] / kWhite[1], z = xyz[2] / kWhite[2];
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Color Blurred(const LinearColors& image, int x, int y, double ppd) {
  const double a1[3] = {1, 1, 34.1}, b1[3] = {0.0047, 0.0053, 0.04}, a2[3] = {0, 0, 13.5}, b2[3] = {1e-5, 1e-5, 0.025};
  const double pi = std::numbers::pi;
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * ppd));
  Color seen{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto weight = [&](int dx, int dy) {
      const double z = (dx * dx + dy * dy) / (ppd * ppd);
      return a1[k] * std::sqrt(pi / b1[k]) * std::exp(-pi * pi * z / b1[k]) +
             a2[k] * std::sqrt(pi / b2[k]) * std::exp(-pi * pi * z / b2[k]);
    };
    seen[k] = Convolved(image, x, y, radius, weight, [&](const Color& rgb) { return Opponent(rgb)[k]; }) /
              SumOver(radius, weight, 1);
  }
  const double level = (seen[0] + 16) / 116;
  Color rgb = Times(kRgbFromXyz, {(level + seen[1] / 500) * kWhite[0], level, (level - seen[2] / 200) * kWhite[2]});
  for (double& value : rgb) value = std::clamp(value, 0.0, 1.0);
  return rgb;
}

double Feature(const LinearColors& image, int x, int y, double ppd, bool is_point) {
  const double sigma = 0.5 * 0.082 * ppd;
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  const auto along = [&](int t, int other) {
    const double g = std::exp(-(t * t + other * other) / (2 * sigma * sigma));
    return is_point ? (t * t / (sigma * sigma) - 1) * g : -t * g;
  };
  const double positive = SumOver(radius, along, 1), negative = SumOver(radius, along, -1);
  const auto balanced = [&](int t, int other) { return along(t, other) / (along(t, other) > 0 ? positive : negative); };
  const auto level = [](const Color& rgb) { return (Opponent(rgb)[0] + 16) / 116; };
  const double across = Convolved(
      image, x, y, radius, [&](int dx, int dy) { return balanced(dx, dy); }, level);
  const double down = Convolved(
      image, x, y, radius, [&](int dx, int dy) { return balanced(dy, dx); }, level);
  return std::hypot(across, down);
}

double PlainFlip(const LinearColors& a, const LinearColors& b, int x, int y, double ppd) {
  const double color = PlainColorError(Blurred(a, x, y, ppd), Blurred(b, x, y, ppd));
  const double feature = std::max(std::abs(Feature(a, x, y, ppd, false) - Feature(b, x, y, ppd, false)),
                                  std::abs(Feature(a, x, y, ppd, true) - Feature(b, x, y, ppd, true)));
  return std::pow(color, 1 - std::pow(feature / std::sqrt(2.0), 0.5));
}

TEST(Flip, IsThePapersFormula) {
  for (const double ppd : {4.0, 20.0, 67.02}) {
    const LinearColors a = Chance(1, 23, 17), b = Chance(2, 23, 17);
    const FlipReport report = Must(a, b, {.pixels_per_degree = ppd});
    double mean = 0.0;
    for (int y = 0; y < 17; ++y) {
      for (int x = 0; x < 23; ++x) {
        const double plain = PlainFlip(a, b, x, y, ppd);
        ASSERT_NEAR(report.map[std::size_t(y) * 23 + std::size_t(x)], plain, kRounding) << x << ", " << y << " " << ppd;
        mean += plain / (17 * 23);
      }
    }
    EXPECT_NEAR(report.mean, mean, kRounding);
    EXPECT_EQ(report.max, *std::max_element(report.map.begin(), report.map.end()));
  }
}

// A dot, a line and a step: what features are for.
TEST(Flip, IsThePapersFormulaOnFeatures) {
  const auto grey = [](double v) { return Color{v, v, v}; };
  const LinearColors plain = Linear(21, 21, [&](int, int) { return grey(0.2); });
  const LinearColors dot = Linear(21, 21, [&](int x, int y) { return grey(x == 10 && y == 10 ? 1.0 : 0.2); });
  const LinearColors line = Linear(21, 21, [&](int x, int) { return grey(x == 10 ? 0.0 : 0.2); });
  const LinearColors step = Linear(21, 21, [&](int, int y) { return grey(y < 10 ? 0.2 : 0.5); });
  for (const LinearColors* other : {&dot, &line, &step}) {
    const FlipReport report = Must(plain, *other, {.pixels_per_degree = 30.0});
    for (const auto& [x, y] : {std::pair{10, 10}, {9, 10}, {12, 8}, {0, 0}, {20, 9}}) {
      EXPECT_NEAR(report.map[std::size_t(y * 21 + x)], PlainFlip(plain, *other, x, y, 30.0), kRounding)
          << x << ", " << y;
    }
  }
}

TEST(Flip, EqualPicturesScoreNothingAtAll) {
  const LinearColors a = Chance(3, 40, 30);
  const FlipReport report = Must(a, a);
  EXPECT_EQ(report.mean, 0.0);
  EXPECT_EQ(report.max, 0.0);
  EXPECT_EQ(report.rms, 0.0);
}

// Flat pictures have no features, and a blur does not change them: only the colour metric remains. Published L*a*b* of
// the primaries of sRGB under D65: green (87.735, −86.183, 83.179), blue (32.297, 79.188, −107.860). Hunt-adjusted:
// (87.735, −75.612, 72.977) and (32.297, 25.575, −34.836), so HyAB is 55.438 + √(101.187² + 107.813²) = 203.299 and
// c_max = 203.299^0.7 = 41.275. Of black and white HyAB is 100.
TEST(Flip, FlatColoursAsTheyFollowByHand) {
  EXPECT_NEAR(Must(Flat({0, 1, 0}), Flat({0, 0, 1})).mean, 1.0, kRounding) << "the pair that c_max is of";
  const double largest = std::pow(203.299, 0.7), black_white = std::pow(100.0, 0.7);
  EXPECT_NEAR(largest, 41.275, 1e-3);
  const double expected = 0.95 + 0.05 * (black_white - 0.4 * largest) / (0.6 * largest);
  EXPECT_NEAR(expected, 0.9674, 5e-5);
  EXPECT_NEAR(Must(Flat({0, 0, 0}), Flat({1, 1, 1})).mean, expected, kRounding);
  // L* of linear 0.18 is 116 · 0.18^(1/3) − 16 = 49.496, of 0.2 it is 51.837: 2.341 apart, on the lower branch.
  EXPECT_NEAR(Must(Flat({0.18, 0.18, 0.18}), Flat({0.2, 0.2, 0.2})).mean, 0.95 * std::pow(2.341, 0.7) / (0.4 * largest),
              kRounding);
  // Red is (53.241, 80.092, 67.203), cyan (91.113, −48.088, −14.131), each times L/100 in a and b.
  const double hyab =
      91.113 - 53.241 + std::hypot(0.53241 * 80.092 + 0.91113 * 48.088, 0.53241 * 67.203 + 0.91113 * 14.131);
  EXPECT_NEAR(Must(Flat({1, 0, 0}), Flat({0, 1, 1})).mean,
              0.95 + 0.05 * (std::pow(hyab, 0.7) - 0.4 * largest) / (0.6 * largest), kRounding);
}

TEST(Flip, PixelsPerDegreeAreThePublishedOnes) {
  EXPECT_NEAR(PixelsPerDegree(0.7, 3840, 0.7), 3840 * std::numbers::pi / 180, 1e-12);
  EXPECT_EQ(PixelsPerDegree(0.7, 3840, 0.7), FlipOptions().pixels_per_degree);
  EXPECT_NEAR(FlipOptions().pixels_per_degree, 67.02, 0.001);
}

// One changed pixel is seen as far as the wider of the filters reaches, and no further: ⌈3 √(0.04 / (2 π²)) · 67.02⌉ =
// ⌈9.051⌉ = 10 pixels for colours, ⌈3 · 0.5 · 0.082 · 67.02⌉ = ⌈8.243⌉ = 9 for features.
TEST(Flip, FiltersReachAsFarAsPublished) {
  const auto dot = [](double blue) {
    return Linear(41, 41, [=](int x, int y) { return Color{0.3, 0.3, x == 20 && y == 20 ? blue : 0.3}; });
  };
  const FlipReport report = Must(dot(0.3), dot(1.0));
  const auto at = [&](int x, int y) { return report.map[std::size_t(y * 41 + x)]; };
  EXPECT_GT(at(30, 20), 0.0f);
  EXPECT_GT(at(20, 10), 0.0f);
  for (int i = 0; i < 41; ++i) {
    EXPECT_EQ(at(31, i), 0.0f);
    EXPECT_EQ(at(i, 9), 0.0f);
  }
}

// The formula is symmetric in reference and test, left and right, rows and columns. The order of sums is not.
TEST(Flip, IsSymmetric) {
  const LinearColors a = Chance(5, 26, 19), b = Chance(6, 26, 19);
  const FlipReport report = Must(a, b);
  EXPECT_EQ(Must(b, a).map, report.map);
  const auto turned = [](const LinearColors& in, bool transpose) {
    return Linear(transpose ? in.height : in.width, transpose ? in.width : in.height, [&](int x, int y) {
      const std::size_t i = transpose ? std::size_t(x) * in.width + y : std::size_t(y) * in.width + (in.width - 1 - x);
      return Color{in.planes[0][i], in.planes[1][i], in.planes[2][i]};
    });
  };
  const FlipReport mirrored = Must(turned(a, false), turned(b, false)),
                   transposed = Must(turned(a, true), turned(b, true));
  for (int y = 0; y < 19; ++y) {
    for (int x = 0; x < 26; ++x) {
      EXPECT_NEAR(mirrored.map[std::size_t(y * 26 + 25 - x)], report.map[std::size_t(y * 26 + x)], kRounding);
      EXPECT_NEAR(transposed.map[std::size_t(x * 19 + y)], report.map[std::size_t(y * 26 + x)], kRounding);
    }
  }
}

TEST(Flip, SameBytesWithAnyNumberOfThreads) {
  const LinearColors a = Chance(7, 61, 45), b = Chance(8, 61, 45);
  const FlipReport one = Must(a, b, {.threads = 1});
  for (const int threads : {2, 3, 7}) {
    const FlipReport many = Must(a, b, {.threads = threads});
    EXPECT_EQ(many.map, one.map);
    EXPECT_EQ(many.mean, one.mean);
  }
}

TEST(Flip, PicturesAreDecodedAndLieOnWhite) {
  Picture clear(9, 5), white(9, 5), grey(9, 5);
  std::fill(white.rgba.begin(), white.rgba.end(), 65535);
  for (std::size_t i = 0; i < grey.rgba.size(); ++i) grey.rgba[i] = i % 4 == 3 ? 65535 : 32896;
  EXPECT_EQ(MeasureFlip(clear, white)->max, 0.0);
  const double linear = SrgbToLinear(32896 / 65535.0f);
  const double expected = Must(Flat({linear, linear, linear}), Flat({1, 1, 1})).mean;
  EXPECT_NEAR(MeasureFlip(grey, white)->mean, expected, kRounding);
  EXPECT_NEAR(MeasureFlip(grey, white)->rms, 1.0 - 32896.0 / 65535, 1e-6) << "in the encoding";
  // Half of the values are 0.5 off, half not at all: √(0.25 / 2).
  const auto halves = [](double left) {
    return Linear(8, 4, [=](int x, int) { return Color{x < 4 ? left : 0.5, x < 4 ? left : 0.5, x < 4 ? left : 0.5}; });
  };
  EXPECT_NEAR(Must(halves(0.5), halves(1.0)).rms, std::sqrt(0.125), 1e-12);
}

TEST(Flip, ValuesThatAreNoColoursAreClamped) {
  const float nan = std::nanf(""), inf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(Must(Flat({nan, -1e30f, inf}), Flat({0, 0, 1})).max, 0.0);
  for (const float value : Must(Flat({nan, inf, -inf}), Chance(9, 24, 24)).map)
    EXPECT_TRUE(value >= 0.0f && value <= 1.0f);
}

TEST(Flip, OnePixelAndOneRowAreEnough) {
  const auto dark = [](int w, int h) { return Linear(w, h, [](int, int) { return Color{0, 0, 0}; }); };
  const auto light = [](int w, int h) { return Linear(w, h, [](int, int) { return Color{1, 1, 1}; }); };
  const double flat = Must(Flat({0, 0, 0}), Flat({1, 1, 1})).mean;
  EXPECT_NEAR(Must(dark(1, 1), light(1, 1)).mean, flat, kRounding);
  EXPECT_NEAR(Must(dark(50, 1), light(50, 1)).mean, flat, kRounding);
  EXPECT_NEAR(Must(dark(1, 50), light(1, 50)).mean, flat, kRounding);
}

TEST(Flip, RefusesWhatItCannotCompare) {
  const auto sizes = MeasureFlip(Picture(4, 3), Picture(3, 4));
  ASSERT_FALSE(sizes.ok());
  EXPECT_EQ(sizes.error().kind, ErrorKind::kInput);
  EXPECT_EQ(sizes.error().message, "the reference is 4×3, the other picture 3×4: FLIP compares pictures of one size");
  EXPECT_FALSE(MeasureFlip(Picture(), Picture()).ok());
  for (const double ppd : {0.0, -1.0, std::nan(""), 1001.0, HUGE_VAL}) {
    const auto report = MeasureFlip(Picture(2, 2), Picture(2, 2), {.pixels_per_degree = ppd});
    ASSERT_FALSE(report.ok()) << ppd;
    EXPECT_EQ(report.error().kind, ErrorKind::kUsage);
  }
}

}  // namespace
}  // namespace scumble
