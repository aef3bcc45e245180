// Outlines against formulas: where strokes run, how wide they are, and what they leave alone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/finish/outline/outline_fixtures.h"

namespace scumble {
namespace {

// A stroke around a centre: its area, and the ink-weighted mean and the deviation of its radius, by direction.
struct Ring {
  double area = 0.0, radius = 0.0, deviation = 0.0;
};
Ring RingOf(const std::vector<double>& ink, int width, glm::dvec2 centre) {
  constexpr int kSectors = 180;
  std::vector<double> weight(kSectors), weighted(kSectors);
  Ring ring;
  for (std::size_t i = 0; i < ink.size(); ++i) {
    const glm::dvec2 at =
        glm::dvec2(double(i % std::size_t(width)) + 0.5, double(i / std::size_t(width)) + 0.5) - centre;
    const double angle = std::atan2(at.y, at.x) / (2.0 * std::numbers::pi) + 0.5;
    const auto sector = std::min<std::size_t>(kSectors - 1, std::size_t(angle * kSectors));
    weight[sector] += ink[i], weighted[sector] += ink[i] * glm::length(at);
    ring.area += ink[i];
  }
  double sum = 0.0, squares = 0.0;
  for (int s = 0; s < kSectors; ++s) {
    const double radius = weighted[std::size_t(s)] / weight[std::size_t(s)];
    sum += radius, squares += radius * radius;
  }
  ring.radius = sum / kSectors;
  ring.deviation = std::sqrt(std::max(0.0, squares / kSectors - ring.radius * ring.radius));
  return ring;
}

TEST(Outline, StrokeOfABallIsARing) {
  for (const double width : {1.0, 2.5, 6.0}) {
    OutlinePass pass;
    pass.width = width;
    const GuideSet guides = BallGuides(220, 80.0f);
    const Ring ring = RingOf(InkOf(pass, guides), 220, {110, 110});
    EXPECT_NEAR(ring.radius, 80.0, 0.1) << width;
    EXPECT_LT(ring.deviation, 0.15) << width;
    EXPECT_NEAR(ring.area / (2.0 * std::numbers::pi * 80.0 * width), 1.0, 0.02) << width;
  }
}

// Without subsamples a silhouette is only known to half a pixel.
TEST(Outline, HardCoverageGivesASmoothRingToo) {
  GuideSet guides = GuidesOf(220, 220, [](glm::vec2 at) {
    const glm::vec2 centre = glm::floor(at) + glm::vec2(0.5f);
    return SeenOnBall(centre, {110, 110}, 80.0f, 5.0f, 1.0f);
  });
  const Ring ring = RingOf(InkOf({}, guides), 220, {110, 110});
  EXPECT_NEAR(ring.radius, 80.0, 0.1);
  EXPECT_LT(ring.deviation, 0.25);
}

// Guides of a third of the size, in blocks: traced there, lines are as smooth and as wide as elsewhere.
TEST(Outline, OfUpsampledGuidesHasNoBlocks) {
  const GuideSet small = BallGuides(110, 40.0f);
  GuideSet large(330, 330);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject}) {
    large.Add(layer);
    for (int c = 0; c < ChannelCount(layer); ++c) {
      for (int i = 0; i < 330 * 330; ++i) {
        large.Plane(layer, c)[std::size_t(i)] = small.Plane(layer, c)[small.Index(i % 330 / 3, i / 330 / 3)];
      }
    }
  }
  FinishStep step = StepOf(OutlinePass());
  FinishFrame frame{&large, {}, 2.0, 8};
  frame.small_guides = &small;
  const auto draw = [&] {
    Picture picture(330, 330);
    EXPECT_TRUE(ApplyFinish(std::span(&step, 1), FinishPass::Stage::kPaint, frame, 0, {}, picture));
    std::vector<double> ink;
    for (std::size_t i = 3; i < picture.rgba.size(); i += 4) ink.push_back(picture.rgba[i] / 65535.0);
    return ink;
  };
  const Ring ring = RingOf(draw(), 330, {165, 165});
  EXPECT_NEAR(ring.radius, 120.0, 0.3);
  EXPECT_LT(ring.deviation, 0.3);
  EXPECT_NEAR(ring.area / (2.0 * std::numbers::pi * 120.0 * 5.0), 1.0, 0.02);
  frame.small_guides = nullptr;
  EXPECT_GT(RingOf(draw(), 330, {165, 165}).deviation, 0.5) << "the blocks";
  // The right half alone, and that at half the strength.
  frame.small_guides = &small;
  step.only.resize(330 * 330), step.share.resize(330 * 330);
  for (std::size_t i = 0; i < step.only.size(); ++i) step.only[i] = i % 330 >= 165, step.share[i] = 32768;
  const std::vector<double> half = draw();
  double left = 0.0, area = 0.0;
  for (std::size_t i = 0; i < half.size(); ++i) (i % 330 < 159 ? left : area) += half[i];
  EXPECT_EQ(left, 0.0);
  EXPECT_NEAR(area / (std::numbers::pi * 120.0 * 2.5), 1.0, 0.05);
}

// Two boxes side by side, of which only one's lines are wanted: those of the other leave no hole in them.
TEST(Outline, MaskedLinesHideNoOthers) {
  constexpr int kSide = 120;
  for (const bool wants_left : {true, false}) {
    GuideSet guides(kSide, kSide);
    for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject, Layer::kMaterial}) {
      guides.Add(layer);
    }
    FinishStep step;
    OutlinePass pass;
    pass.width = 12.0;
    step.pass.effect = pass;
    step.share.assign(guides.pixel_count(), 0);
    for (int y = 20; y < 100; ++y) {
      for (int x = 20; x < 100; ++x) {
        const std::size_t i = guides.Index(x, y);
        const bool is_left = x < 60;
        guides.Plane(Layer::kCoverage)[i] = 1.0f, guides.Plane(Layer::kNormal, 2)[i] = 1.0f;
        guides.Plane(Layer::kDepth)[i] = is_left == wants_left ? 2.0f : 1.0f;
        guides.Plane(Layer::kObject)[i] = is_left ? 1.0f : 2.0f;
        step.share[i] = is_left == wants_left ? 65535 : 0;
      }
    }
    FinishFrame frame;
    frame.guides = &guides;
    Picture picture(kSide, kSide);
    ASSERT_TRUE(ApplyFinish(std::span(&step, 1), FinishPass::Stage::kPaint, frame, 0, {}, picture));
    const int first = wants_left ? 26 : 61;
    for (const int edge : {20, 100}) {
      for (int y = edge - 4; y < edge + 4; ++y) {
        for (int x = first; x < first + 33; ++x) EXPECT_EQ(picture.At(x, y)[3], 65535) << x << ' ' << y;
      }
    }
    EXPECT_EQ(picture.At(wants_left ? 80 : 40, 20)[3], 0) << "the other box";
  }
}

TEST(Outline, ThinnerThanAPixelIsFainter) {
  OutlinePass pass;
  pass.width = 0.4, pass.min_width = 0.0;
  const Ring ring = RingOf(InkOf(pass, BallGuides(220, 80.0f)), 220, {110, 110});
  EXPECT_NEAR(ring.area / (2.0 * std::numbers::pi * 80.0 * 0.4), 1.0, 0.05);
}

// Half a pixel of the stroke lies beyond the border, where pixels are mixed.
TEST(Outline, SideMovesTheStroke) {
  OutlinePass pass;
  pass.width = 6.0;
  const GuideSet guides = BallGuides(220, 80.0f);
  pass.side = OutlinePass::Side::kInside;
  EXPECT_NEAR(RingOf(InkOf(pass, guides), 220, {110, 110}).radius, 77.5, 0.15);
  pass.side = OutlinePass::Side::kOutside;
  EXPECT_NEAR(RingOf(InkOf(pass, guides), 220, {110, 110}).radius, 82.5, 0.15);
}

TEST(Outline, LengthsFollowThePictureHeight) {
  const GuideSet guides = BallGuides(220, 80.0f);
  const FinishStep step = StepOf(OutlinePass());
  const Picture drawn = Finished(step, &guides, Picture(220, 220), {}, 0, 2.0);
  double area = 0.0;
  for (std::size_t i = 3; i < drawn.rgba.size(); i += 4) area += drawn.rgba[i] / 65535.0;
  EXPECT_NEAR(area / (2.0 * std::numbers::pi * 80.0 * 5.0), 1.0, 0.02);
}

// Depth that a slope explains is no step.
TEST(Outline, SteepPlaneHasNoInnerLine) {
  const double slope = std::tan(85.0 * std::numbers::pi / 180.0) * 0.01;
  const GuideSet guides = GuidesOf(120, 80, [&](glm::vec2 at) {
    return SeenPoint{true, {0.0f, 0.99619f, 0.08716f}, static_cast<float>(20.0 - slope * at.y), 1.0f};
  });
  EXPECT_EQ(Sum(InkOf({}, guides)), 0.0);
}

// A line between two things ends behind a nearer one, whose own line goes straight on.
TEST(Outline, ContoursKeepTheirSideWhereLinesEndBehindThem) {
  const GuideSet guides = GuidesOf(120, 80, [](glm::vec2 at) {
    if (at.y > 40.0f) return SeenPoint{true, {0, 0, 1}, 3.0f, 1.0f};
    return at.x < 60.0f ? SeenPoint{true, {0, 0, 1}, 5.0f, 2.0f} : SeenPoint{true, {0, 0, 1}, 7.0f, 3.0f};
  });
  OutlinePass pass;
  pass.width = 8.0, pass.side = OutlinePass::Side::kInside;
  const std::vector<double> ink = InkOf(pass, guides);
  const auto at = [&](int x, int y) { return ink[std::size_t(y * 120 + x)]; };
  for (int x = 0; x < 120; ++x) {
    EXPECT_NEAR(at(x, 46), 1.0, 0.01) << x;
    EXPECT_NEAR(at(x, 48), 0.0, 0.01) << x;
    if (x < 52 || x > 61) {
      EXPECT_NEAR(at(x, 38), 0.0, 0.01) << x;
    }
  }
  for (int y = 0; y < 39; ++y) {
    EXPECT_NEAR(at(54, y), 1.0, 0.01) << y;
    EXPECT_NEAR(at(61, y), 0.0, 0.01) << y;
  }
  // Outside, a line that ends there does not stick out into the nearer thing.
  pass.side = OutlinePass::Side::kOutside;
  const std::vector<double> outside = InkOf(pass, guides);
  for (int y = 42; y < 80; ++y) {
    for (int x = 0; x < 120; ++x) EXPECT_NEAR(outside[std::size_t(y * 120 + x)], 0.0, 0.01) << x << ' ' << y;
  }
}

// The nearer of two overlapping things has the line, whatever lies behind.
TEST(Outline, StepInDepthIsALineOfTheNearerSide) {
  GuideSet guides = GuidesOf(120, 80, [](glm::vec2 at) {
    return SeenPoint{true, {0, 0, 1}, at.x < 60.0f ? 5.0f : 9.0f, 1.0f};
  });
  OutlinePass pass;
  pass.width = 4.0, pass.side = OutlinePass::Side::kInside;
  const std::vector<double> ink = InkOf(pass, guides);
  EXPECT_NEAR(ink[40 * 120 + 57], 1.0, 1e-3);
  EXPECT_EQ(ink[40 * 120 + 61], 0.0);
  EXPECT_NEAR(Sum(ink) / 80.0, 4.0, 0.1);
}

TEST(Outline, LinesGetThinnerWithDistance) {
  GuideSet guides = GuidesOf(360, 180, [](glm::vec2 at) {
    const SeenPoint near = SeenOnBall(at, {90, 90}, 60.0f, 4.1f, 1.0f);
    return near.hit ? near : SeenOnBall(at, {270, 90}, 60.0f, 8.1f, 2.0f);
  });
  OutlinePass pass;
  pass.width = 4.0, pass.thin = 1.0, pass.thin_at = 4.1;
  const std::vector<double> ink = InkOf(pass, guides);
  double left = 0.0, right = 0.0;
  for (std::size_t i = 0; i < ink.size(); ++i) (i % 360 < 180 ? left : right) += ink[i];
  EXPECT_NEAR(left / right, 8.1 / 4.1, 0.05 * 8.1 / 4.1);
}

TEST(Outline, LinesGetThinnerInLight) {
  GuideSet guides = BallGuides(220, 80.0f);
  guides.Add(Layer::kLuminance);
  OutlinePass pass;
  pass.width = 4.0, pass.light = 1.0;
  const double dark = Sum(InkOf(pass, guides));
  for (float& value : guides.Plane(Layer::kLuminance)) value = 1.0f;
  EXPECT_NEAR(dark / Sum(InkOf(pass, guides)), 3.0, 0.1);  // 1.5 against 0.5
}

// The contour of half shade lies between pixels where the shadow says.
TEST(Outline, ShadowsHaveAContour) {
  GuideSet guides = FlatGuides(120, 80);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    const double x = double(i % 120) + 0.5;
    guides.Plane(Layer::kShadow)[i] = static_cast<float>(std::clamp((x - 60.2) / 8.0 + 0.5, 0.0, 1.0));
  }
  OutlinePass pass;
  pass.width = 3.0;
  pass.of_class[std::size_t(LineClass::kShadow)] = 1.0;
  const std::vector<double> ink = InkOf(pass, guides);
  double mean = 0.0, weight = 0.0;
  for (int x = 0; x < 120; ++x) {
    mean += ink[40 * 120 + std::size_t(x)] * (x + 0.5), weight += ink[40 * 120 + std::size_t(x)];
  }
  EXPECT_NEAR(mean / weight, 60.2, 0.02);
  EXPECT_NEAR(weight, 3.0, 0.02);
}

// A shadow smaller than three widths of its line has none, but where that joins another line.
TEST(Outline, CrumbsOfShadowHaveNoLine) {
  OutlinePass pass;
  pass.width = 3.0;
  for (double& width : pass.of_class) width = 0.0;
  pass.of_class[std::size_t(LineClass::kShadow)] = 1.0;
  const auto ink_of = [&](double radius, bool joins) {
    GuideSet guides = FlatGuides(120, 80);
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      const glm::dvec2 at(double(i % 120) + 0.5, double(i / 120) + 0.5);
      const double away = radius - glm::length(at - glm::dvec2(60.2, 40.3));
      guides.Plane(Layer::kShadow)[i] = static_cast<float>(std::clamp(away + 0.5, 0.0, 1.0));
      if (joins) guides.Plane(Layer::kObject)[i] = at.x < 60.0 ? 1.0f : 2.0f;
    }
    return Sum(InkOf(pass, guides));
  };
  for (const auto form : {OutlinePass::Form::kStrokes, OutlinePass::Form::kField}) {
    pass.form = form;
    pass.of_class[std::size_t(LineClass::kObject)] = 0.0;
    const double give = form == OutlinePass::Form::kField ? 0.4 : 0.1;  // a field is wider along slanting borders
    for (const double radius : {2.0, 3.0, 4.0}) EXPECT_EQ(ink_of(radius, false), 0.0) << radius;
    for (const double radius : {6.0, 12.0, 30.0})
      EXPECT_NEAR(ink_of(radius, false) / (2.0 * std::numbers::pi * radius * 3.0), 1.0, give) << radius;
    pass.of_class[std::size_t(LineClass::kObject)] = 1.0;
    EXPECT_GT(ink_of(4.0, true), ink_of(0.0, true) + 30.0);
  }
}

TEST(Outline, MaterialsAndBaseColoursHaveBorders) {
  GuideSet guides = FlatGuides(120, 80);
  guides.Add(Layer::kMaterial), guides.Add(Layer::kAlbedo);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    guides.Plane(Layer::kMaterial)[i] = i % 120 < 40 ? 1.0f : 2.0f;
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kAlbedo, c)[i] = i % 120 < 80 ? 0.2f : 0.5f;
  }
  OutlinePass pass;
  pass.width = 3.0;
  EXPECT_EQ(Sum(InkOf(pass, guides)), 0.0) << "both are off";
  pass.of_class[std::size_t(LineClass::kMaterial)] = 1.0;
  const std::vector<double> material = InkOf(pass, guides);
  EXPECT_NEAR(material[40 * 120 + 40], 1.0, 1e-3);
  EXPECT_EQ(material[40 * 120 + 80], 0.0);
  pass.of_class[std::size_t(LineClass::kTexture)] = 1.0;
  EXPECT_NEAR(InkOf(pass, guides)[40 * 120 + 80], 1.0, 1e-3);
  pass.texture_step = 0.5;
  EXPECT_EQ(InkOf(pass, guides)[40 * 120 + 80], 0.0);
}

TEST(Outline, EndsTaper) {
  // A step in depth that ends in the middle of a surface.
  GuideSet guides = GuidesOf(160, 80, [](glm::vec2 at) {
    const float step = std::clamp((60.0f - at.y) / 20.0f, 0.0f, 1.0f);
    return SeenPoint{true, {0, 0, 1}, at.x < 80.0f ? 5.0f : 5.0f + 2.0f * step, 1.0f};
  });
  OutlinePass pass;
  pass.width = 6.0, pass.taper = 40.0;
  const std::vector<double> ink = InkOf(pass, guides);
  const auto width_at = [&](int y) {
    double sum = 0.0;
    for (int x = 60; x < 100; ++x) sum += ink[std::size_t(y) * 160 + std::size_t(x)];
    return sum;
  };
  EXPECT_NEAR(width_at(2), 6.0, 0.1) << "the picture's edge is no end";
  EXPECT_GT(width_at(30), width_at(50));
  EXPECT_GT(width_at(50), width_at(58));
}

TEST(Outline, WobbleStaysWithinItsReach) {
  OutlinePass pass;
  pass.width = 2.0, pass.wobble = 5.0;
  const GuideSet guides = BallGuides(240, 80.0f);
  const std::vector<double> ink = InkOf(pass, guides);
  double deviation = 0.0;
  for (std::size_t i = 0; i < ink.size(); ++i) {
    if (ink[i] == 0.0) continue;
    const double radius = glm::length(glm::dvec2(double(i % 240) + 0.5, double(i / 240) + 0.5) - glm::dvec2(120));
    EXPECT_LT(std::fabs(radius - 80.0), 5.0 * std::numbers::sqrt2 + 2.5);
    deviation = std::max(deviation, std::fabs(radius - 80.0));
  }
  EXPECT_GT(deviation, 3.0);
}

TEST(Outline, SpeckOfNoiseIsNoLine) {
  GuideSet guides = FlatGuides(60, 60);
  guides.Plane(Layer::kObject)[30 * 60 + 30] = 9.0f;
  EXPECT_EQ(Sum(InkOf({}, guides)), 0.0);
  for (const int y : {29, 30, 31}) {
    for (const int x : {29, 30, 31}) guides.Plane(Layer::kObject)[std::size_t(y) * 60 + std::size_t(x)] = 9.0f;
  }
  EXPECT_GT(Sum(InkOf({}, guides)), 10.0);
}

TEST(Outline, InkLiesOverPaintAndRaisesAlphaOutside) {
  const GuideSet guides = BallGuides(100, 30.0f);
  Picture picture = PlainPicture(100, 100, 60000, 30000, 10000);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i)
    picture.rgba[4 * i + 3] = static_cast<std::uint16_t>(guides.Plane(Layer::kCoverage)[i] * 65535.0f);
  OutlinePass pass;
  pass.ink = {0, 0, 0};
  const Picture drawn = Finished(StepOf(pass), &guides, picture);
  EXPECT_EQ(drawn.At(50, 50)[0], 60000);
  EXPECT_LT(drawn.At(50, 20)[0], 3000) << "on the line";
  EXPECT_GT(drawn.At(50, 19)[3], 40000) << "outside";
  EXPECT_EQ(drawn.At(50, 10)[3], 0);
}

TEST(Outline, InkOfThePaintIsItsColourDarkerOrOpposite) {
  const GuideSet guides = BallGuides(100, 30.0f);
  const Picture picture = PlainPicture(100, 100, 50000, 20000, 20000);
  OutlinePass pass;
  pass.width = 4.0, pass.color = OutlinePass::Color::kPaint;
  const Picture paint = Finished(StepOf(pass), &guides, picture);
  EXPECT_GT(paint.At(50, 20)[0], 2 * paint.At(50, 20)[2]);
  EXPECT_LT(paint.At(50, 20)[0], 25000);
  pass.color = OutlinePass::Color::kComplement;
  const Picture complement = Finished(StepOf(pass), &guides, picture);
  EXPECT_GT(complement.At(50, 20)[2], complement.At(50, 20)[0]);
}

// A wavy wall on a floor, which faces the viewer now less than the floor and now more, and hangs `away` before it at
// the right.
constexpr int kSide = 120;
bool IsWall(glm::vec2 at) { return at.y < 30.0f + 0.37f * at.x; }
GuideSet WallOnFloor(float away) {
  return GuidesOf(kSide, kSide, [away](glm::vec2 at) {
    const float below = at.y - 30.0f - 0.37f * at.x, facing = IsWall(at) ? 0.8f + 0.05f * std::sin(at.x) : 0.8f;
    const float hangs = IsWall(at) && at.x > 90.0f ? away : 0.0f;
    return SeenPoint{true,
                     {0.0f, std::sqrt(1.0f - facing * facing), facing},
                     5.0f - hangs - 0.02f * std::fabs(below),
                     IsWall(at) ? 1.0f : 2.0f};
  });
}
OutlinePass LinesBetweenObjects() {
  OutlinePass pass;
  pass.width = 4.0;
  for (const LineClass line : {LineClass::kOcclusion, LineClass::kCrease}) pass.of_class[std::size_t(line)] = 0.0;
  return pass;
}

class OutlineForm : public ::testing::TestWithParam<OutlinePass::Form> {};
INSTANTIATE_TEST_SUITE_P(Either, OutlineForm,
                         ::testing::Values(OutlinePass::Form::kStrokes, OutlinePass::Form::kField));

// The wall is red, the floor green. Their line has paint of one of them, and where the wall hangs before the floor,
// that decides.
TEST_P(OutlineForm, HasPaintOfOneOfTwoObjectsAlongTheirLine) {
  for (const float away : {0.0f, 0.1f, -0.1f}) {
    const GuideSet guides = WallOnFloor(away);
    Picture picture = PlainPicture(kSide, kSide, 60000, 5000, 5000);
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      if (guides.Plane(Layer::kObject)[i] == 2.0f) std::swap(picture.rgba[4 * i], picture.rgba[4 * i + 1]);
      const auto x = static_cast<float>(i % kSide), y = static_cast<float>(i / kSide);
      const bool is_mixed =
          IsWall({x, y}) != IsWall({x + 1.0f, y + 1.0f}) || IsWall({x + 1.0f, y}) != IsWall({x, y + 1.0f});
      if (is_mixed) picture.rgba[4 * i] = picture.rgba[4 * i + 1] = i % 2 == 0 ? 20000 : 50000;
    }
    OutlinePass pass = LinesBetweenObjects();
    pass.color = OutlinePass::Color::kPaint, pass.form = GetParam();
    const Picture drawn = Finished(StepOf(pass), &guides, picture);
    int red = 0, green = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
      const std::uint16_t* const texel = drawn.At(i % kSide, i / kSide);
      const double below = double(i / kSide) - 29.5 - 0.37 * (double(i % kSide) + 0.5);
      if (std::fabs(below) < 1.0) ++(texel[0] > texel[1] ? red : green);  // all ink
    }
    EXPECT_GT(red + green, 200);
    EXPECT_EQ(std::min(red, green), 0) << away << ' ' << red << ' ' << green;
    if (away != 0.0f) {
      EXPECT_EQ(red > green, away > 0.0f) << away;
    }
  }
}

// The line may not be all the other's.
TEST(Outline, UnderAMaskOfEitherObjectTheirLineHasParts) {
  const GuideSet guides = WallOnFloor(0.0f);
  for (const float object : {1.0f, 2.0f}) {
    FinishStep step = StepOf(LinesBetweenObjects());
    for (const float of : guides.Plane(Layer::kObject)) step.share.push_back(of == object ? 65535 : 0);
    const Picture drawn = Finished(step, &guides, Picture(kSide, kSide));
    double ink = 0.0;
    for (std::size_t i = 3; i < drawn.rgba.size(); i += 4) ink += drawn.rgba[i] / 65535.0;
    EXPECT_GT(ink, 50.0) << object;
  }
}

TEST(Outline, ThreadsAndSeedsMatterNotAndDo) {
  const GuideSet guides = BallGuides(220, 80.0f);
  OutlinePass pass;
  pass.wobble = 3.0, pass.taper = 20.0;
  const Picture one = Finished(StepOf(pass), &guides, Picture(220, 220), {}, 1);
  EXPECT_EQ(one.rgba, Finished(StepOf(pass), &guides, Picture(220, 220), {}, 4).rgba);
  Picture other(220, 220);
  const FinishStep step = StepOf(pass);
  ASSERT_TRUE(ApplyFinish(std::span(&step, 1), FinishPass::Stage::kPaint, {&guides, {}, 1.0, 8}, 0, {}, other));
  EXPECT_NE(one.rgba, other.rgba);
}

TEST(Outline, OnlyDrawsBordersOfItsPixels) {
  const GuideSet guides = GuidesOf(240, 120, [](glm::vec2 at) {
    const SeenPoint left = SeenOnBall(at, {60, 60}, 40.0f, 4.0f, 1.0f);
    return left.hit ? left : SeenOnBall(at, {180, 60}, 40.0f, 4.0f, 2.0f);
  });
  FinishStep step = StepOf(OutlinePass());
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) step.only.push_back(i % 240 < 120);
  const Picture drawn = Finished(step, &guides, Picture(240, 120));
  double left = 0.0, right = 0.0;
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) (i % 240 < 120 ? left : right) += drawn.rgba[4 * i + 3];
  EXPECT_GT(left, 0.0);
  EXPECT_EQ(right, 0.0);
}

// A wall on a floor, which meet in a line that crosses rows of pixels: that is the wall's, wherever it crosses them.
// The wall behind the floor's edge has none.
TEST(Outline, OfOneObjectGoesOnWhereItStandsOnAnother) {
  for (const bool stands : {true, false}) {
    const GuideSet guides = GuidesOf(160, 80, [&](glm::vec2 at) {
      const float below = at.y - 25.3f - 0.17f * at.x;
      if (below < 0.0f) return SeenPoint{true, {0.9f, 0.0f, 0.436f}, stands ? 20.0f : 24.0f, 1.0f};
      return SeenPoint{true, {0.0f, 0.98f, 0.2f}, 20.0f - 0.3f * below, 2.0f};
    });
    FinishStep step = StepOf(OutlinePass());
    for (const float object : guides.Plane(Layer::kObject)) step.only.push_back(object == 1.0f);
    const Picture drawn = Finished(step, &guides, Picture(160, 80));
    for (int x = 5; x < 155; ++x) {
      double ink = 0.0;
      for (int y = 0; y < 80; ++y) ink += drawn.At(x, y)[3] / 65535.0;
      EXPECT_NEAR(ink, stands ? 2.5 : 0.0, 0.2) << x;
    }
  }
}

TEST(Outline, SmallestPictures) {
  EXPECT_EQ(InkOf({}, FlatGuides(1, 1)), std::vector<double>{0.0});
  EXPECT_EQ(Sum(InkOf({}, BallGuides(3, 0.4f))), 0.0) << "a speck";
  GuideSet empty(16, 16);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject}) empty.Add(layer);
  EXPECT_EQ(Sum(InkOf({}, empty)), 0.0);
}

}  // namespace
}  // namespace scumble
