// The cube root, sRGB's curve and Oklab in floats, against the C library in long double.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/image/color.h"
#include "core/image/hash.h"
#include "core/image/oklab.h"
#include "core/image/scalar_lane.h"

namespace scumble {
namespace {

long double DecodedTruly(long double code) {
  const long double v = code / 65535.0L;
  return v <= 0.04045L ? v / 12.92L : std::pow((v + 0.055L) / 1.055L, 2.4L);
}

long double EncodedTruly(long double linear) {
  return 65535.0L * (linear <= 0.04045L / 12.92L ? linear * 12.92L : 1.055L * std::pow(linear, 1.0L / 2.4L) - 0.055L);
}

// The largest relative error of f against `truth` over the floats from `first` to `last`, `step` bit patterns apart.
template <class F, class Truth>
double LargestError(const F& f, const Truth& truth, float first, float last, std::uint32_t step) {
  double largest = 0.0;
  for (std::uint32_t bits = std::bit_cast<std::uint32_t>(first); bits <= std::bit_cast<std::uint32_t>(last);
       bits += step) {
    const float x = std::bit_cast<float>(bits);
    const long double expected = truth(static_cast<long double>(x));
    largest = std::max(largest, static_cast<double>(std::fabs(f(x) / expected - 1.0L)));
  }
  return largest;
}

TEST(ColorMath, RootsAreWithinTheStatedError) {
  const float least = std::numeric_limits<float>::min(), most = std::numeric_limits<float>::max();
  const auto cube_root = [](long double x) { return std::cbrt(x); };
  const auto five_twelfths = [](long double x) { return std::pow(x, 5.0L / 12.0L); };
  EXPECT_LE(LargestError(scalar::CubeRoot, cube_root, least, most, 997), 1.9e-7);
  EXPECT_LE(LargestError(scalar::CubeRoot, cube_root, 1.0f, 8.0f, 29), 1.9e-7) << "three octaves, densely";
  EXPECT_LE(LargestError(scalar::FiveTwelfths, five_twelfths, least, most, 4999), 3.3e-7);
  EXPECT_EQ(scalar::CubeRoot(0.0f), 0.0f);
  EXPECT_EQ(scalar::CubeRoot(1.0f), 1.0f);
  for (const float tiny : {1e-45f, 1e-42f, 1e-39f}) {
    EXPECT_GE(scalar::CubeRoot(tiny), 0.0f);
    EXPECT_LE(scalar::CubeRoot(tiny), 0x1p-42f);
  }
}

TEST(ColorMath, DecodingEveryCodeIsWithinTheStatedError) {
  for (int code = 1; code < 65536; ++code) {
    const long double expected = DecodedTruly(code), found = Srgb16ToLinear(static_cast<std::uint16_t>(code));
    ASSERT_NEAR(static_cast<double>(found / expected), 1.0, 1.15e-6) << code;
    ASSERT_NEAR(static_cast<double>(EncodedTruly(found)), code, 0.03);
  }
}

TEST(ColorMath, EncodingIsWithinTheStatedError) {
  int last = 0;
  for (std::uint32_t bits = 0; bits <= std::bit_cast<std::uint32_t>(1.0f); bits += bits < 0x35000000 ? 65536 : 97) {
    const float linear = std::bit_cast<float>(bits);
    const int code = Srgb16FromLinear(linear);
    ASSERT_NEAR(static_cast<double>(EncodedTruly(linear)), code, 0.53) << linear;
    ASSERT_GE(code, last - 1) << linear;
    last = code;
  }
}

// The same matrices and roots in long double.
TEST(ColorMath, OklabIsWithinAFewRoundings) {
  for (int i = 0; i < 20000; ++i) {
    const glm::vec3 c(UnitFloat(Hash(i, 1)), UnitFloat(Hash(i, 2)), UnitFloat(Hash(i, 3)) * (i % 2 ? 1.0f : -0.1f));
    const long double l = std::cbrt(0.4122214708L * c.r + 0.5363325363L * c.g + 0.0514459929L * c.b);
    const long double m = std::cbrt(0.2119034982L * c.r + 0.6806995451L * c.g + 0.1073969566L * c.b);
    const long double s = std::cbrt(0.0883024619L * c.r + 0.2817188376L * c.g + 0.6299787005L * c.b);
    const glm::vec3 lab = OklabFromLinear(c);
    if (c.b < 0.0f && c.r + c.g < 0.3f) continue;  // a cone's response near 0 has a root that is not smooth
    ASSERT_NEAR(lab.x, static_cast<double>(0.2104542553L * l + 0.7936177850L * m - 0.0040720468L * s), 5e-7);
    ASSERT_NEAR(lab.y, static_cast<double>(1.9779984951L * l - 2.4285922050L * m + 0.4505937099L * s), 2e-6);
    ASSERT_NEAR(lab.z, static_cast<double>(0.0259040371L * l + 0.7827717662L * m - 0.8086757660L * s), 2e-6);
    const glm::vec3 back = LinearFromOklab(lab);
    for (int k = 0; k < 3; ++k) ASSERT_NEAR(back[k], c[k], 4e-6);
  }
  EXPECT_EQ(OklabFromLinear(glm::vec3(0.0f)), glm::vec3(0.0f));
}

}  // namespace
}  // namespace scumble
