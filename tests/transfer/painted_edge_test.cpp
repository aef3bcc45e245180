// Silhouettes with the exemplar's own painted edge.
#include <algorithm>

#include "core/image/color.h"
#include "tests/support/transfer_fixtures.h"

namespace scumble {
namespace {

using namespace testing;

// Black paint on white paper, out to `reach` of the sphere's radius; ragged by a hash where `ragged` is above 0.
Picture PaintOnPaper(int size, double reach, double ragged) {
  Picture picture(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double r = std::hypot(x + 0.5 - size / 2.0, y + 0.5 - size / 2.0) / (size / 2.0);
      const bool paint = r < reach + ragged * (UnitFloat(Hash(x / 3, y / 3)) - 0.5);
      std::uint16_t* texel = picture.At(x, y);
      texel[0] = texel[1] = texel[2] = paint ? 0 : 65535, texel[3] = 65535;
    }
  }
  return picture;
}

// A sphere of 60 pixels' radius in the middle of background.
GuideSet Ball() {
  return MakeGuides(200, 180, [](int x, int y) {
    const float nx = (x + 0.5f - 100) / 60, ny = -(y + 0.5f - 90) / 60, z2 = 1.0f - nx * nx - ny * ny;
    return z2 > 0.0f ? glm::vec3(nx, ny, std::sqrt(z2)) : glm::vec3(0.0f);
  });
}

double PaintedArea(const Picture& picture) {
  double area = 0.0;
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) area += picture.rgba[i + 3] / 65535.0;
  return area;
}

TEST(PaintedEdge, PaintPastTheRimGoesPastTheSilhouetteAsFar) {
  const GuideSet guides = Ball();
  Style style = PlainStyle(PaintOnPaper(400, 1.02, 0.0));  // 4 pixels past the rim
  const double exact = PaintedArea(MustTransfer(style, guides).picture);
  style.transfer.edge = EdgeMode::kExemplar;
  const Picture picture = MustTransfer(style, guides).picture;
  // It fades towards the band's end, 7 pixels out; all of a ring of 4 pixels would be 1558.
  EXPECT_GT(PaintedArea(picture), exact + 900.0);
  EXPECT_LT(PaintedArea(picture), exact + 1600.0);
  for (int y = 0; y < 180; ++y) {
    for (int x = 0; x < 200; ++x) {
      const double past = std::hypot(x + 0.5 - 100, y + 0.5 - 90) - 60.0;
      if (past > 6.0) {
        ASSERT_EQ(picture.At(x, y)[3], 0) << x << ", " << y;
      }
      if (past > 0.8 && past < 2.2) {
        ASSERT_GT(picture.At(x, y)[3], 40000) << x << ", " << y;
      }
      if (past < -8.0) {
        ASSERT_EQ(picture.At(x, y)[3], 65535) << x << ", " << y;
      }
    }
  }
}

TEST(PaintedEdge, PaintThatEndsAtTheRimKeepsTheSilhouette) {
  const GuideSet guides = Ball();
  Style style = PlainStyle(PaintOnPaper(400, 1.0, 0.0));
  const double exact = PaintedArea(MustTransfer(style, guides).picture);
  style.transfer.edge = EdgeMode::kExemplar;
  EXPECT_NEAR(PaintedArea(MustTransfer(style, guides).picture), exact, 0.012 * exact);
}

TEST(PaintedEdge, ARaggedRimMakesARaggedOutline) {
  const GuideSet guides = Ball();
  Style style = PlainStyle(PaintOnPaper(400, 1.0, 0.05));
  style.transfer.edge = EdgeMode::kExemplar;
  const Picture picture = MustTransfer(style, guides).picture;
  int painted_outside = 0, bare_inside = 0;
  for (int y = 0; y < 180; ++y) {
    for (int x = 0; x < 200; ++x) {
      const double past = std::hypot(x + 0.5 - 100, y + 0.5 - 90) - 60.0;
      painted_outside += past > 1.0 && picture.At(x, y)[3] > 20000;
      bare_inside += past < -0.3 && picture.At(x, y)[3] < 45000;
    }
  }
  EXPECT_GT(painted_outside, 150);
  EXPECT_GT(bare_inside, 30);
}

TEST(PaintedEdge, ASheetPaintedAllOverHasNoEdge) {
  const GuideSet guides = Ball();
  Style style = PlainStyle(PaintOnPaper(200, 9.0, 0.0));
  style.paper.color = {65535, 65535, 65535};
  const Picture exact = MustTransfer(style, guides).picture;
  style.transfer.edge = EdgeMode::kExemplar;
  EXPECT_EQ(MustTransfer(style, guides).picture.rgba, exact.rgba);
}

// Of a sphere of a few pixels hardly a centre lies near the rim.
TEST(PaintedEdge, TheSizeDoesNotDecideWhetherThereIsOne) {
  const Picture paint = PaintOnPaper(80, 1.0, 0.0), sheet = PaintOnPaper(80, 2.0, 0.0);
  for (int size = 1; size <= 20; ++size) {
    EXPECT_TRUE(RimPaint(paint, size).HasEdge()) << size;
    EXPECT_FALSE(RimPaint(sheet, size).HasEdge()) << size;
  }
}

TEST(PaintedEdge, ThreadsAndRegionsDoNotChangeAByte) {
  const GuideSet guides = Ball();
  Style style = PlainStyle(PaintOnPaper(400, 1.0, 0.05));
  style.transfer.edge = EdgeMode::kExemplar;
  TransferOptions options;
  options.threads = 1;
  const Picture one = MustTransfer(style, guides, options).picture;
  options.threads = 0;
  EXPECT_EQ(MustTransfer(style, guides, options).picture.rgba, one.rgba);
  const auto prepared = Prepare(style, guides.height());
  Picture tiled;
  TransferScratch scratch;
  for (int y = 0; y < guides.height(); y += 23) {
    for (int x = 0; x < guides.width(); x += 31) {
      options.region = Region{x, y, x + 31, y + 23};
      ASSERT_TRUE(Transfer(*prepared, guides, options, scratch, tiled).ok());
    }
  }
  EXPECT_EQ(tiled.rgba, one.rgba);
}

// Grey paint takes the base colour by the formula; the same grey in the edge must not stay grey beside it.
TEST(PaintedEdge, TakesOnItsObjectsColourAsThePaintDoes) {
  GuideSet guides = Ball();
  guides.Add(Layer::kAlbedo);
  for (int y = 0; y < 180; ++y) {
    for (int x = 0; x < 200; ++x) guides.Plane(Layer::kAlbedo, x < 100 ? 0 : 2)[guides.Index(x, y)] = 1.0f;
  }
  Picture paint = PaintOnPaper(400, 1.02, 0.0);
  for (std::size_t i = 0; i < paint.rgba.size(); ++i) paint.rgba[i] = std::max<std::uint16_t>(paint.rgba[i], 20000);
  for (const ColorizeMode mode : {ColorizeMode::kMultiply, ColorizeMode::kOklab}) {
    Style style = PlainStyle(paint);
    style.transfer.edge = EdgeMode::kExemplar, style.transfer.colorize = 1.0, style.transfer.colorize_mode = mode;
    const Picture picture = MustTransfer(style, guides).picture;
    int outside = 0;
    for (int y = 0; y < 180; ++y) {
      for (int x = 0; x < 200; ++x) {
        const std::uint16_t* pixel = picture.At(x, y);
        if (pixel[3] < 6000 || std::abs(x - 100) < 10) continue;  // where the halves meet, the owner is either's
        outside += std::hypot(x + 0.5 - 100, y + 0.5 - 90) > 60.8;
        const std::uint16_t own = pixel[x < 100 ? 0 : 2], other = pixel[x < 100 ? 2 : 0];
        ASSERT_GT(own, 15000) << x << ", " << y;
        if (mode == ColorizeMode::kMultiply) {
          ASSERT_EQ(other, 0) << x << ", " << y;
          ASSERT_EQ(pixel[1], 0) << x << ", " << y;
        } else {
          ASSERT_LT(other, own) << x << ", " << y;
        }
      }
    }
    EXPECT_GT(outside, 500) << "an edge goes past the silhouette";
  }
}

// Paint of 0.03 of the radius past the rim on white paper, whose colour encodes the direction from the centre.
Picture DirectionPaint(int size) {
  Picture picture(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double dx = x + 0.5 - size / 2.0, dy = y + 0.5 - size / 2.0, r = std::hypot(dx, dy);
      const bool paint = r < 0.515 * size;
      const double color[3] = {0.3 + 0.3 * dx / std::max(r, 1.0), 0.3 + 0.3 * dy / std::max(r, 1.0), 0.0};
      for (int c = 0; c < 3; ++c) picture.At(x, y)[c] = static_cast<std::uint16_t>(65535 * (paint ? color[c] : 1.0));
      picture.At(x, y)[3] = 65535;
    }
  }
  return picture;
}

// The direction that a pixel's colour encodes, in radians from +X towards +Y down.
double DirectionOf(const std::uint16_t* pixel) {
  return std::atan2(pixel[1] / 65535.0 - 0.3, pixel[0] / 65535.0 - 0.3);
}

double Turn(double a, double b) { return std::fabs(std::remainder(a - b, 2.0 * 3.14159265358979)); }

GuideSet BallOf(int size, double radius) {
  return MakeGuides(size, size, [=](int x, int y) {
    const double nx = (x + 0.5 - size / 2.0) / radius, ny = -(y + 0.5 - size / 2.0) / radius,
                 z2 = 1.0 - nx * nx - ny * ny;
    return z2 > 0.0 ? glm::vec3(nx, ny, std::sqrt(z2)) : glm::vec3(0.0f);
  });
}

struct Turns {
  double mean = 0.0, worst = 0.0;
  int count = 0;
};

// The angle between the rim's direction and the sphere's on the ring from 1 pixel inside the silhouette to 0.6 of the
// paint outside.
Turns TurnsOnBall(int size, double radius, int exemplar) {
  Style style = PlainStyle(DirectionPaint(exemplar));
  style.transfer.edge = EdgeMode::kExemplar, style.transfer.method = Method::kLitSphere,
  style.transfer.blend_radius = 0;
  const Picture picture = MustTransfer(style, BallOf(size, radius)).picture;
  Turns turns;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double dx = x + 0.5 - size / 2.0, dy = y + 0.5 - size / 2.0, past = std::hypot(dx, dy) - radius;
      if (past < -1.0 || past > 0.006 * exemplar || picture.At(x, y)[3] < 30000) continue;
      const double direction = std::atan2(dy, dx), to_axis = std::fabs(std::remainder(direction, 3.14159265 / 2));
      if (past > -0.5 && to_axis < 0.36) continue;  // there the exemplar's picture ends at the sphere
      const double turn = Turn(DirectionOf(picture.At(x, y)), direction);
      turns.mean += turn, turns.worst = std::max(turns.worst, turn), ++turns.count;
    }
  }
  turns.mean /= std::max(1, turns.count);
  return turns;
}

TEST(PaintedEdge, ABallOfTheExemplarsSizeShowsTheExemplarsRim) {
  const Turns turns = TurnsOnBall(240, 100.0, 200);
  EXPECT_GT(turns.count, 700);
  EXPECT_LT(turns.mean, 0.03);
  EXPECT_LT(turns.worst, 0.15);
}

TEST(PaintedEdge, OnOtherBallsTheRimFacesAsTheyDo) {
  for (const double radius : {60.0, 200.0}) {
    const Turns turns = TurnsOnBall(static_cast<int>(2.4 * radius), radius, 300);
    EXPECT_GT(turns.count, 300) << radius;
    EXPECT_LT(turns.mean, 0.2) << radius;
    EXPECT_LT(turns.worst, 0.75) << radius << ": 0.3 within a piece, less than 0.5 of freedom";
  }
}

// Grey paint on white paper, and thin radial strokes past the rim: 2 pixels wide, 8 apart.
Picture StrokesPastTheRim(int size) {
  Picture picture(size, size);
  const double half = size / 2.0, strokes = std::floor(3.14159265 * size / 8.0);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double dx = x + 0.5 - half, dy = y + 0.5 - half, r = std::hypot(dx, dy) / half;
      const double turn = std::atan2(dy, dx) / 6.2831853 + 0.5, across = turn * strokes - std::floor(turn * strokes);
      const bool stroke = r < 1.02 && std::fabs(across - 0.5) < 0.125;
      const double grey = r < 1.0 && !stroke ? 0.6 : stroke ? 0.45 : 1.0;
      std::uint16_t* texel = picture.At(x, y);
      texel[0] = texel[1] = texel[2] = static_cast<std::uint16_t>(65535 * grey), texel[3] = 65535;
    }
  }
  return picture;
}

// The light that the strokes outside a ball take from white paper, as a share of the ring that they lie on.
double InkPastTheRim(double scale) {
  Style style = PlainStyle(StrokesPastTheRim(800));
  style.transfer.edge = EdgeMode::kExemplar, style.transfer.scale = scale;
  const int size = static_cast<int>(500 * scale);
  const double radius = 200.0 * scale;
  const Picture picture = MustTransfer(style, BallOf(size, radius)).picture;
  double ink = 0.0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double past = std::hypot(x + 0.5 - size / 2.0, y + 0.5 - size / 2.0) - radius;
      if (past < 0.5) continue;
      const std::uint16_t* texel = picture.At(x, y);
      ink += texel[3] / 65535.0 * (1.0 - Srgb16ToLinear(texel[0]));
    }
  }
  return ink / (6.2831853 * radius * 8.0 * scale);
}

TEST(PaintedEdge, StrokesOfLessThanAPixelKeepTheirTone) {
  const double whole = InkPastTheRim(1.0);
  EXPECT_GT(whole, 0.1);
  for (const double scale : {0.6, 0.3, 0.2}) EXPECT_NEAR(InkPastTheRim(scale), whole, 0.2 * whole) << scale;
}

// The direction of the rim along a straight horizontal outline, just outside of it.
std::vector<double> DirectionsAlongAStraightOutline(int width, int reference, std::uint64_t seed) {
  Style style = PlainStyle(DirectionPaint(400));
  style.transfer.edge = EdgeMode::kExemplar, style.transfer.jitter = 0.0f, style.transfer.reference_height = reference;
  const int height = width / 2;
  const GuideSet guides =
      MakeGuides(width, height, [=](int, int y) { return y < height / 2 ? glm::vec3(0) : glm::vec3(0, 0, 1); });
  TransferOptions options;
  options.seed = seed;
  const Picture picture = MustTransfer(style, guides, options).picture;
  std::vector<double> directions;
  for (int x = 0; x < width; ++x) {
    EXPECT_GT(picture.At(x, height / 2 - 1)[3], 20000) << x;
    directions.push_back(DirectionOf(picture.At(x, height / 2 - 1)));
  }
  return directions;
}

TEST(PaintedEdge, AStraightOutlineDoesNotRepeatOnePieceOfTheRim) {
  const std::vector<double> directions = DirectionsAlongAStraightOutline(1280, 0, 0);
  int same = 0;
  double least = 10.0, most = -10.0;
  for (std::size_t x = 0; x < directions.size(); ++x) {
    EXPECT_LT(Turn(directions[x], -1.5707963), 0.95) << x << ": it faces up";
    least = std::min(least, directions[x]), most = std::max(most, directions[x]);
    if (x + 64 < directions.size()) same += Turn(directions[x], directions[x + 64]) < 0.02;
  }
  EXPECT_GT(most - least, 0.7);
  EXPECT_LT(same, 0.2 * static_cast<double>(directions.size())) << "a seed every 64 pixels";
}

TEST(PaintedEdge, APreviewOfHalfTheSizeShowsTheSamePieces) {
  const auto shared = [](std::uint64_t seed) {
    const std::vector<double> whole = DirectionsAlongAStraightOutline(1280, 640, 0);
    const std::vector<double> half = DirectionsAlongAStraightOutline(640, 640, seed);
    double same = 0.0;
    for (std::size_t x = 0; x < half.size(); ++x) same += Turn(half[x], whole[2 * x]) < 0.04;
    return same / static_cast<double>(half.size());
  };
  EXPECT_GT(shared(0), 0.65);
  EXPECT_LT(shared(1), 0.4);
}

// A disc of 60 pixels' radius before a wall, white both but for the disc's rim.
GuideSet DiscBefore(float wall_depth) {
  GuideSet guides = MakeGuides(200, 180, [](int, int) { return glm::vec3(0, 0, 1); });
  for (int y = 0; y < 180; ++y) {
    for (int x = 0; x < 200; ++x) {
      if (std::hypot(x + 0.5 - 100, y + 0.5 - 90) < 60.0) continue;
      guides.Plane(Layer::kObject)[guides.Index(x, y)] = 2.0f,
                                                   guides.Plane(Layer::kDepth)[guides.Index(x, y)] = wall_depth;
    }
  }
  return guides;
}

TEST(PaintedEdge, AnObjectClearlyBeforeAnotherHasOneAndOneHardlyBeforeItHasNone) {
  Style exact = PlainStyle(DirectionPaint(400)), painted = exact;
  painted.transfer.edge = EdgeMode::kExemplar;
  EXPECT_EQ(MustTransfer(painted, DiscBefore(10.1f)).picture.rgba, MustTransfer(exact, DiscBefore(10.1f)).picture.rgba);
  EXPECT_EQ(MustTransfer(painted, DiscBefore(10.0f)).picture.rgba, MustTransfer(exact, DiscBefore(10.0f)).picture.rgba);
  const Picture without = MustTransfer(exact, DiscBefore(10.32f)).picture,
                with = MustTransfer(painted, DiscBefore(10.32f)).picture;
  int outside = 0, ring = 0;
  for (int y = 0; y < 180; ++y) {
    for (int x = 0; x < 200; ++x) {
      const double past = std::hypot(x + 0.5 - 100, y + 0.5 - 90) - 60.0;
      if (past > 0.5 && past < 3.0) ++ring, outside += !std::equal(with.At(x, y), with.At(x, y) + 3, without.At(x, y));
      EXPECT_EQ(with.At(x, y)[3], 65535) << "the wall is behind, there is nothing to see through to";
    }
  }
  EXPECT_GT(outside, 0.9 * ring);
}

TEST(PaintedEdge, ThinThingsStayExactAndTheLineGrowsWithThem) {
  double before = 0.0;
  for (const int thickness : {6, 24, 40, 64}) {
    const GuideSet guides = MakeGuides(300, 160, [=](int, int y) {
      return y >= 80 - thickness / 2 && y < 80 + thickness / 2 ? glm::vec3(0, 0, 1) : glm::vec3(0.0f);
    });
    Style style = PlainStyle(PaintOnPaper(400, 1.02, 0.0));
    const Picture exact = MustTransfer(style, guides).picture;
    style.transfer.edge = EdgeMode::kExemplar;
    const Picture picture = MustTransfer(style, guides).picture;
    const double past = (PaintedArea(picture) - PaintedArea(exact)) / 600.0;  // pixels on either side
    if (thickness == 6) {
      EXPECT_EQ(picture.rgba, exact.rgba);
    } else {
      EXPECT_GT(past, before + 0.25) << thickness;
    }
    before = past;
  }
  EXPECT_NEAR(before, 4.0, 0.8) << "8 bands of 7 pixels and more have the whole 4 pixels of paint past the rim";
}

// The lower half of the sphere's surroundings is another object, which is left unpainted.
TEST(PaintedEdge, WhatIsLeftUnpaintedCountsAsNothingUnlessItStandsBefore) {
  Style style = PlainStyle(PaintOnPaper(400, 1.02, 0.0));
  style.transfer.edge = EdgeMode::kExemplar;
  const auto prepared = Prepare(style, 180);
  for (const std::uint16_t unpainted : {StyleMap::kPassThrough, StyleMap::kShadowCatcher}) {
    for (const float depth : {10.0f, 10.05f, 12.0f, 8.0f}) {
      GuideSet guides = Ball();
      for (int y = 95; y < 180; ++y) {
        for (int x = 0; x < 200; ++x) {
          const std::size_t i = guides.Index(x, y);
          if (guides.Plane(Layer::kCoverage)[i] > 0.0f) continue;
          guides.Plane(Layer::kCoverage)[i] = 1.0f, guides.Plane(Layer::kNormal, 2)[i] = 1.0f;
          guides.Plane(Layer::kObject)[i] = 3.0f, guides.Plane(Layer::kDepth)[i] = depth;
        }
      }
      const PreparedStyle* styles[] = {&*prepared};
      TransferScratch scratch;
      Picture picture;
      ASSERT_TRUE(Transfer(styles, MapStyles(guides, {{{3u, unpainted}}, {}, 0}), guides, {}, scratch, picture).ok());
      int painted = 0, ring = 0;
      for (int y = 100; y < 180; ++y) {
        for (int x = 0; x < 200; ++x) {
          const double past = std::hypot(x + 0.5 - 100, y + 0.5 - 90) - 60.0;
          if (past > 0.8 && past < 2.2) ++ring, painted += picture.At(x, y)[3] > 40000;
        }
      }
      EXPECT_EQ(painted, depth < 9.0f ? 0 : ring) << depth;
    }
  }
}

TEST(PaintedEdge, ThePaperBehindDoesNotDecideWhatIsPaint) {
  const GuideSet guides = Ball();
  for (const std::uint16_t paper : {0, 30000, 65535}) {
    Style style = PlainStyle(PaintOnPaper(400, 1.02, 0.0));
    for (std::size_t i = 0; i < style.exemplars[0].picture.rgba.size(); i += 4) {
      std::uint16_t* texel = style.exemplars[0].picture.rgba.data() + i;
      if (texel[0] == 0) texel[0] = 60000;  // red paint
    }
    style.paper.color = {paper, paper, paper};
    style.transfer.edge = EdgeMode::kExemplar;
    const auto prepared = Prepare(style, 180);
    EXPECT_FALSE(prepared->rims.empty()) << paper;
    const Picture picture = MustTransfer(style, guides).picture;
    EXPECT_NEAR(picture.At(100 + 43, 90 + 43)[0], 60000, 1500) << "1 pixel outside";
    EXPECT_LT(picture.At(100 + 43, 90 + 43)[1], 12000) << paper;
  }
}

TEST(PaintedEdge, LightPaintOnNothingHasItsAlphaAsOpacity) {
  Picture paint = PaintOnPaper(400, 1.02, 0.05);
  for (std::size_t i = 0; i < paint.rgba.size(); i += 4) {
    std::uint16_t* texel = paint.rgba.data() + i;
    texel[3] = texel[0] == 0 ? 65535 : 0;
    texel[0] = texel[1] = texel[2] = 64000;
  }
  Style style = PlainStyle(paint);
  style.transfer.edge = EdgeMode::kExemplar;
  style.paper.color = {65535, 65535, 65535};
  EXPECT_FALSE(Prepare(style, 180)->rims.empty());
  style.paper.color.reset();
  const Picture picture = MustTransfer(style, Ball()).picture;
  EXPECT_GT(picture.At(100 + 43, 90 + 43)[3], 50000);
  EXPECT_EQ(picture.At(100 + 43, 90 + 43)[0], 64000);
}

TEST(PaintedEdge, MeetsWhatIsBehindInLinearLight) {
  // Half-opaque black past the rim, over a white wall in a style of its own.
  Picture paint = PaintOnPaper(400, 1.03, 0.0), white = PaintOnPaper(64, 0.0, 0.0);
  for (std::size_t i = 0; i < paint.rgba.size(); i += 4) paint.rgba[i + 3] = paint.rgba[i] == 0 ? 32768 : 0;
  Style disc = PlainStyle(paint), wall = PlainStyle(white);
  disc.transfer.edge = EdgeMode::kExemplar;
  const auto first = Prepare(disc, 180), second = Prepare(wall, 180);
  const PreparedStyle* styles[] = {&*first, &*second};
  const GuideSet guides = DiscBefore(20.0f);
  TransferScratch scratch;
  Picture picture;
  ASSERT_TRUE(
      Transfer(styles, MapStyles(guides, {{{2u, std::uint16_t{1}}}, {}, 0}), guides, {}, scratch, picture).ok());
  EXPECT_NEAR(picture.At(100 + 43, 90 + 43)[0], 0.735357 * 65535, 700) << "half of the light is sRGB 0.7354";
}

// The strokes of a disc, made in one piece, or in tiles.
EdgeStrokes StrokesOf(const GuideSet& guides, Picture& picture, const TransferOptions& options = {}) {
  // Half-opaque black past the rim.
  Picture paint = PaintOnPaper(400, 1.03, 0.05);
  for (std::size_t i = 0; i < paint.rgba.size(); i += 4) paint.rgba[i + 3] = paint.rgba[i] == 0 ? 32768 : 0;
  Style style = PlainStyle(paint);
  style.transfer.edge = EdgeMode::kExemplar;
  const auto prepared = Prepare(style, guides.height());
  TransferScratch scratch;
  TransferOptions kept = options;
  kept.keep_colors = kept.bare = true;
  EXPECT_TRUE(Transfer(*prepared, guides, kept, scratch, picture).ok());
  return scratch.strokes;
}

TEST(PaintedEdge, EachStrokeOnOtherGuidesNamesItsSurface) {
  GuideSet before_nothing = Ball();
  for (int x = 0; x < 200; ++x) before_nothing.Plane(Layer::kCoverage)[before_nothing.Index(x, 60)] *= 0.5f;
  for (const GuideSet& guides : {before_nothing, DiscBefore(20.0f)}) {
    Picture picture, exact;
    const EdgeStrokes strokes = StrokesOf(guides, picture);
    const auto object = guides.Plane(Layer::kObject), coverage = guides.Plane(Layer::kCoverage);
    ASSERT_GT(strokes.size(), 600u);
    std::vector<int> is_stroke(guides.pixel_count());
    for (std::size_t k = 0; k < strokes.size(); ++k) {
      const EdgeStroke& stroke = strokes[k];
      EXPECT_TRUE(k == 0 || strokes[k - 1].pixel < stroke.pixel);
      EXPECT_EQ(object[stroke.owner], 1.0f);
      EXPECT_TRUE(object[stroke.pixel] != 1.0f || coverage[stroke.pixel] < 1.0f) << "its guides are the stroke's";
      const int dx = int(stroke.pixel % 200) - int(stroke.owner % 200),
                dy = int(stroke.pixel / 200) - int(stroke.owner / 200);
      EXPECT_LE(std::hypot(dx, dy), 9.0 + 2.5);  // the owner lies up to two pixels within its outline
      const std::uint16_t* const shown = picture.rgba.data() + 4 * stroke.pixel;
      EXPECT_TRUE(std::equal(shown, shown + 4, stroke.mixed.begin()));
      EXPECT_GT(stroke.own[3], 0);
      const double alpha = stroke.own[3] / 65535.0, beneath = stroke.beneath[3] / 65535.0;
      EXPECT_NEAR(stroke.mixed[3] / 65535.0, alpha + beneath * (1.0 - alpha), 1e-4);
      is_stroke[stroke.pixel] = 1;
    }
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      if (coverage[i] == 0.0f) {
        EXPECT_EQ(picture.rgba[4 * i + 3] > 0, is_stroke[i] == 1) << i;
      }
    }
  }
}

TEST(PaintedEdge, ThreadsAndRegionsDoNotChangeTheStrokes) {
  const auto same = [](const EdgeStroke& a, const EdgeStroke& b) {
    return a.pixel == b.pixel && a.owner == b.owner && a.own == b.own && a.beneath == b.beneath && a.mixed == b.mixed;
  };
  const GuideSet guides = DiscBefore(20.0f);
  Picture picture;
  TransferOptions options;
  options.threads = 1;
  const EdgeStrokes one = StrokesOf(guides, picture, options);
  options.threads = 0;
  EXPECT_TRUE(std::ranges::equal(StrokesOf(guides, picture, options), one, same));
  EdgeStrokes tiled;
  for (const Region region : {Region{0, 0, 90, 180}, Region{90, 0, 200, 180}}) {
    options.region = region;
    const EdgeStrokes some = StrokesOf(guides, picture, options);
    tiled.insert(tiled.end(), some.begin(), some.end());
  }
  std::ranges::sort(tiled, {}, &EdgeStroke::pixel);
  EXPECT_TRUE(std::ranges::equal(tiled, one, same));
}

}  // namespace
}  // namespace scumble
