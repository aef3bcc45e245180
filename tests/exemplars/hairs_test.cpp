// The hairs of the paint program's ink brush: their paths, and the effect of wet, dry and one-sided ink.
#include "exemplars/paint/engine/hairs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace scumble::paint {
namespace {

// Level, from left to right, 400 units long.
Stroke Path(float pressure) {
  Stroke path;
  for (int i = 0; i <= 100; ++i) path.push_back({{100.0f + 4.0f * static_cast<float>(i), 500.0f}, pressure});
  return path;
}

std::vector<Stroke> Hairs(const Tuft& tuft, float pressure = 1.0f) {
  Chance chance(3, 1);
  return PartIntoHairs(chance, Path(pressure), tuft);
}

// Ink laid down: length times pressure, above the path and below it.
struct Ink {
  float above = 0.0f;
  float below = 0.0f;
};
Ink Laid(const std::vector<Stroke>& hairs) {
  Ink ink;
  for (const Stroke& hair : hairs) {
    for (const StrokePoint& point : hair) (point.at.y < 500.0f ? ink.above : ink.below) += 4.0f * point.pressure;
  }
  return ink;
}

float Widest(const std::vector<Stroke>& hairs) {
  float widest = 0.0f;
  for (const Stroke& hair : hairs) {
    for (const StrokePoint& point : hair) widest = std::max(widest, std::fabs(point.at.y - 500.0f));
  }
  return widest;
}

TEST(Hairs, AWetTuftLaysOneUnbrokenHairBesideTheOther) {
  const Tuft tuft{.width = 60.0f, .hair = 2.0f, .gap = 1.5f, .ink = 0.5f};
  const std::vector<Stroke> hairs = Hairs(tuft);
  EXPECT_EQ(hairs.size(), 20u);  // 60 / (1.5 · 2)
  for (const Stroke& hair : hairs) {
    // Round ends: the outer ones are shorter, by half of the width at most, at each end.
    EXPECT_GT(hair.size(), 75u);
    for (const StrokePoint& point : hair) {
      EXPECT_GE(point.pressure, 0.0f);
      EXPECT_LE(point.pressure, 1.0f);
    }
  }
  EXPECT_GT(Widest(hairs), 27.0f);
  EXPECT_LT(Widest(hairs), 33.0f);
}

TEST(Hairs, PressureFansThem) {
  const Tuft tuft{.width = 60.0f, .hair = 2.0f, .narrowest = 0.25f};
  EXPECT_NEAR(Widest(Hairs(tuft, 0.0f)), 0.25f * Widest(Hairs(tuft, 1.0f)), 0.1f);
}

TEST(Hairs, TheDrierTheLessInk) {
  float before = 1e9f;
  for (const float dryness : {0.0f, 0.4f, 0.8f, 1.0f}) {
    const Ink ink = Laid(Hairs({.width = 60.0f, .hair = 1.0f, .dryness = dryness}));
    EXPECT_LT(ink.above + ink.below, 0.9f * before) << dryness;
    before = ink.above + ink.below;
  }
  EXPECT_GT(before, 0.0f);
}

TEST(Hairs, OneSideHoldsMoreInk) {
  const Ink even = Laid(Hairs({.width = 60.0f, .hair = 1.0f, .ink = 0.4f}));
  EXPECT_NEAR(even.above / even.below, 1.0f, 0.1f);
  const Ink dipped = Laid(Hairs({.width = 60.0f, .hair = 1.0f, .ink = 0.4f, .side = 0.5f}));
  // Hairs on that side have 1 + side/2 of the ink on average, the others 1 − side/2. The round ends shift it a little.
  const float ratio = dipped.below / dipped.above;
  EXPECT_NEAR(ratio, 1.25f / 0.75f, 0.25f);
}

TEST(Hairs, APathOfThreePointsLeavesNoMark) {
  Chance chance(3, 1);
  Stroke path = Path(1.0f);
  path.resize(3);
  EXPECT_TRUE(PartIntoHairs(chance, path, {.width = 60.0f, .hair = 1.0f}).empty());
}

}  // namespace
}  // namespace scumble::paint
