// The colouring hand against the formulas in its header.
#include "exemplars/paint/engine/colouring.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "exemplars/paint/sphere.h"

namespace scumble::paint {
namespace {

constexpr glm::vec2 kMiddle{512.0f, 512.0f};
constexpr glm::vec3 kGrey{0.5f, 0.5f, 0.5f};
constexpr Hand kHand{.lightest = 0.2f, .heaviest = 0.8f, .least = 0.05f};

Ground Plain(glm::vec3 color, float tooth = 0.5f, int size = 128) {
  return {Field(Sheet{size}, tooth), Colors(Sheet{size}, color)};
}

TargetColors Everywhere(glm::vec3 color) {
  return MakeTargetColors([=](glm::vec2) { return color; });
}

float PressureOn(glm::vec3 ground, glm::vec3 wanted, const Stick& stick, const Hand& hand = kHand) {
  return Colouring(Plain(ground)).Nearer(Everywhere(wanted), stick, hand)(kMiddle);
}

TEST(Colouring, ChalkIsPressedByTheShareThatBringsTheColourNearest) {
  const Stick red{{1.0f, 0.3f, 0.2f}};
  const glm::vec3 wanted{0.7f, 0.5f, 0.35f};
  // Mixing t of red into grey is nearest to the wanted colour at this t.
  float best = 0.0f;
  float least = 10.0f;
  for (int i = 0; i <= 10000; ++i) {
    const float t = static_cast<float>(i) / 10000.0f;
    const float distance = glm::distance(glm::mix(kGrey, red.color, t), wanted);
    if (distance < least) {
      least = distance;
      best = t;
    }
  }
  EXPECT_NEAR(PressureOn(kGrey, wanted, red), glm::mix(0.2f, 0.8f, best), 1e-3f);
}

TEST(Colouring, WaxShinesThrough) {
  const Stick blue{{0.4f, 0.5f, 0.9f}, true};
  // Half of the glaze's absorption is half of the way.
  const glm::vec3 wanted = 0.5f * kGrey + 0.5f * kGrey * blue.color;
  EXPECT_NEAR(PressureOn(kGrey, wanted, blue), 0.5f, 1e-3f);
  EXPECT_EQ(PressureOn(kGrey, glm::vec3(0.9f), blue), 0.0f) << "a glaze never lightens";
  EXPECT_GT(PressureOn(kGrey, glm::vec3(0.9f), {glm::vec3(1.0f), false}), 0.0f) << "chalk does";
}

TEST(Colouring, TheHandStaysAwayWhereAStickDoesNotHelp) {
  const Stick white{glm::vec3(1.0f)};
  EXPECT_EQ(PressureOn(kGrey, kGrey, white), 0.0f) << "nothing is missing";
  EXPECT_EQ(PressureOn(kGrey, kGrey * 0.5f, white), 0.0f) << "it would lead away";
  EXPECT_EQ(PressureOn(kGrey, kGrey + 0.02f, white), 0.0f) << "by less than `least`";
  EXPECT_GT(PressureOn(kGrey, kGrey + 0.04f, white), 0.0f);
  Hand near = kHand;
  near.reach = 0.5f;
  EXPECT_EQ(PressureOn(kGrey, glm::vec3(0.7f), white, near), 0.0f) << "white is 0.52 from what is wanted";
  EXPECT_GT(PressureOn(kGrey, glm::vec3(0.72f), white, near), 0.0f);
  const Touch touch = Colouring(Plain(kGrey)).Nearer(Everywhere(glm::vec3(1.0f)), white, kHand);
  EXPECT_GT(touch(kMiddle + glm::vec2(kRadius, 0.0f)), 0.0f) << "up to the rim";
  EXPECT_EQ(touch(kMiddle + glm::vec2(kHand.overhang + 0.001f) * kRadius), 0.0f) << "and a little further";
}

TEST(Colouring, ChalkCoversAndWaxMultiplies) {
  const Stick chalk{{0.9f, 0.6f, 0.3f}};
  const Stick wax{{0.9f, 0.6f, 0.3f}, true};
  const Settling full{.media = {.bite = 0.0f}};
  Layer layer{Sheet{128}};
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 64; ++x) layer.At(x, y) = glm::vec4(chalk.color, 1.0f);
  }
  Colouring covered(Plain(kGrey)), glazed(Plain(kGrey));
  for (int coat = 1; coat <= 2; ++coat) {
    covered.Settle(layer, chalk, full);
    glazed.Settle(layer, wax, full);
    const glm::vec3 expected = kGrey * glm::pow(wax.color, glm::vec3(static_cast<float>(coat)));
    EXPECT_LT(glm::distance(covered.picture().At(10, 10), chalk.color), 1e-5f);
    EXPECT_LT(glm::distance(glazed.picture().At(10, 10), expected), 1e-5f) << coat;
    EXPECT_EQ(glazed.picture().At(100, 10), kGrey) << "nothing was painted there";
  }
}

TEST(Colouring, LightlyLoadedSticksLeaveTheHollowsBareAndCrumbsMoveThem) {
  const Stick chalk{glm::vec3(1.0f)};
  Layer layer(Sheet{128}, glm::vec4(1.0f));
  Ground ground = PrepareGround({128}, {Tooth::kFine, 40.0f, kGrey}, 1);
  const Field tooth = ground.tooth;
  const Settling grainy{.media = {.bite = 0.9f, .softness = 0.1f}, .load = 0.5f};
  Colouring drawing(ground);
  drawing.Settle(layer, chalk, grainy);
  float peaks = 0.0f, hollows = 1.0f;
  for (std::size_t i = 0; i < tooth.pixels.size(); ++i) {
    const float value = drawing.picture().pixels[i].x;
    if (tooth.pixels[i] > 0.8f) peaks = std::max(peaks, value);
    if (tooth.pixels[i] < 0.2f) hollows = std::min(hollows, value);
  }
  EXPECT_GT(peaks, hollows + 0.2f);

  Colouring same(ground), other(ground);
  same.Settle(layer, chalk, grainy);
  EXPECT_EQ(same.picture().pixels, drawing.picture().pixels);
  Settling crumbly = grainy;
  crumbly.crumble = 0.5f;
  other.Settle(layer, chalk, crumbly);
  EXPECT_NE(other.picture().pixels, drawing.picture().pixels);
}

TEST(Colouring, FacetsLieAcrossTheStickAndDabsAreLeftOut) {
  Stroke line, dab;
  for (int i = 0; i <= 20; ++i) line.push_back({{100.0f + 4.0f * static_cast<float>(i), 200.0f}, 0.5f});
  dab.assign(line.begin(), line.begin() + 6);
  Chance chance(1, 2);
  const auto lines = Facets(chance, {line, dab}, 20.0f, 5, 40.0f);
  ASSERT_EQ(lines.size(), 5u) << "the dab is 20 units long";
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const float across = (static_cast<float>(k) + 0.5f) / 5.0f * 20.0f - 10.0f;
    EXPECT_GE(lines[k].size() + 5, line.size());
    for (const StrokePoint& point : lines[k]) {
      EXPECT_NEAR(point.at.y - 200.0f, across, 3.5f * 1.6f) << k;
      EXPECT_GE(point.pressure, 0.0f);
      EXPECT_LE(point.pressure, 1.0f);
    }
  }
}

TEST(Colouring, StrokesDoNotCurlRoundAPole) {
  const glm::vec3 axis = glm::normalize(glm::vec3(-0.6f, 0.5f, 0.4f));
  const Touch touch = AwayFromPoles([](glm::vec2) { return 0.7f; }, axis);
  EXPECT_EQ(touch(PlaceOf(axis)), 0.0f);
  const glm::vec3 aside = glm::normalize(glm::cross(axis, glm::vec3(0, 1, 0)));
  EXPECT_EQ(touch(PlaceOf(aside.z < 0.0f ? -aside : aside)), 0.7f);
}

TEST(Colouring, AWishIsAskedWhereItWasMade) {
  const TargetColors target_colors = MakeTargetColors([](glm::vec2 at) { return glm::vec3(at / kSide, 0.25f); });
  for (const glm::vec2 at : {glm::vec2(3.0f, 1000.0f), glm::vec2(512.0f, 100.0f)}) {
    EXPECT_LT(glm::distance(ColorIn(target_colors, at), glm::vec3(at / kSide, 0.25f)), 0.004f);
  }
  EXPECT_EQ(ColorIn(target_colors, {-50.0f, 2000.0f}), ColorIn(target_colors, {0.0f, 1023.0f}))
      << "past the edge it goes on";
}

}  // namespace
}  // namespace scumble::paint
