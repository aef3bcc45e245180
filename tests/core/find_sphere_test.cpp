// Spheres that do not fill their picture are found where they were drawn, and nothing else is taken for one.
#include "core/painting/find_sphere.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/image/hash.h"
#include "core/painting/soft_edge.h"
#include "tests/support/painted_spheres.h"

namespace scumble {
namespace {

using Kind = FoundSphere::Kind;

// A ball drawn into a larger picture: its place and radius in pixels, on a grey ground or on nothing.
struct Ball {
  double x = 0, y = 0, radius = 0;
  double squash = 1.0;                                               // height by width
  std::function<double(double)> reach = [](double) { return 1.0; };  // of the paint by angle, in radii
};

Picture Sheet(int width, int height, double grey) {
  Picture sheet(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      SetGrey(sheet, x, y, std::max(0.0, grey));
      if (grey < 0.0) sheet.At(x, y)[3] = 0;
    }
  }
  return sheet;
}

// Pixels of the edge are mixed by their share, over paper or into alpha.
void Draw(Picture& sheet, const Ball& ball, double soft = 0.5) {
  const bool clear = sheet.At(0, 0)[3] == 0;
  for (int y = 0; y < sheet.height; ++y) {
    for (int x = 0; x < sheet.width; ++x) {
      const double u = (x + 0.5 - ball.x) / ball.radius, v = (y + 0.5 - ball.y) / ball.radius / ball.squash;
      const double r = std::hypot(u, v), edge = ball.reach(std::atan2(v, u));
      const double share = std::clamp(0.5 + (edge - r) * ball.radius / (2.0 * soft), 0.0, 1.0);
      if (!(share > 0.0)) continue;
      const double lit = std::max(0.0, -0.5 * u - 0.5 * v + std::sqrt(std::max(0.0, 1.0 - r * r)) * 0.7);
      const double paint = 0.15 + 0.6 * lit + 0.05 * (UnitFloat(Hash(x / 2, y / 2)) - 0.5);
      const double below = sheet.At(x, y)[0] / 65535.0;
      SetGrey(sheet, x, y, clear ? paint : share * paint + (1.0 - share) * below);
      if (clear) sheet.At(x, y)[3] = static_cast<std::uint16_t>(65535.0 * share + 0.5);
    }
  }
}

Picture Drawn(int width, int height, double grey, const std::vector<Ball>& balls, double soft = 0.5) {
  Picture sheet = Sheet(width, height, grey);
  for (const Ball& ball : balls) Draw(sheet, ball, soft);
  return sheet;
}

constexpr double kWhite = 1.0, kNothing = -1.0;

void ExpectFound(const Picture& picture, const Ball& ball, double within) {
  const FoundSphere found = FindSphere(picture);
  ASSERT_EQ(found.kind, Kind::kInside) << static_cast<int>(found.kind);
  EXPECT_NEAR(found.circle.x, ball.x, within);
  EXPECT_NEAR(found.circle.y, ball.y, within);
  EXPECT_NEAR(found.circle.radius, ball.radius - 1.0, within) << "where the edge is paint all over";
}

TEST(FindSphere, SmallerOrAsideOnPaperAndOnNothing) {
  for (const double ground : {kWhite, 0.5, 0.0, kNothing}) {
    for (const Ball& ball : {Ball{256, 256, 200}, {150.3, 341.7, 120.5}, {256, 256, 245}, {400, 90, 60}}) {
      SCOPED_TRACE(std::to_string(ground) + " " + std::to_string(ball.x));
      ExpectFound(Drawn(512, 512, ground, {ball}), ball, 1.5);
    }
  }
}

TEST(FindSphere, PicturesOfAnyShape) {
  ExpectFound(Drawn(640, 360, kWhite, {{300, 180, 150}}), {300, 180, 150}, 1.5);
  ExpectFound(Drawn(300, 800, kNothing, {{150, 500, 140}}), {150, 500, 140}, 1.5);
  EXPECT_EQ(FindSphere(Sheet(640, 360, kWhite)).kind, Kind::kUnclear);
  EXPECT_EQ(FindSphere(Sheet(360, 360, kWhite)).kind, Kind::kFills) << "nothing lies anywhere else";
  Picture noise(300, 200);
  for (int i = 0; i < 300 * 200; ++i) SetGrey(noise, i % 300, i / 300, UnitFloat(Hash(i)));
  EXPECT_EQ(FindSphere(noise).kind, Kind::kNoGround);
}

// Cropped by hand, a picture is a pixel more one way than the other, and no ground shows where the sphere meets it.
TEST(FindSphere, CroppedToTheSphereButNoSquare) {
  for (const auto& [width, height] : {std::pair{222, 221}, {90, 89}, {60, 64}}) {
    for (const double ground : {kWhite, kNothing}) {
      SCOPED_TRACE(std::to_string(width) + " " + std::to_string(ground));
      const Ball ball{0.5 * width, 0.5 * height, 0.5 * std::min(width, height)};
      ExpectFound(Drawn(width, height, ground, {ball}), ball, 1.5);
    }
  }
  // What only nearly fills it is no sphere for that.
  Ball blob{50, 49, 49};
  blob.reach = [](double angle) { return 1.0 - 0.1 * (0.5 - 0.5 * std::cos(4.0 * angle)); };
  EXPECT_EQ(FindSphere(Drawn(100, 98, kNothing, {blob})).kind, Kind::kUnclear);
  EXPECT_EQ(FindSphere(Drawn(100, 90, kNothing, {{50, 45, 54}})).kind, Kind::kUnclear) << "cut off on all sides";
}

// The rougher the outline, the smaller a sphere has to be.
TEST(FindSphere, UnevenOutlines) {
  Ball rough{250, 270, 170};
  rough.reach = [](double angle) { return 1.0 + 0.012 * std::sin(9 * angle) + 0.012 * std::sin(23 * angle + 1); };
  ExpectFound(Drawn(512, 512, kWhite, {rough}), rough, 6.0);
  Ball bitten{256, 256, 180};  // an eighth of the outline is the ground's own colour
  bitten.reach = [](double angle) { return std::fabs(angle + 2.0) < std::numbers::pi / 8 ? 0.7 : 1.0; };
  ExpectFound(Drawn(512, 512, kNothing, {bitten}), bitten, 2.0);
}

TEST(FindSphere, SignaturesDoNotMatter) {
  Picture sheet = Drawn(512, 512, kWhite, {{230, 230, 180}});
  for (int y = 460; y < 480; ++y) {
    for (int x = 380; x < 490; ++x) {
      if (Hash(x / 3, y / 3) % 2) SetGrey(sheet, x, y, 0.1);
    }
  }
  ExpectFound(sheet, {230, 230, 180}, 1.5);
}

// A hand that cuts along a circle strays from it slowly: random harmonics, which make it an ellipse of some 1% too.
Ball CutByHand(int seed) {
  Ball ball{256, 250, 190};
  ball.reach = [seed](double angle) {
    double reach = 1.0;
    for (int k = 2; k < 14; ++k) {
      const double strength = 0.008 * (UnitFloat(Hash(seed, k)) - 0.5);
      reach += strength * std::sin(k * angle + 6.28 * UnitFloat(Hash(seed, k, 1)));
    }
    return reach;
  };
  return ball;
}

TEST(FindSphere, CirclesThatAreCutOutByHandAreNoEllipses) {
  for (int seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE(seed);
    const Ball ball = CutByHand(seed);
    ExpectFound(Drawn(512, 512, seed % 2 ? kWhite : kNothing, {ball}), ball, 4.0);
  }
}

// 460 × 440 is taken for an ellipse, even if it is cut out by hand; 454 × 446 is a circle to any brush.
TEST(FindSphere, EllipsesFromThreePerCentOn) {
  for (const auto& [squash, kind] : {std::pair{440.0 / 460, Kind::kEllipse},
                                     {0.962, Kind::kEllipse},
                                     {0.98, Kind::kInside},
                                     {446.0 / 454, Kind::kInside}}) {
    for (const double ground : {kWhite, kNothing}) {
      Ball ball{256, 250, 225};
      ball.squash = squash;
      const FoundSphere found = FindSphere(Drawn(512, 512, ground, {ball}));
      EXPECT_EQ(found.kind, kind) << squash;
      if (kind != Kind::kEllipse) continue;
      EXPECT_NEAR(found.longer, 450, 3);
      EXPECT_NEAR(found.shorter, 450 * squash, 3);
    }
  }
  for (int seed = 0; seed < 4; ++seed) {
    Ball ball = CutByHand(seed);
    ball.squash = 440.0 / 460;
    EXPECT_EQ(FindSphere(Drawn(512, 512, kWhite, {ball})).kind, Kind::kEllipse) << seed;
  }
}

// An ellipse on the ground below the ball, darkest in its middle; on transparency its strength is its alpha.
void AddShadow(Picture& sheet, const Ball& ball, double strength) {
  const Picture bare = sheet;
  const bool clear = bare.At(0, 0)[3] == 0;
  for (int y = 0; y < sheet.height; ++y) {
    for (int x = 0; x < sheet.width; ++x) {
      const double u = (x + 0.5 - ball.x - 0.1 * ball.radius) / (1.1 * ball.radius);
      const double v = (y + 0.5 - ball.y - ball.radius) / (0.3 * ball.radius);
      const double by = strength * std::clamp(1.6 * (1.0 - std::hypot(u, v)), 0.0, 1.0);
      if (!(by > 0.0)) continue;
      if (clear) {
        SetGrey(sheet, x, y, 0.0), sheet.At(x, y)[3] = static_cast<std::uint16_t>(65535.0 * by);
      } else {
        SetGrey(sheet, x, y, bare.At(x, y)[0] / 65535.0 * (1.0 - by));
      }
    }
  }
}

TEST(FindSphere, AShadowBelowTheBallIsNamed) {
  for (const double ground : {kWhite, 0.6, kNothing}) {
    for (const auto& [width, height] : {std::pair{512, 512}, {720, 480}}) {
      for (const double strength : {0.45, 0.9}) {
        SCOPED_TRACE(std::to_string(ground) + " " + std::to_string(width) + " " + std::to_string(strength));
        const Ball ball{0.5 * width, 0.45 * height, 0.33 * height};
        Picture sheet = Sheet(width, height, ground);
        AddShadow(sheet, ball, ground < 0.0 ? 0.9 : strength);
        Draw(sheet, ball);
        const FoundSphere found = FindSphere(sheet);
        ASSERT_EQ(found.kind, Kind::kUnclear);
        EXPECT_EQ(found.doubt, SphereDoubt::kShadow);
        EXPECT_NEAR(found.circle.x, ball.x, 4);
        EXPECT_NEAR(found.circle.y, ball.y, 4);
      }
    }
  }
  // Other things beside a ball are none: another ball, a bar, a ball above.
  EXPECT_EQ(FindSphere(Drawn(512, 512, kWhite, {{180, 256, 120}, {330, 256, 120}})).doubt, SphereDoubt::kNoCircle);
  EXPECT_EQ(FindSphere(Drawn(512, 512, kWhite, {{256, 180, 120}, {256, 330, 120}})).doubt, SphereDoubt::kNoCircle);
  Picture bar = Drawn(640, 480, kWhite, {{250, 240, 150}});
  for (int y = 200; y < 280; ++y) {
    for (int x = 300; x < 600; ++x) SetGrey(bar, x, y, 0.3);
  }
  EXPECT_EQ(FindSphere(bar).doubt, SphereDoubt::kNoCircle);
}

TEST(FindSphere, UnevenGroundIsNamed) {
  int named = 0;
  for (const double fall : {0.25, 0.35, 0.5, 0.7}) {
    Picture sheet = Drawn(720, 480, 0.9, {{360, 240, 150}});
    Overlay(sheet, [&](double x, double y) { return 1.0 - fall * (0.7 * x / 720 + 0.3 * y / 480); });
    const FoundSphere found = FindSphere(sheet);
    EXPECT_NE(found.kind, Kind::kFills) << fall;
    if (found.kind == Kind::kInside) continue;  // as if it were even
    EXPECT_EQ(found.doubt, SphereDoubt::kUnevenGround) << fall << ", " << static_cast<int>(found.kind);
    ++named;
  }
  EXPECT_GE(named, 2);
  Picture noise(300, 200);
  for (int i = 0; i < 300 * 200; ++i) SetGrey(noise, i % 300, i / 300, UnitFloat(Hash(i)));
  EXPECT_EQ(FindSphere(noise).doubt, SphereDoubt::kNone) << "no paper at all";
}

// Around the middle of a photograph, paper of one brightness is a circle too.
TEST(FindSphere, ACircleOfEqualLightIsNoSphere) {
  const auto photograph = [](int width, int height, double radius, double fall) {
    const double x = 0.5 * width, y = 0.5 * height;
    Picture sheet = Drawn(width, height, 0.96, {{x, y, radius}});
    Overlay(sheet, [&](double u, double v) {
      const double share = ((u - x) * (u - x) + (v - y) * (v - y)) / (x * x + y * y);
      return std::pow(1.0 - fall * share, 1.0 / 2.2);
    });
    return sheet;
  };
  ExpectFound(photograph(225, 200, 64, 0.2), {112.5, 100, 64}, 1.5);
  for (const Picture& sheet : {photograph(225, 200, 64, 0.4), photograph(200, 200, 64, 0.4)}) {
    const FoundSphere found = FindSphere(sheet);
    EXPECT_EQ(found.kind, Kind::kUnclear) << found.circle.radius;
    EXPECT_EQ(found.doubt, SphereDoubt::kUnevenGround);
  }
}

// An eye, a ball with a ring: two outlines, one in the other, of one sphere.
TEST(FindSphere, ARingAroundADiscIsOneSphere) {
  for (const double ground : {kWhite, kNothing}) {
    const Picture bare = Drawn(512, 512, ground, {});
    Picture sheet = Drawn(512, 512, ground, {{250, 262, 190}});
    for (int y = 0; y < 512; ++y) {
      for (int x = 0; x < 512; ++x) {
        const double off = std::hypot(x + 0.5 - 250, y + 0.5 - 262);
        if (off > 110 && off < 150) std::copy_n(bare.At(x, y), 4, sheet.At(x, y));
      }
    }
    ExpectFound(sheet, {250, 262, 190}, 1.5);
  }
}

TEST(FindSphere, EllipsesSeveralAndCutOffSpheresAreNone) {
  Ball flat{256, 256, 200};
  flat.squash = 0.85;
  const FoundSphere ellipse = FindSphere(Drawn(512, 512, kWhite, {flat}));
  EXPECT_EQ(ellipse.kind, Kind::kEllipse);
  EXPECT_NEAR(ellipse.longer, 400, 5);
  EXPECT_NEAR(ellipse.shorter, 340, 5);
  flat.radius = 256;  // from side to side
  EXPECT_EQ(FindSphere(Drawn(512, 512, kNothing, {flat})).kind, Kind::kEllipse);
  const FoundSphere two = FindSphere(Drawn(640, 360, kWhite, {{160, 180, 130}, {480, 180, 110}}));
  EXPECT_EQ(two.kind, Kind::kSeveral);
  EXPECT_NEAR(two.circle.x, 160, 2);
  EXPECT_NEAR(two.second.x, 480, 2);
  EXPECT_EQ(FindSphere(Drawn(512, 512, kNothing, {{130, 130, 100}, {380, 380, 100}})).kind, Kind::kSeveral);
  EXPECT_EQ(FindSphere(Drawn(512, 512, kWhite, {{180, 256, 120}, {330, 256, 120}})).kind, Kind::kUnclear) << "joined";
  EXPECT_EQ(FindSphere(Drawn(640, 360, kWhite, {{600, 180, 120}})).kind, Kind::kUnclear) << "cut off";
  Picture square = Sheet(512, 512, kWhite);
  for (int y = 150; y < 350; ++y) {
    for (int x = 150; x < 350; ++x) SetGrey(square, x, y, 0.3);
  }
  EXPECT_EQ(FindSphere(square).kind, Kind::kUnclear);
  const FoundSphere tiny = FindSphere(Drawn(200, 200, kWhite, {{100, 100, 9}}));
  EXPECT_EQ(tiny.kind, Kind::kUnclear) << tiny.circle.radius;
  EXPECT_EQ(tiny.doubt, SphereDoubt::kSmall);
}

// Whatever painters do to a sphere that fills its square, it stays where it is.
TEST(FindSphere, APaintingThatFillsItsSquareIsNeverMoved) {
  for (int seed = 0; seed < 60; ++seed) {
    const auto chance = [&](int k) { return UnitFloat(Hash(seed, k)); };
    PaintedSphere sphere;
    sphere.size = 160 + 7 * (seed % 20);
    sphere.reach = 0.97 + 0.2 * chance(1), sphere.waver = 0.02 + 0.15 * chance(2);
    sphere.azimuth = 360.0 * chance(3), sphere.elevation = 60.0 * chance(4);
    sphere.grain = 0.2 * chance(5);
    sphere.light = seed % 3 == 0 ? 0.93 : 0.5 + 0.3 * chance(6);  // lights of bare paper
    Picture picture = PaintSphere(sphere);
    if (seed % 4 == 1) {  // on nothing
      for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
          if (std::abs(picture.At(x, y)[0] / 65535.0 - 0.93) < 0.001) picture.At(x, y)[3] = 0;
        }
      }
    }
    EXPECT_EQ(FindSphere(picture).kind, Kind::kFills) << seed;
  }
  for (const double radius : {0.4965, 0.5, 0.51, 0.55, 0.6}) {  // clean edges
    for (const double x : {0.497, 0.5}) {
      for (const double ground : {kWhite, kNothing}) {
        const Ball ball{512 * x, 256, 512 * radius};
        const Kind kind = FindSphere(Drawn(512, 512, ground, {ball})).kind;
        EXPECT_TRUE(kind == Kind::kFills || kind == Kind::kNoGround) << radius << ", " << x;
      }
    }
  }
}

// Pixels as opaque as the paint inside.
TEST(SoftEdge, IsAsDeepAsItWasDrawn) {
  for (const double soft : {0.5, 2.0, 5.0, 9.0}) {
    const Picture picture = Drawn(512, 512, kNothing, {{256, 256, 256 - soft}}, soft);
    EXPECT_NEAR(SoftEdge(picture), 2.0 * soft, 1.0) << soft;
    const int edge = SoftEdge(picture);
    for (int y = 0; y < 512; ++y) {
      for (int x = 0; x < 512; ++x) {
        if (std::hypot(x + 0.5 - 256, y + 0.5 - 256) > 256 - edge) continue;
        ASSERT_GE(picture.At(x, y)[3], 64879) << soft << ": " << x << ", " << y;
      }
    }
  }
  EXPECT_EQ(SoftEdge(Drawn(512, 512, kWhite, {{256, 256, 250}}, 5.0)), 0) << "paper is not transparent";
  EXPECT_EQ(SoftEdge(Drawn(512, 512, kNothing, {{256, 256, 280}})), 0) << "past the rim";
  EXPECT_EQ(SoftEdge(Sheet(64, 64, kNothing)), 0);
  EXPECT_EQ(SoftEdge(Picture()), 0);
}

TEST(SoftEdge, OfPaintThatIsSeeThroughItself) {
  Picture glaze = Drawn(512, 512, kNothing, {{256, 256, 253}}, 3.0);
  for (std::size_t i = 3; i < glaze.rgba.size(); i += 4)
    glaze.rgba[i] = static_cast<std::uint16_t>(glaze.rgba[i] * 0.6);
  EXPECT_NEAR(SoftEdge(glaze), 6, 1) << "an even glaze";
  Picture strokes = Drawn(512, 512, kNothing, {{256, 256, 280}});
  for (int i = 0; i < 512 * 512; ++i) {
    if (Hash(i % 512 / 5, i / 512 / 5) % 2) strokes.rgba[std::size_t(i) * 4 + 3] = 0;
  }
  EXPECT_LE(SoftEdge(strokes), 1) << "strokes with gaps, past the rim";
  Picture fading(512, 512);
  for (int i = 0; i < 512 * 512; ++i) {
    const double r = std::hypot(i % 512 - 255.5, i / 512 - 255.5) / 256.0;
    fading.At(i % 512, i / 512)[3] = static_cast<std::uint16_t>(65535 * std::clamp(1.0 - r, 0.0, 1.0));
  }
  EXPECT_EQ(SoftEdge(fading), 0) << "no edge, all of it";
}

}  // namespace
}  // namespace scumble
