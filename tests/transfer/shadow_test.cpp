// Shadows on catchers.
#include <algorithm>
#include <cmath>
#include <set>

#include "core/image/color.h"
#include "tests/support/transfer_fixtures.h"

namespace scumble {
namespace {

using namespace testing;

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
  ASSERT_TRUE(prepared->shadow);
  EXPECT_NEAR(prepared->shadow->dark().center.x, 256 * 0.3, 20);
  EXPECT_NEAR(prepared->shadow->dark().center.y, 256 * 0.65, 20);
  const PreparedStyle* styles[] = {&*prepared};
  const StyleMap map = MapStyles(guides, {{{2u, StyleMap::kShadowCatcher}}, {}, 0});
  TransferScratch scratch;
  Picture picture;
  ASSERT_TRUE(Transfer(styles, map, guides, {}, scratch, picture).ok());
  std::set<std::uint16_t> tones;
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 120; ++x) {
      const std::uint16_t* pixel = picture.At(x, y);
      if (x < 78 || x >= 102 || y < 8) {
        const bool painted = y >= 8 && (x < 40 || x >= 102);
        EXPECT_EQ(pixel[3], painted ? 65535 : 0) << x << ", " << y;
      }
      if (x >= 78 && pixel[3] > 0) {
        EXPECT_LT(pixel[0], 3000) << x << ", " << y;
      }
      if (x >= 102) tones.insert(pixel[0]);
    }
  }
  EXPECT_GT(tones.size(), 200u) << "paint, not a flat tone";

  TransferOptions over;
  Picture below(120, 80);
  for (std::size_t i = 0; i < below.rgba.size(); ++i)
    below.rgba[i] = static_cast<std::uint16_t>(i % 4 == 3 ? 65535 : 40000);
  over.over = &below;
  ASSERT_TRUE(Transfer(styles, map, guides, over, scratch, picture).ok());
  EXPECT_EQ(picture.At(60, 40)[0], 40000) << "no shadow, the picture underneath as it is";
  double light = 0.0;
  for (int y = 8; y < 80; ++y) {
    for (int x = 83; x < 97; ++x) light += Srgb16ToLinear(picture.At(x, y)[0]) / (72.0 * 14.0);
  }
  EXPECT_NEAR(light / Srgb16ToLinear(40000), 0.5, 0.16) << "about half of the light";
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
        const std::uint16_t tone =
            covered(x, y) ? static_cast<std::uint16_t>(50000 - 20 * x - 20 * y) : std::uint16_t{0};
        texel[0] = texel[1] = texel[2] = tone, texel[3] = 65535;
      }
    }
    style.transfer.shadow = ShadowMode::kPaint, style.transfer.rim = 0.0;
    const auto prepared = Prepare(style, 100);
    EXPECT_TRUE(prepared.ok());
    const DarkPlace dark = prepared->shadow->dark();
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

// A wall of 400 × 300 that catches a shadow of the given strength, painted in the style.
Picture ShadowOn(const Style& style, const std::function<float(int x, int y)>& strength, int width = 400,
                 std::uint64_t seed = 0) {
  GuideSet guides = MakeGuides(width, width * 3 / 4, [](int, int) { return glm::vec3(0, 0, 1); });
  guides.Add(Layer::kShadow);
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x < width; ++x) guides.Plane(Layer::kShadow)[guides.Index(x, y)] = strength(x, y);
  }
  const auto prepared = Prepare(style, guides.height());
  EXPECT_TRUE(prepared.ok());
  const PreparedStyle* styles[] = {&*prepared};
  TransferScratch scratch;
  TransferOptions options;
  options.seed = seed;
  Picture picture;
  EXPECT_TRUE(
      Transfer(styles, MapStyles(guides, {{{1u, StyleMap::kShadowCatcher}}, {}, 0}), guides, options, scratch, picture)
          .ok());
  return picture;
}

// Black dots on white paper, none at the left, everywhere at the right of the disc.
Picture Stippled(int size, bool bare_corners) {
  Picture picture(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double r = std::hypot(x + 0.5 - size / 2.0, y + 0.5 - size / 2.0) / (size / 2.0),
                   share = 1.4 * x / size - 0.2;
      const bool paint = bare_corners && r > 1.0 ? false : UnitFloat(Hash(x / 2, y / 2)) < share;
      std::uint16_t* texel = picture.At(x, y);
      texel[0] = texel[1] = texel[2] = paint ? 0 : 65535, texel[3] = 65535;
    }
  }
  return picture;
}

double MeanAlpha(const Picture& picture) {
  double sum = 0.0;
  for (std::size_t i = 3; i < picture.rgba.size(); i += 4) sum += picture.rgba[i] / 65535.0;
  return 4.0 * sum / static_cast<double>(picture.rgba.size());
}

TEST(Shadow, ItsStrengthIsTheToneOfWhatItIsPaintedWith) {
  Style style = PlainStyle(Stippled(400, true));
  style.transfer.shadow = ShadowMode::kPaint;
  EXPECT_TRUE(Prepare(style, 300)->shadow->has_tones());
  for (const float strength : {0.15f, 0.3f, 0.5f, 0.7f, 0.9f, 1.0f}) {
    const Picture picture = ShadowOn(style, [&](int, int) { return strength; });
    EXPECT_NEAR(MeanAlpha(picture), strength, 0.05) << strength;
    int between = 0;
    for (std::size_t i = 3; i < picture.rgba.size(); i += 4)
      between += picture.rgba[i] > 6000 && picture.rgba[i] < 60000;
    EXPECT_LT(between, 400 * 300 / 50) << strength << ": dots, not grey";
  }
  EXPECT_EQ(MeanAlpha(ShadowOn(style, [](int, int) { return 0.0f; })), 0.0);
}

TEST(Shadow, PaintThatCoversTheSheetIsLaidOnThinlyWithItsStrokes) {
  Style style = PlainStyle(NoisePicture(400));
  style.transfer.shadow = ShadowMode::kPaint;
  EXPECT_FALSE(Prepare(style, 300)->shadow->has_tones());
  for (const float strength : {0.15f, 0.3f, 0.5f, 0.7f, 0.9f, 1.0f}) {
    const Picture picture = ShadowOn(style, [&](int, int) { return strength; });
    EXPECT_NEAR(MeanAlpha(picture), strength, 0.04) << strength;
    double squares = 0.0;
    for (std::size_t i = 3; i < picture.rgba.size(); i += 4)
      squares += std::pow(picture.rgba[i] / 65535.0 - strength, 2.0);
    if (strength < 0.95f) {
      EXPECT_GT(std::sqrt(squares / (400 * 300)), 0.05) << strength;
    }
  }
}

// What lies beyond the sphere is cut away, as drawing programs export it.
Picture CutOut(Picture picture) {
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double half = picture.width / 2.0;
      if (std::hypot(x + 0.5 - half, y + 0.5 - half) > half) picture.At(x, y)[3] = 0;
    }
  }
  return picture;
}

// The share of the light that a white ground still returns, and the share of pixels that are nearly white and opaque.
struct OnWhite {
  double light = 0.0, paper = 0.0;
};
OnWhite LaidOnWhite(const Picture& picture) {
  OnWhite on;
  const double count = static_cast<double>(picture.rgba.size()) / 4.0;
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    const double alpha = picture.rgba[i + 3] / 65535.0, light = Srgb16ToLinear(picture.rgba[i]);
    on.light += (alpha * light + 1.0 - alpha) / count;
    on.paper += (alpha > 0.5 && light > 0.7) / count;
  }
  return on;
}

TEST(Shadow, PaperInsideACutOutSphereIsNoPaint) {
  Style whole = PlainStyle(Stippled(400, true)), cut = PlainStyle(CutOut(Stippled(400, true)));
  whole.transfer.shadow = cut.transfer.shadow = ShadowMode::kPaint;
  EXPECT_TRUE(Prepare(cut, 300)->shadow->has_tones());
  for (const float strength : {0.15f, 0.3f, 0.5f, 0.7f, 0.9f, 1.0f}) {
    const auto everywhere = [&](int, int) { return strength; };
    const Picture picture = ShadowOn(cut, everywhere);
    EXPECT_NEAR(MeanAlpha(picture), strength, 0.05) << strength;
    EXPECT_LT(LaidOnWhite(picture).paper, 0.001) << strength;
    EXPECT_EQ(picture.rgba, ShadowOn(whole, everywhere).rgba) << strength << ": as if flattened on white";
  }
}

// Opaque paint has no paper between its strokes; strokes on nothing have their opacity.
TEST(Shadow, CutOutsOfOpaquePaintAndOfStrokesOnNothing) {
  Picture strokes = CutOut(Stippled(400, true));
  for (std::size_t i = 0; i < strokes.rgba.size(); i += 4) {
    if (strokes.rgba[i] > 0) strokes.rgba[i + 3] = 0;
  }
  Picture opaque = NoisePicture(400);
  for (std::size_t i = 0; i < opaque.rgba.size(); i += 4) {
    for (std::size_t c = 0; c < 3; ++c) opaque.rgba[i + c] = static_cast<std::uint16_t>(opaque.rgba[i + c] / 2);
  }
  for (const bool is_opaque : {false, true}) {
    Style style = PlainStyle(is_opaque ? CutOut(opaque) : strokes);
    style.transfer.shadow = ShadowMode::kPaint;
    EXPECT_NE(Prepare(style, 300)->shadow->has_tones(), is_opaque);
    for (const float strength : {0.15f, 0.5f, 0.9f}) {
      const Picture picture = ShadowOn(style, [&](int, int) { return strength; });
      EXPECT_NEAR(MeanAlpha(picture), strength, 0.05) << is_opaque << ", " << strength;
    }
  }
}

// The layer has steps along a slanted border; in the picture every row crosses it evenly.
TEST(Shadow, AHardOutlineFadesEvenlyOverAFewPixels) {
  Style style = PlainStyle(DarkCorner(256));
  style.transfer.shadow = ShadowMode::kPaint;
  const Picture picture = ShadowOn(style, [](int x, int y) { return 3 * x + y < 700 ? 1.0f : 0.0f; });
  for (int y = 20; y < 280; ++y) {
    int between = 0;
    for (int x = 1; x < 400; ++x) {
      const int alpha = picture.At(x, y)[3], before = picture.At(x - 1, y)[3];
      EXPECT_LE(alpha, before) << x << ", " << y;
      EXPECT_LT(before - alpha, 0.45 * 65535) << x << ", " << y;
      between += alpha > 0 && alpha < 65535;
    }
    EXPECT_GE(between, 3);
    EXPECT_LE(between, 6);
  }
}

TEST(Shadow, APreviewOfHalfTheSizeShowsTheSamePieces) {
  // Each place of the sphere has its own grey, so a pixel shows its source.
  Picture grey(512, 512);
  for (int y = 0; y < 512; ++y) {
    for (int x = 0; x < 512; ++x) {
      const bool disc = std::hypot(x + 0.5 - 256, y + 0.5 - 256) < 256;
      std::uint16_t* texel = grey.At(x, y);
      const double shade = 0.1 + std::min(0.9, std::hypot(x - 180, y - 300) / 256.0);  // one darkest place
      texel[0] = disc ? static_cast<std::uint16_t>(128 * x * shade) : 65535;
      texel[1] = disc ? static_cast<std::uint16_t>(128 * y * shade) : 65535;
      texel[2] = disc ? 0 : 65535, texel[3] = 65535;
    }
  }
  Style style = PlainStyle(grey);
  style.transfer.shadow = ShadowMode::kPaint, style.transfer.reference_height = 600;
  const auto shared = [&](std::uint64_t seed, float value) {
    const auto strength = [=](int, int) { return value; };
    const Picture whole = ShadowOn(style, strength, 800), half = ShadowOn(style, strength, 400, seed);
    int same = 0;
    for (int y = 0; y < 300; ++y) {
      for (int x = 0; x < 400; ++x) {
        same += std::abs(half.At(x, y)[0] - whole.At(2 * x, 2 * y)[0]) < 500 &&
                std::abs(half.At(x, y)[1] - whole.At(2 * x, 2 * y)[1]) < 500;
      }
    }
    return same / (400.0 * 300.0);
  };
  for (const float value : {0.5f, 1.0f}) {
    EXPECT_GT(shared(0, value), 0.5) << value;
    EXPECT_LT(shared(1, value), 0.2) << value;
  }
}

TEST(Shadow, ThreadsAndRegionsDoNotChangeAByte) {
  Style style = PlainStyle(Stippled(300, true));
  style.transfer.shadow = ShadowMode::kPaint;
  GuideSet guides = MakeGuides(200, 150, [](int, int) { return glm::vec3(0, 0, 1); });
  guides.Add(Layer::kShadow);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) guides.Plane(Layer::kShadow)[i] = UnitFloat(Hash(i / 7));
  const auto prepared = Prepare(style, 150);
  const PreparedStyle* styles[] = {&*prepared};
  const StyleMap map = MapStyles(guides, {{{1u, StyleMap::kShadowCatcher}}, {}, 0});
  TransferScratch scratch;
  Picture whole, tiled;
  ASSERT_TRUE(Transfer(styles, map, guides, {}, scratch, whole).ok());
  TransferOptions options;
  for (int y = 0; y < 150; y += 23) {
    for (int x = 0; x < 200; x += 31) {
      options.region = Region{x, y, x + 31, y + 23};
      ASSERT_TRUE(Transfer(styles, map, guides, options, scratch, tiled).ok());
    }
  }
  EXPECT_EQ(tiled.rgba, whole.rgba);
}

}  // namespace
}  // namespace scumble
