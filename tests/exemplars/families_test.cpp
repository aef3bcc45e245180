// The paint program's families of lines, against the formula of a circle of latitude; and a stick that has one colour.
#include "exemplars/paint/engine/families.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "exemplars/paint/engine/media.h"
#include "exemplars/paint/sphere.h"

namespace scumble::paint {
namespace {

const glm::vec3 kAxis = glm::normalize(glm::vec3(-0.3f, 0.5f, 0.8f));

// Lines as a machine would draw them.
FamilyOptions Exact() {
  FamilyOptions options;
  options.spacing = 20.0f;
  options.unevenness = 0.0f;
  options.wander = 0.0f;
  options.drift = 0.0f;
  options.pressure = 0.0f;
  options.overhang = 0.0f;
  return options;
}

float Latitude(glm::vec2 at) { return std::acos(glm::clamp(glm::dot(kAxis, NormalAt(at)), -1.0f, 1.0f)); }

Touch Full() {
  return [](glm::vec2) { return 1.0f; };
}

TEST(Families, LinesAreCirclesOfLatitudeAtEvenDistances) {
  Chance chance(7, 3);
  const std::vector<Stroke> strokes = PlanFamily(chance, kAxis, Full(), Exact());
  ASSERT_GT(strokes.size(), 40u);
  std::vector<float> latitudes;
  for (const Stroke& stroke : strokes) {
    const float latitude = Latitude(stroke[stroke.size() / 2].at);
    latitudes.push_back(latitude);
    for (const StrokePoint& point : stroke) {
      if (RimDistance(point.at) > 0.97f) continue;  // there single precision leaves little of the depth
      ASSERT_NEAR(Latitude(point.at), latitude, 1e-3f) << point.at.x << ", " << point.at.y;
    }
  }
  std::sort(latitudes.begin(), latitudes.end());
  const float step = 20.0f / kRadius;
  for (const float latitude : latitudes) {
    const float steps = (latitude - latitudes.front()) / step;
    EXPECT_NEAR(steps, std::round(steps), 0.1f) << latitude;
  }
}

// Seen across the lines, no two neighbours come nearer than the thinning allows, and tone does not pile up at the rim.
TEST(Families, LinesDoNotCrowdTowardsTheRim) {
  Chance chance(7, 3);
  FamilyOptions options = Exact();
  options.length_min = options.length_max = 4000.0f;  // no ends but those of the lines
  float most = 0.0f;
  constexpr int kBands = 8;
  std::vector<float> length(kBands, 0.0f);
  for (const Stroke& stroke : PlanFamily(chance, kAxis, Full(), options)) {
    for (std::size_t i = 1; i < stroke.size(); ++i) {
      const float rim = RimDistance(stroke[i].at);
      const int band = static_cast<int>(rim * rim * kBands);  // bands of equal area
      if (band < kBands) length[static_cast<std::size_t>(band)] += glm::distance(stroke[i].at, stroke[i - 1].at);
    }
  }
  const float area = 3.14159265f * kRadius * kRadius / kBands;
  for (const float sum : length) {
    const float density = sum * options.spacing / area;  // 1: as on the sphere
    EXPECT_GT(density, 0.45f);
    most = std::max(most, density);
  }
  EXPECT_LT(most, 1.25f);
}

TEST(Families, SwellingFollowsTheDarknessWanted) {
  SwellingHand hand;
  hand.ragged = 0.0f;
  hand.family = Exact();
  hand.family.taper = 1e-3f;
  const Touch darkness = [](glm::vec2 at) { return at.x / kSide; };
  const Swelling swelling{kAxis, 20.0f, 0.4f, 0.8f, 0.1f, 0.7f};
  float heaviest = 0.0f;
  for (const Stroke& stroke : PlanSwelling(1, 2, darkness, swelling, hand)) {
    for (const StrokePoint& point : stroke) {
      EXPECT_GE(point.at.x, 0.4f * kSide);
      const float most = glm::mix(0.1f, 0.7f, Ramp(0.4f, 0.8f, point.at.x / kSide));
      EXPECT_LE(point.pressure, most + 1e-4f);
      heaviest = std::max(heaviest, point.pressure);
    }
  }
  EXPECT_GT(heaviest, 0.65f);
}

TEST(Families, DotsStandOnlyWhereTheyAreWanted) {
  Chance chance(5, 1);
  const Touch left = [](glm::vec2 at) { return at.x < 300.0f ? 1.0f : 0.0f; };
  const std::vector<Stroke> dots = PlanDots(chance, AroundAxis(kAxis), left, {.spacing = 20.0f, .length_max = 9.0f});
  const double cells = (300.0 + 24.0) * (kSide + 48.0) / (20.0 * 20.0);
  EXPECT_NEAR(static_cast<double>(dots.size()), cells, 0.1 * cells);
  for (const Stroke& dot : dots) {
    EXPECT_LT(dot[1].at.x, 300.0f);
    EXPECT_LE(glm::distance(dot.front().at, dot.back().at), 9.001f);
  }
}

TEST(DryMediaStick, FaintStrokesKeepTheSticksColour) {
  const Sheet sheet{4};
  const glm::vec3 stick{0.5f, 0.1f, 0.05f};
  Layer layer(sheet, glm::vec4(1.0f, 1.0f, 1.0f, 3.0f) / 32768.0f);  // three of 15 bits, and their colour is lost
  const Field tooth(sheet, 1.0f);
  Colors own(sheet, glm::vec3(1.0f));
  Colors named = own;
  DryMedia media;
  RubInto(own, layer, tooth, media);
  media.stick = stick;
  RubInto(named, layer, tooth, media);
  const auto hue = [](glm::vec3 color) { return (1.0f - color.g) / (1.0f - color.r); };
  EXPECT_NEAR(hue(own.At(1, 1)), 1.0f, 0.05f);
  EXPECT_NEAR(hue(named.At(1, 1)), (1.0f - stick.g) / (1.0f - stick.r), 0.05f);
}

}  // namespace
}  // namespace scumble::paint
