// Strokes of painted edges, on pixels whose guides are those of something else, under effects of single pixels.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <vector>

#include "core/image/color.h"
#include "tests/finish/finish_fixtures.h"

namespace scumble {
namespace {

using Texel = EdgeStroke::Texel;

constexpr Texel kStroke = {9000, 12000, 20000, 65535}, kWall = {50000, 40000, 30000, 65535};
constexpr int kOwner = 1, kBeside = 5;  // pixels of the row below

Texel At(const Picture& picture, int x) {
  Texel texel;
  std::copy_n(picture.At(x, 0), 4, texel.begin());
  return texel;
}

void Put(const Texel& texel, int x, Picture& picture) { std::copy_n(texel.begin(), 4, picture.At(x, 0)); }

Texel WithAlpha(Texel texel, double alpha) {
  texel[3] = static_cast<std::uint16_t>(alpha * 65535.0 + 0.5);
  return texel;
}

// Straight alpha, in linear light.
Texel Over(const Texel& front, const Texel& back) {
  const double of_front = front[3] / 65535.0, of_back = (1.0 - of_front) * back[3] / 65535.0;
  Texel mixed{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double sum = of_front * Srgb16ToLinear(front[c]) + of_back * Srgb16ToLinear(back[c]);
    mixed[c] = Srgb16FromLinear(static_cast<float>(sum / (of_front + of_back)));
  }
  return WithAlpha(mixed, of_front + of_back);
}

void ExpectNear(const Texel& made, const Texel& expected, const char* what) {
  for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(made[c], expected[c], 40) << what << ", channel " << c;
}

// A row of 8 pixels: object 1 at 2 m on the left half, then object 2 at 9 m, or background.
GuideSet RowGuides(bool has_wall) {
  GuideSet guides = GuidesOf(8, 1, [=](glm::vec2 at) {
    const bool is_near = at.x < 4.0f;
    return SeenPoint{is_near || has_wall, {0, 0, 1}, is_near ? 2.0f : 9.0f, is_near ? 1.0f : 2.0f};
  });
  for (const Layer layer : {Layer::kLuminance, Layer::kShadow, Layer::kAlbedo}) guides.Add(layer);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) guides.Plane(Layer::kShadow)[i] = i < 4 ? 1.0f : 0.0f;
  return guides;
}

// The owner's paint is that of the stroke, which lies on pixel kBeside.
struct Painted {
  GuideSet guides;
  Picture picture{8, 1};
  EdgeStrokes strokes;

  Painted(bool has_wall, double opacity) : guides(RowGuides(has_wall)) {
    const Texel beneath = has_wall ? kWall : Texel{}, own = WithAlpha(kStroke, opacity);
    for (int x = 0; x < 8; ++x) Put(x < 4 ? kStroke : beneath, x, picture);
    Put(has_wall ? Over(own, beneath) : own, kBeside, picture);
    strokes.push_back({kBeside, kOwner, own, beneath, At(picture, kBeside)});
  }

  Picture Made(const FinishStep& step, FinishPass::Stage stage = FinishPass::Stage::kPaint) const {
    FinishFrame frame{&guides, {1.0, 5.0, 9.0}, 1.0, 7};
    frame.strokes = strokes;
    Picture made = picture;
    EXPECT_TRUE(ApplyFinish(std::span(&step, 1), stage, frame, 0, {}, made));
    return made;
  }
};

DepthPass Haze() {
  DepthPass pass;
  pass.air = 0.6, pass.color = {60000, 62000, 65000};
  return pass;
}

FinishPass::Effect Lift() {
  GradePass pass;
  pass.lift = 0.4;
  return pass;
}

FinishPass::Effect BlackShade() {
  ShadowsPass pass;
  pass.mode = ShadowsPass::Mode::kBlack;
  return pass;
}

TEST(EdgeStrokes, OnBackgroundTheyChangeAsTheirOwnerDoes) {
  for (const double opacity : {1.0, 0.3}) {
    const Painted painted(false, opacity);
    for (const FinishPass::Effect& effect :
         {FinishPass::Effect(Haze()), Lift(), BlackShade(), FinishPass::Effect(ToonPass())}) {
      const Picture made = painted.Made(StepOf(effect));
      ASSERT_NE(At(made, kOwner), kStroke);
      EXPECT_EQ(At(made, kBeside), WithAlpha(At(made, kOwner), opacity)) << effect.index();
    }
  }
}

TEST(EdgeStrokes, OnAnotherObjectEachKeepsItsShareAndChangesByItsOwnGuides) {
  const Painted painted(true, 0.25);
  for (const FinishPass::Effect& effect : {FinishPass::Effect(Haze()), Lift(), BlackShade()}) {
    const Picture made = painted.Made(StepOf(effect));
    ExpectNear(At(made, kBeside), Over(WithAlpha(At(made, kOwner), 0.25), At(made, 7)), "mixed");
  }
}

// An effect that puts something else in the paint's place leaves no stroke before the wall.
TEST(EdgeStrokes, BeforeAnotherObjectTheyGoWithTheirPaint) {
  for (const double opacity : {1.0, 0.3}) {
    const Painted painted(true, opacity);
    FinishStep step = StepOf(ToonPass());
    Picture made = painted.Made(step);
    EXPECT_EQ(At(made, kBeside), At(made, 7));
    step.pass.strength = 0.5;  // some of the paint is left
    made = painted.Made(step);
    EXPECT_NE(At(made, kBeside), At(made, 7));
  }
}

TEST(EdgeStrokes, UnderAFilledSheetThereAreNone) {
  const Painted painted(false, 0.8);
  FillPass fill;
  fill.color = {60000, 50000, 40000};
  std::vector<FinishStep> steps = {StepOf(fill), StepOf(BlackShade())};
  for (FinishStep& step : steps) step.pass.at = FinishPass::Stage::kSheet;
  FinishFrame frame{&painted.guides, {1.0, 5.0, 9.0}, 1.0, 7};
  frame.strokes = painted.strokes;
  Picture made = painted.picture;
  ASSERT_TRUE(ApplyFinish(steps, FinishPass::Stage::kSheet, frame, 0, {}, made));
  EXPECT_EQ(At(made, kBeside), (Texel{60000, 50000, 40000, 65535}));
  steps[0].pass.strength = 0.5;
  made = painted.picture;
  ASSERT_TRUE(ApplyFinish(steps, FinishPass::Stage::kSheet, frame, 0, {}, made));
  EXPECT_NE(At(made, kBeside), At(made, 7));
}

TEST(EdgeStrokes, StepsForSomeObjectsAndMasksTakeThemWithTheirOwner) {
  for (const bool has_wall : {false, true}) {
    const Painted painted(has_wall, 0.6);
    const Texel own = WithAlpha(kStroke, 0.6), wall = has_wall ? kWall : Texel{};
    FinishStep step = StepOf(Lift());
    for (int x = 0; x < 8; ++x) step.only.push_back(x < 4);
    Picture made = painted.Made(step);
    ExpectNear(At(made, kBeside), Over(WithAlpha(At(made, kOwner), 0.6), wall), "the owner's");
    EXPECT_EQ(At(made, 7), wall);
    for (std::uint8_t& one : step.only) one = !one;
    made = painted.Made(step);
    ExpectNear(At(made, kBeside), Over(own, has_wall ? At(made, 7) : wall), "what lies behind");
    step.only.clear();
    for (int x = 0; x < 8; ++x) step.share.push_back(x < 4 ? 32768 : 0);
    made = painted.Made(step);
    ExpectNear(At(made, kBeside), Over(WithAlpha(At(made, kOwner), 0.6), wall), "masked");
  }
}

// Beneath a stroke that is opaque nothing shows of what a step does to the pixel's own surface.
TEST(EdgeStrokes, AnOpaqueOneKeepsItsBitsWhereTheStepIsForOthers) {
  const Painted painted(true, 1.0);
  FinishStep step = StepOf(ToonPass());
  for (int x = 0; x < 8; ++x) step.only.push_back(x >= 4);
  const Picture made = painted.Made(step);
  EXPECT_EQ(At(made, kBeside), kStroke);
  EXPECT_NE(At(made, 7), kWall);
}

// Neither on the other side of a silhouette, but the guides cover a part of the pixel alone.
TEST(EdgeStrokes, AtTheSilhouetteTheyAreNoBackground) {
  Painted painted(false, 0.8);
  painted.guides.Plane(Layer::kCoverage)[kOwner] = 0.25f;
  EdgeStroke& stroke = painted.strokes.front();
  stroke.pixel = kOwner, stroke.beneath = WithAlpha(kStroke, 0.25);
  stroke.mixed = Over(stroke.own, stroke.beneath);
  Put(stroke.mixed, kOwner, painted.picture);
  const Picture made = painted.Made(StepOf(Haze()));
  EXPECT_EQ(At(made, kOwner), WithAlpha(At(made, 2), stroke.mixed[3] / 65535.0));
}

// On the finished sheet, which is opaque, the rest of the pixel is paper: infinitely far.
TEST(EdgeStrokes, OnTheSheetTheyKeepTheirShareOfIt) {
  Painted painted(false, 0.6);
  const Texel paper = {61000, 60000, 50000, 65535};
  for (int x = 4; x < 8; ++x) Put(paper, x, painted.picture);
  Put(Over(painted.strokes.front().own, paper), kBeside, painted.picture);
  FinishStep step = StepOf(Haze());
  step.pass.at = FinishPass::Stage::kSheet;
  const Texel made = At(painted.Made(step, step.pass.at), kBeside);
  // What the stroke's pixel was mixed of is not known any more: both shares begin with its colour.
  Painted plain = painted;
  plain.strokes.clear();
  Put(At(painted.picture, kBeside), kOwner, plain.picture);
  const Picture parts = plain.Made(step, step.pass.at);
  ExpectNear(made, Over(WithAlpha(At(parts, kOwner), 0.6), At(parts, kBeside)), "haze");
}

// A pixel that shows two objects behind a stroke.
TEST(EdgeStrokes, WhatTheyLieOnMayBeSeveralSurfaces) {
  Painted painted(true, 0.5);
  GuideSet& guides = painted.guides;
  const auto fragments = std::make_shared<Fragments>();
  fragments->pixel = {kBeside};
  fragments->values = GuideSet(1, 1);
  for (const LayerInfo& info : AllLayers()) {
    if (guides.Has(info.layer)) fragments->values.Add(info.layer);
  }
  fragments->values.Plane(Layer::kCoverage)[0] = 0.4f, fragments->values.Plane(Layer::kObject)[0] = 3.0f;
  guides.Plane(Layer::kObject)[kBeside + 1] = 3.0f;  // whose paint is another
  guides.fragments = fragments;
  constexpr Texel kThird = {5000, 60000, 5000, 65535};
  Put(kThird, kBeside + 1, painted.picture);
  EdgeStroke& stroke = painted.strokes.front();
  stroke.beneath = Over(WithAlpha(kThird, 0.4), kWall);
  stroke.mixed = Over(stroke.own, stroke.beneath);
  Put(stroke.mixed, kBeside, painted.picture);
  const FragmentColors colors{{kThird}, {kWall}, {stroke.beneath}};
  FinishStep step = StepOf(Lift());
  for (int x = 0; x < 8; ++x) step.only.push_back(x == kBeside + 1);
  FinishFrame frame{&guides, {}, 1.0, 7};
  frame.strokes = painted.strokes, frame.colors = &colors;
  Picture made = painted.picture;
  ASSERT_TRUE(ApplyFinish(std::span(&step, 1), FinishPass::Stage::kPaint, frame, 0, {}, made));
  const Texel beneath = Over(WithAlpha(At(made, kBeside + 1), 0.4), kWall);
  ExpectNear(At(made, kBeside), Over(stroke.own, beneath), "the third object alone");
}

}  // namespace
}  // namespace scumble
