// Silhouettes with the exemplar's own painted edge, and shadows on catchers.
#include <algorithm>
#include <set>

#include "tests/transfer_fixtures.h"

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

// A ball of 60 pixels' radius in the middle of background.
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
      if (past > 5.5) {
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

// Grey paint takes on the base colour by the formula; the same grey in the edge must not stay grey beside it.
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

// Light paint, with one dark corner of the disc whose texels differ.
Picture DarkCorner(int size) {
  Picture picture(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const bool dark = std::abs(x - size * 0.3) < size * 0.13 && std::abs(y - size * 0.65) < size * 0.13;
      std::uint16_t* texel = picture.At(x, y);
      texel[0] = texel[1] = texel[2] = static_cast<std::uint16_t>((dark ? 2000 : 50000) + Hash(x, y) % 500);
      texel[3] = 65535;
    }
  }
  return picture;
}

TEST(Shadow, CatchersShowDarkPaintWhereTheyAreInShadowAndNothingElse) {
  GuideSet guides = MakeGuides(120, 80, [](int, int y) { return y < 8 ? glm::vec3(0.0f) : glm::vec3(0, 0, 1); });
  guides.Add(Layer::kShadow);
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 120; ++x) {
      const std::size_t i = guides.Index(x, y);
      if (x >= 40) guides.Plane(Layer::kObject)[i] = 2.0f;  // the ground; its right part is in shadow
      guides.Plane(Layer::kShadow)[i] = x < 80 ? 0.0f : x < 100 ? 0.5f : 1.0f;
    }
  }
  Style style = PlainStyle(DarkCorner(256));
  style.transfer.shadow = ShadowMode::kPaint;
  EXPECT_TRUE(RequiredLayers(style).Has(Layer::kShadow));
  const auto prepared = Prepare(style, 80);
  ASSERT_TRUE(prepared);
  ASSERT_TRUE(prepared->dark);
  EXPECT_NEAR(prepared->dark->center.x, 256 * 0.3, 20);
  EXPECT_NEAR(prepared->dark->center.y, 256 * 0.65, 20);
  const PreparedStyle* styles[] = {&*prepared};
  const StyleMap map = MapStyles(guides, {{{2u, StyleMap::kCatch}}, {}, 0});
  TransferScratch scratch;
  Picture picture;
  ASSERT_TRUE(Transfer(styles, map, guides, {}, scratch, picture).ok());
  std::set<std::uint16_t> tones;
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 120; ++x) {
      const std::uint16_t* pixel = picture.At(x, y);
      const int alpha = y < 8 ? 0 : x < 40 ? 65535 : x < 80 ? 0 : x < 100 ? 32768 : 65535;
      ASSERT_EQ(pixel[3], alpha) << x << ", " << y;
      if (alpha > 0) {
        ASSERT_EQ(pixel[0] < 3000, x >= 80) << x << ", " << y;
      }
      if (x >= 100) tones.insert(pixel[0]);
    }
  }
  EXPECT_GT(tones.size(), 200u) << "paint, not a flat tone";

  TransferOptions over;
  Picture below(120, 80);
  for (std::size_t i = 0; i < below.rgba.size(); ++i) below.rgba[i] = static_cast<std::uint16_t>(i % 4 == 3 ? 65535 : 40000);
  over.over = &below;
  ASSERT_TRUE(Transfer(styles, map, guides, over, scratch, picture).ok());
  EXPECT_EQ(picture.At(60, 40)[0], 40000) << "no shadow, the picture underneath as it is";
  EXPECT_LT(picture.At(90, 40)[0], 38000);
  EXPECT_GT(picture.At(90, 40)[0], 20000);
  EXPECT_LT(picture.At(110, 40)[0], 3000);

  style.transfer.shadow = ShadowMode::kNone;
  const auto without = Prepare(style, 80);
  const PreparedStyle* none[] = {&*without};
  ASSERT_TRUE(Transfer(none, map, guides, {}, scratch, picture).ok());
  EXPECT_EQ(picture.At(110, 40)[3], 0);
}

// In a painted scene the darkest pixels may be where nothing usable is: between its objects, or beyond a shorter side.
TEST(Shadow, TheDarkPlaceOfAPaintedSceneIsUsable) {
  const auto dark_place = [](int width, int height, auto covered) {
    Style style = PlainStyle(Picture(width, height));
    style.exemplars[0].is_sphere = false;
    style.exemplars[0].guides =
        MakeGuides(width, height, [=](int x, int y) { return covered(x, y) ? glm::vec3(0, 0, 1) : glm::vec3(0.0f); });
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        std::uint16_t* texel = style.exemplars[0].picture.At(x, y);
        const std::uint16_t tone = covered(x, y) ? static_cast<std::uint16_t>(50000 - 20 * x - 20 * y) : std::uint16_t{0};
        texel[0] = texel[1] = texel[2] = tone, texel[3] = 65535;
      }
    }
    style.transfer.shadow = ShadowMode::kPaint, style.transfer.rim = 0.0;
    const auto prepared = Prepare(style, 100);
    EXPECT_TRUE(prepared.ok());
    const DarkPlace dark = *prepared->dark;
    EXPECT_TRUE(prepared->exemplar->Usable(dark.center.x, dark.center.y)) << width << "×" << height;
    return dark;
  };
  const DarkPlace wide = dark_place(400, 60, [](int, int) { return true; });
  EXPECT_GT(wide.center.x, 380);
  EXPECT_GT(wide.center.y, 50);
  const DarkPlace tall = dark_place(60, 400, [](int, int) { return true; });
  EXPECT_GT(tall.center.y, 380);
  const DarkPlace dots = dark_place(90, 70, [](int x, int y) { return x % 3 == 0 && y % 3 == 0; });
  EXPECT_EQ(dots.center, (Source{87, 69}));
  EXPECT_EQ(dots.reach, 0);
}

}  // namespace
}  // namespace scumble
