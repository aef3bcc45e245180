// Blur by depth: its second moment, what it leaves alone, and that nothing sharp runs into it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "core/image/color.h"
#include "core/image/fragments.h"
#include "core/image/oklab.h"
#include "tests/finish/finish_fixtures.h"

namespace scumble {
namespace {

FinishStep BlurStep(double blur) {
  DepthPass pass;
  pass.near = 1.0, pass.far = 5.0, pass.focus = 1.0, pass.desaturate = 0.0, pass.blur = blur;
  return StepOf(pass);
}

// A grey of linear lightness, as Oklab has it.
double LightnessOnRow(const Picture& picture, int x, int y) {
  const float linear = Srgb16ToLinear(picture.At(x, y)[0]);
  return OklabFromLinear(glm::vec3(linear)).x;
}

// A bright line on dark ground, all of it at 5 m: the line's profile is the filter.
TEST(DepthBlur, HasTheSigmaThatItsKeySays) {
  const GuideSet guides = FlatGuides(241, 64);
  for (const double blur : {0.5, 1.0, 2.5, 6.0, 13.0}) {
    Picture picture = PlainPicture(241, 64, 8000, 8000, 8000);
    for (int y = 0; y < 64; ++y) std::fill_n(picture.At(120, y), 3, std::uint16_t{60000});
    const Picture made = Finished(BlurStep(blur), &guides, picture);
    const double ground = LightnessOnRow(picture, 2, 32);
    double sum = 0.0, second = 0.0;
    for (int x = 0; x < 241; ++x) {
      const double over = LightnessOnRow(made, x, 32) - ground;
      sum += over, second += over * (x - 120.0) * (x - 120.0);
    }
    EXPECT_NEAR(std::sqrt(second / sum), blur, 0.02 * blur + 0.03) << blur;
    EXPECT_NEAR(sum, LightnessOnRow(picture, 120, 32) - ground, 0.02) << blur;
  }
}

// A near square on a far striped ground.
class NearAndFar : public ::testing::Test {
 protected:
  NearAndFar() {
    for (int y = 0; y < 80; ++y) {
      for (int x = 0; x < 80; ++x) {
        const bool near = IsNear(x, y);
        guides_.Plane(Layer::kDepth)[guides_.Index(x, y)] = near ? 1.0f : 5.0f;
        const std::uint16_t grey = near ? 65535 : x % 8 < 4 ? 10000 : 20000;
        std::fill_n(picture_.At(x, y), 3, grey);
      }
    }
  }
  static bool IsNear(int x, int y) { return x >= 30 && x < 50 && y >= 30 && y < 50; }
  GuideSet guides_ = FlatGuides(80, 80);
  Picture picture_ = PlainPicture(80, 80, 0, 0, 0);
};

TEST_F(NearAndFar, WhatIsInFocusKeepsItsBytesAndRunsNowhere) {
  const Picture made = Finished(BlurStep(6.0), &guides_, picture_);
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 80; ++x) {
      if (IsNear(x, y)) {
        EXPECT_EQ(made.At(x, y)[0], 65535);
      } else {
        EXPECT_LE(made.At(x, y)[0], 20100) << x << ' ' << y;
        EXPECT_GE(made.At(x, y)[0], 9900);
      }
    }
  }
  // The stripes are gone.
  EXPECT_NEAR(made.At(10, 10)[0], made.At(14, 10)[0], 400);
}

TEST_F(NearAndFar, WhatIsBeforeTheFocusIsBlurredToo) {
  FinishStep step = BlurStep(4.0);
  std::get<DepthPass>(step.pass.effect).focus = 5.0;
  for (int y = 30; y < 50; ++y) {
    for (int x = 30; x < 50; ++x) std::fill_n(picture_.At(x, y), 3, std::uint16_t(x < 40 ? 30000 : 50000));
  }
  const Picture made = Finished(step, &guides_, picture_);
  for (int x = 0; x < 80; ++x) EXPECT_EQ(made.At(x, 10)[0], picture_.At(x, 10)[0]);
  EXPECT_GT(made.At(38, 40)[0], 31000);
  EXPECT_LT(made.At(41, 40)[0], 49000);
}

TEST_F(NearAndFar, InfiniteDepthIsFar) {
  for (float& depth : guides_.Plane(Layer::kDepth)) {
    if (depth > 1.0f) depth = INFINITY;
  }
  const Picture made = Finished(BlurStep(6.0), &guides_, picture_);
  EXPECT_EQ(made.At(40, 40)[0], 65535);
  EXPECT_NEAR(made.At(10, 10)[0], made.At(14, 10)[0], 400);
}

// A light object on the left of clear background, with dark strokes of its edge on that.
class WithStrokes : public ::testing::Test {
 protected:
  Picture Blurred(float depth, int height = 40) {
    GuideSet guides = GuidesOf(60, height, [=](glm::vec2 at) {
      return at.x < 30.0f ? SeenPoint{true, {0, 0, 1}, depth, 1.0f} : SeenPoint{};
    });
    Picture picture = PlainPicture(60, height, 50000, 50000, 50000);
    EdgeStrokes strokes;
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      if (i % 60 < 30) continue;
      const EdgeStroke::Texel dark = {5000, 5000, 5000, 65535};
      const bool is_stroke = i % 60 < 32 && i / 60 % 4 < 2;
      std::fill_n(&picture.rgba[4 * i], 4, std::uint16_t{0});
      if (!is_stroke) continue;
      std::copy_n(dark.begin(), 4, &picture.rgba[4 * i]);
      strokes.push_back({std::uint32_t(i), std::uint32_t(i / 60 * 60 + 29), dark, {}, dark});
    }
    FinishFrame frame;
    frame.guides = &guides, frame.strokes = strokes;
    const FinishStep step = BlurStep(6.0);
    EXPECT_TRUE(ApplyFinish(std::span(&step, 1), FinishPass::Stage::kPaint, frame, 0, {}, picture));
    return picture;
  }
};

TEST_F(WithStrokes, TheyAreBlurredWithTheirObject) {
  const Picture made = Blurred(2.4f);
  EXPECT_GT(made.At(30, 20)[0], 20000);
  EXPECT_EQ(made.At(30, 20)[3], 65535) << "alpha stays";
}

TEST_F(WithStrokes, InFocusTheyKeepTheirBytes) {
  const Picture made = Blurred(1.0f);
  for (const int x : {30, 31}) EXPECT_EQ(made.At(x, 20)[0], 5000);
}

// A bright object whose border runs at a slant, at a depth, before a dark background: pixels have both by coverage.
struct SlantedObject {
  explicit SlantedObject(float depth)
      : guides(GuidesOf(60, 60,
                        [depth](glm::vec2 at) {
                          const bool is_left = at.x < 20.0f + 0.1f * at.y;
                          return is_left ? SeenPoint{true, {0, 0, 1}, depth, 1.0f} : SeenPoint{};
                        })),
        picture(PlainPicture(60, 60, 50000, 50000, 50000)) {
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      const float share = guides.Plane(Layer::kCoverage)[i];
      std::fill_n(&picture.rgba[4 * i], 3, static_cast<std::uint16_t>(10000.0f + 40000.0f * share));
    }
  }

  GuideSet guides;
  Picture picture;
};

// A blurred object at a slant before what is blurred more: each pixel has both, as far as they cover it.
TEST(DepthBlur, SilhouettesAreSmooth) {
  const SlantedObject object(1.6f);
  const Picture made = Finished(BlurStep(6.0), &object.guides, object.picture);
  // Along a column the border's lightness falls in steps of a tenth, not from the one side to the other at once.
  for (const int x : {22, 23, 24}) {
    double largest = 0.0;
    for (int y = 10; y < 58; ++y)
      largest = std::max(largest, std::fabs(LightnessOnRow(made, x, y + 1) - LightnessOnRow(made, x, y)));
    EXPECT_LT(largest, 0.08) << x;
  }
}

// Blur begins where focus ends: what is hardly out of it looks as in it, at its border too.
TEST(DepthBlur, NearTheFocusSilhouettesStay) {
  const SlantedObject object(1.0005f);
  const Picture made = Finished(BlurStep(6.0), &object.guides, object.picture);
  int mixed = 0;
  for (int y = 10; y < 50; ++y) {
    for (int x = 18; x < 28; ++x) {
      const float share = object.guides.Plane(Layer::kCoverage)[object.guides.Index(x, y)];
      if (!(share > 0.0f && share < 1.0f)) continue;
      EXPECT_NEAR(LightnessOnRow(made, x, y), LightnessOnRow(object.picture, x, y), 0.01) << x << " " << y;
      ++mixed;
    }
  }
  EXPECT_GT(mixed, 20);
}

}  // namespace
}  // namespace scumble
