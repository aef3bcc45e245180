// Functions whose bits must not depend on the machine, against the C library's in long double.
#include "core/image/exact_math.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>

#include "core/image/hash.h"
#include "tests/support/numbers.h"

namespace scumble {
namespace {

constexpr double kStated = 4e-16;

double Between(double low, double high, int i) {
  return low + (high - low) * (static_cast<double>(Hash(7, i) >> 11) / 9007199254740992.0);
}

TEST(ExactMath, SinesAreWithinTheStatedError) {
  const long double pi = std::acos(-1.0L);
  for (const double reach : {1e-9, 1.0, 8.0, 1e6}) {
    for (int i = 0; i < 20000; ++i) {
      const double x = Between(-reach, reach, i);
      const long double turned = pi * std::fmod(static_cast<long double>(x), 2.0L);
      ASSERT_NEAR(static_cast<double>(SinPi(x) - std::sin(turned)), 0.0, kStated) << x;
      ASSERT_NEAR(static_cast<double>(CosPi(x) - std::cos(turned)), 0.0, kStated) << x;
    }
  }
}

TEST(ExactMath, WholeQuarterTurnsAreExact) {
  for (int quarter = -9; quarter <= 9; ++quarter) {
    const double sine[] = {0.0, 1.0, 0.0, -1.0};
    EXPECT_EQ(SinDegrees(90.0 * quarter), sine[(quarter + 12) % 4]) << quarter;
    EXPECT_EQ(CosDegrees(90.0 * quarter), sine[(quarter + 13) % 4]) << quarter;
  }
  EXPECT_NEAR(CosDegrees(60.0), 0.5, kStated);
  EXPECT_NEAR(SinDegrees(30.0), 0.5, kStated);
  for (const double x : {kNan, kInfinity, -kInfinity}) {
    EXPECT_TRUE(std::isnan(SinPi(x)));
    EXPECT_TRUE(std::isnan(CosPi(x)));
  }
}

TEST(ExactMath, PowersOfTwoAreWithinTheStatedError) {
  for (const double reach : {1e-9, 0.5, 3.0, 1000.0}) {
    for (int i = 0; i < 20000; ++i) {
      const double x = Between(-reach, reach, i);
      const long double truth = std::exp2(static_cast<long double>(x));
      ASSERT_NEAR(static_cast<double>(Exp2(x) / truth - 1.0L), 0.0, kStated) << x;
    }
  }
  for (int n = -1074; n <= 1023; ++n) ASSERT_EQ(Exp2(n), std::ldexp(1.0, n)) << n;
  EXPECT_EQ(Exp2(1024.0), kInfinity);
  EXPECT_EQ(Exp2(kInfinity), kInfinity);
  EXPECT_EQ(Exp2(-1076.0), 0.0);
  EXPECT_EQ(Exp2(-kInfinity), 0.0);
  EXPECT_TRUE(std::isnan(Exp2(kNan)));
}

TEST(ExactMath, LogarithmsAreWithinTheStatedError) {
  for (const double reach : {1e-6, 0.5, 3.0, 1000.0}) {
    for (int i = 0; i < 20000; ++i) {
      const double x = std::exp2(Between(-reach, reach, i));
      const long double truth = std::log2(static_cast<long double>(x));
      const double scale = std::fmax(std::fabs(static_cast<double>(truth)), 1.0 / 64);
      ASSERT_NEAR(static_cast<double>(Log2(x) - truth) / scale, 0.0, kStated) << x;
    }
  }
  for (int n = -1074; n <= 1023; ++n) ASSERT_EQ(Log2(std::ldexp(1.0, n)), n);
  EXPECT_EQ(Log2(0.0), -kInfinity);
  EXPECT_EQ(Log2(kInfinity), kInfinity);
  EXPECT_TRUE(std::isnan(Log2(-1.0)));
  EXPECT_TRUE(std::isnan(Log2(kNan)));
}

// Bits that were once worked out: a machine on which any differs would paint other pictures.
TEST(ExactMath, BitsAreTheSameEverywhere) {
  std::uint64_t digest = 0;
  for (int i = 0; i < 5000; ++i) {
    const double x = Between(-20.0, 20.0, i);
    for (const double value : {SinPi(x), CosPi(x), Exp2(x), Log2(x + 20.5)}) {
      digest = Hash(digest, std::bit_cast<std::int64_t>(value));
    }
  }
  EXPECT_EQ(digest, 17878214109194021984u);
}

// As printf rounds and strtod reads.
TEST(ExactMath, RoundedNumbersAreTheirDecimals) {
  std::mt19937_64 random(3);
  const auto expect = [](double x, int digits) {
    char text[40];
    std::snprintf(text, sizeof text, "%.*g", digits, x);
    ASSERT_EQ(RoundToDigits(x, digits), std::strtod(text, nullptr)) << text;
    ASSERT_EQ(RoundToDigits(-x, digits), -std::strtod(text, nullptr)) << text;
  };
  for (int i = 0; i < 20000; ++i) {
    const double share = double(random() >> 11) / double(std::uint64_t(1) << 53);
    expect(std::pow(10.0, 29.0 * share - 7.0), 1 + i % 15);
    expect(double(static_cast<float>(share)), 6);
    expect(double(random() % 2000001) / 2.0, 6);  // with ties
    expect(double(random() % 20001) / 16384.0, 6);
  }
  for (const double x : {0.1, 0.5, 1.0, 9.999995, 9.9999949, 99999.95, 999999.5, 1e6, 1e-5, 1e22, 2.5, 0.125}) {
    for (int digits = 1; digits <= 15; ++digits) expect(x, digits);
  }
  for (const double x : {0.0, 1e300, std::numeric_limits<double>::infinity()}) EXPECT_EQ(RoundToDigits(x, 6), x);
  EXPECT_TRUE(std::isnan(RoundToDigits(std::nan(""), 6)));
  EXPECT_DOUBLE_EQ(RoundToDigits(1.23456789e-20, 6), 1.23457e-20);
}

}  // namespace
}  // namespace scumble
