// Light without the noise of its samples, and what cuts it into steps.
#include "finish/area/even_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "tests/finish/finish_fixtures.h"
#include "tests/support/every_instruction_set.h"

namespace scumble {
namespace {

using internal::EvenedLight, internal::FloatPlane, internal::kLightNoise;

constexpr int kWide = 64, kHigh = 40;

template <class Value>
FloatPlane PlaneOf(const Value& value) {
  FloatPlane plane(std::size_t(kWide) * kHigh);
  for (int y = 0; y < kHigh; ++y) {
    for (int x = 0; x < kWide; ++x) plane[std::size_t(y) * kWide + std::size_t(x)] = value(x, y);
  }
  return plane;
}
const FloatPlane kOneObject = PlaneOf([](int, int) { return 1.0f; });

TEST(EvenLight, SlopesKeepTheirValuesUpToTheBorder) {
  const FloatPlane slope =
      PlaneOf([](int x, int y) { return 0.0078125f * static_cast<float>(x) + 0.00390625f * float(y); });
  const FloatPlane halves = PlaneOf([](int x, int y) { return x + y < 50 ? 1.0f : 2.0f; });
  for (const FloatPlane* object : {&kOneObject, &halves})
    EXPECT_EQ(EvenedLight(slope, {*object}, kWide, kHigh, kLightNoise), slope);
}

TEST(EvenLight, StepsStaySharp) {
  const FloatPlane step = PlaneOf([](int x, int) { return x < 30 ? 0.25f : 0.5f; });
  EXPECT_EQ(EvenedLight(step, {kOneObject}, kWide, kHigh, kLightNoise), step);
}

TEST(EvenLight, ObjectsAreNotMixed) {
  const auto faint = [](int x, int y) { return (x * 7 + y * 3) % 11 < 5; };
  const FloatPlane light = PlaneOf([&](int x, int y) { return faint(x, y) ? 0.25f : 0.26f; });
  const FloatPlane object = PlaneOf([&](int x, int y) { return faint(x, y) ? 1.0f : 2.0f; });
  EXPECT_EQ(EvenedLight(light, {object}, kWide, kHigh, kLightNoise), light);
}

TEST(EvenLight, NoiseFallsToAFewHundredths) {
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0.0f, 0.012f);
  const FloatPlane light = PlaneOf([&](int x, int) { return 0.5f + 0.004f * static_cast<float>(x) + noise(random); });
  const FloatPlane even = EvenedLight(light, {kOneObject}, kWide, kHigh, kLightNoise);
  double squares = 0.0, count = 0.0;
  for (int y = 16; y < kHigh - 16; ++y) {
    for (int x = 16; x < kWide - 16; ++x) {
      const double error = even[std::size_t(y) * kWide + std::size_t(x)] - (0.5 + 0.004 * x);
      squares += error * error, count += 1.0;
    }
  }
  EXPECT_LT(std::sqrt(squares / count), 0.012 / 30.0) << "samples of pixels that overlap, and some beyond the range";
}

// A wall that gets darker by a hundredth of a percent a row, under the noise of a sky: the border of two tones wanders
// by few rows, and has no comb of single pixels.
TEST(EvenLight, BordersOnFaintSlopesAreClean) {
  std::mt19937 random(4);
  std::normal_distribution<float> noise(0.0f, 0.006f);
  constexpr int kSide = 160;
  constexpr float kSlope = 1e-4f;
  FloatPlane light(std::size_t(kSide) * kSide);
  for (std::size_t i = 0; i < light.size(); ++i)
    light[i] = 0.5f - kSlope * static_cast<float>(i / kSide) + noise(random);
  const FloatPlane object(light.size(), 1.0f);
  const FloatPlane even = EvenedLight(light, {object}, kSide, kSide, kLightNoise);
  const float border = 0.5f - kSlope * kSide / 2.0f;
  double wandering = 0.0, comb = 0.0;
  for (int x = 32; x < kSide - 32; ++x) {
    const auto rows_above = [&](int column) {
      int rows = 0;
      for (int y = 0; y < kSide; ++y) rows += even[std::size_t(y) * kSide + std::size_t(column)] > border ? 1 : 0;
      return rows;
    };
    wandering = std::max(wandering, std::abs(rows_above(x) - kSide / 2.0));
    comb = std::max(comb, std::abs(double(rows_above(x)) - rows_above(x + 1)));
  }
  EXPECT_LT(wandering, 6.0);
  EXPECT_LE(comb, 2.0);
}

// The two sides of a crease differ by less than the range; normals tell them apart.
TEST(EvenLight, CreasesStaySharp) {
  const auto on_left = [](int x) { return x < 30; };
  const FloatPlane light = PlaneOf([&](int x, int) { return on_left(x) ? 0.5f : 0.47f; });
  const FloatPlane normal_x = PlaneOf([&](int x, int) { return on_left(x) ? 0.0f : 0.7f; });
  const FloatPlane normal_y = PlaneOf([](int, int) { return 0.0f; });
  EXPECT_EQ(EvenedLight(light, {kOneObject, normal_x, normal_y}, kWide, kHigh, kLightNoise), light);
  EXPECT_NE(EvenedLight(light, {kOneObject}, kWide, kHigh, kLightNoise), light);
}

// Noise on two objects of several normals, and what its mirror image gives.
TEST(EvenLight, MirroredAndOnEveryInstructionSetTheSame) {
  std::mt19937 random(5);
  std::normal_distribution<float> noise(0.0f, 0.02f);
  const auto mirrored = [](const FloatPlane& plane, float sign) {
    return PlaneOf([&](int x, int y) { return sign * plane[std::size_t(y) * kWide + std::size_t(kWide - 1 - x)]; });
  };
  const FloatPlane light = PlaneOf([&](int x, int) { return 0.4f + 0.002f * float(x) + noise(random); });
  const FloatPlane object = PlaneOf([](int x, int y) { return x + y < 50 ? 1.0f : 2.0f; });
  const FloatPlane normal_x = PlaneOf([](int x, int) { return 0.03f * float(x) - 0.9f; });
  const FloatPlane normal_y = PlaneOf([](int, int y) { return 0.01f * float(y); });
  const FloatPlane even = EvenedLight(light, {object, normal_x, normal_y}, kWide, kHigh, kLightNoise);
  const FloatPlane other_object = mirrored(object, 1.0f), other_x = mirrored(normal_x, -1.0f),
                   other_y = mirrored(normal_y, 1.0f);
  EXPECT_EQ(
      mirrored(EvenedLight(mirrored(light, 1.0f), {other_object, other_x, other_y}, kWide, kHigh, kLightNoise), 1.0f),
      even);
  testing::OnEveryInstructionSet([&] {
    EXPECT_EQ(EvenedLight(light, {object, normal_x, normal_y}, kWide, kHigh, kLightNoise), even);
  });
}

// Known noise that is larger widens the range; what is no error does not.
TEST(EvenLight, RangeFollowsTheKnownNoise) {
  GuideSet guides(1, 1);
  EXPECT_EQ(internal::LightNoiseOf(guides), kLightNoise);
  const std::pair<const char*, float> kRanges[] = {{"0.006", kLightNoise}, {"0.04", 0.12f},      {"0.9", 0.25f},
                                                   {"-1", kLightNoise},    {"nan", kLightNoise}, {"4 %", kLightNoise}};
  for (const auto& [text, range] : kRanges) {
    guides.attributes[kLightErrorKey] = text;
    EXPECT_FLOAT_EQ(internal::LightNoiseOf(guides), range) << text;
  }
}

// Islands of two pixels do not change their places.
TEST(EvenLight, FewPixelsByThemselvesStay) {
  FloatPlane object = kOneObject, light = PlaneOf([](int, int) { return 0.5f; });
  const std::size_t at = 20 * kWide + 20;
  object[at] = object[at + 1] = 2.0f, light[at] = 0.9f, light[at + 1] = 0.1f;
  EXPECT_EQ(EvenedLight(light, {object}, kWide, kHigh, kLightNoise), light);
}

// Samples that lie three pixels apart, between which light was interpolated.
TEST(EvenLight, ReachesAsFarAsSamplesLieApart) {
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0.0f, 0.012f);
  FloatPlane small(std::size_t(kWide) * kHigh);
  for (float& value : small) value = 0.5f + noise(random);
  const FloatPlane light =
      PlaneOf([&](int x, int y) { return small[std::size_t(y / 3) * kWide + std::size_t(x / 3)]; });
  const auto spread = [](const FloatPlane& plane) {
    double squares = 0.0;
    for (const float value : plane) squares += (value - 0.5) * (value - 0.5);
    return std::sqrt(squares / double(plane.size()));
  };
  EXPECT_LT(spread(EvenedLight(light, {kOneObject}, kWide, kHigh, kLightNoise, 3)), 0.5 * spread(light));
}

TEST(EvenLight, WhatIsNoNumberStaysAlone) {
  FloatPlane light = PlaneOf([](int, int) { return 0.5f; });
  const std::size_t at = 20 * kWide + 20;
  light[at] = std::numeric_limits<float>::quiet_NaN();
  const FloatPlane even = EvenedLight(light, {kOneObject}, kWide, kHigh, kLightNoise);
  EXPECT_TRUE(std::isnan(even[at]));
  for (std::size_t i = 0; i < even.size(); ++i) {
    if (i != at) {
      ASSERT_EQ(even[i], 0.5f);
    }
  }
}

TEST(EvenLight, SpecksAreTakenForWhatIsAround) {
  const FloatPlane even = PlaneOf([](int, int) { return 0.5f; });
  FloatPlane light = even;
  light[20 * kWide + 20] = 1.0f, light[30 * kWide + 63] = 0.0f;
  const FloatPlane made = EvenedLight(light, {kOneObject}, kWide, kHigh, kLightNoise);
  for (std::size_t i = 0; i < made.size(); ++i) ASSERT_NEAR(made[i], 0.5f, 0.02f) << i;
}

TEST(EvenLight, OfOnePixelAndOfNone) {
  EXPECT_EQ(EvenedLight(FloatPlane{0.3f}, {FloatPlane{1.0f}}, 1, 1, kLightNoise), FloatPlane{0.3f});
  EXPECT_TRUE(EvenedLight({}, {}, 0, 0, kLightNoise).empty());
}

// A soft shadow across the picture with as much noise as guides have: one border of two tones, and no specks.
TEST(EvenLight, BandsOfANoisyShadowHaveNoSpecks) {
  std::mt19937 random(2);
  std::normal_distribution<float> noise(0.0f, 0.012f);
  GuideSet guides = FlatGuides(160, 60);
  guides.Add(Layer::kAlbedo);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kLuminance)[i] = 0.1f + 0.005f * static_cast<float>(i % 160) + noise(random);
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kAlbedo, c)[i] = 0.5f;
  }
  ToonPass pass;
  pass.bands = 2, pass.softness = 0.0;
  const Picture made = Finished(StepOf(pass), &guides, PlainPicture(160, 60, 9, 9, 9));
  for (int y = 0; y < 60; ++y) {
    int borders = 0;
    for (int x = 1; x < 160; ++x) borders += made.At(x, y)[0] != made.At(x - 1, y)[0];
    EXPECT_EQ(borders, 1) << y;
  }
}

TEST(EvenLight, ExactLightIsCutAsItIs) {
  GuideSet guides = FlatGuides(40, 30);
  guides.Add(Layer::kAlbedo);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kLuminance)[i] = i % 3 == 0 ? 0.49f : 0.51f;
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kAlbedo, c)[i] = 0.5f;
  }
  ToonPass pass;
  pass.bands = 2, pass.softness = 0.0;
  const auto steps = [&] {
    const Picture made = Finished(StepOf(pass), &guides, PlainPicture(40, 30, 9, 9, 9));
    int count = 0;
    for (int x = 1; x < 40; ++x) count += made.At(x, 15)[0] != made.At(x - 1, 15)[0];
    return count;
  };
  EXPECT_EQ(steps(), 0);
  guides.attributes[kLightKey] = kExactLight;
  EXPECT_GT(steps(), 20);
}

}  // namespace
}  // namespace scumble
