// The measures of exemplars, against the parameters that they were made with.
#include "measure/paint_traits.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/filter/gaussian_blur.h"
#include "tests/support/painted_spheres.h"

namespace scumble {
namespace {

TEST(PaintTone, PercentilesOfLightness) {
  // Half of the disc is encoded 119 of 255, CIE L* 50.03; the other is white; a single speck is black.
  Picture picture(64, 64);
  for (int i = 0; i < 64 * 64; ++i) SetGrey(picture, i % 64, i / 64, i % 64 < 32 ? 119.0 / 255.0 : 1.0);
  SetGrey(picture, 32, 32, 0.0);
  const Exemplar exemplar = ExemplarOf(picture);
  const PaintSheet sheet(exemplar, 2.0);
  const ToneReport tone = MeasureTone(sheet);
  EXPECT_NEAR(tone.darkest, 50.03, 0.02);
  EXPECT_NEAR(tone.brightest, 100.0, 1e-3);
  EXPECT_NEAR(tone.mean, 75.0, 0.2);
  EXPECT_NEAR(double(sheet.usable_pixels()), 3.14159 * 30 * 30, 30.0);
}

TEST(PaintTone, TheLightThatAPaintingHas) {
  for (const auto& [azimuth, elevation] :
       {std::pair{-40.0, 40.0}, {0.0, 0.0}, {75.0, -20.0}, {150.0, 30.0}, {0.0, 88.0}}) {
    PaintedSphere sphere;
    sphere.size = 256, sphere.azimuth = azimuth, sphere.elevation = elevation;
    const Exemplar exemplar = ExemplarOf(PaintSphere(sphere));
    const PaintedLight light = FindPaintedLight(PaintSheet(exemplar, 2.0));
    SCOPED_TRACE(::testing::Message() << azimuth << ", " << elevation << ": " << light.azimuth << ", "
                                      << light.elevation);
    EXPECT_LT(AngleBetween(light, {azimuth, elevation, 1.0}), azimuth > 90.0 ? 15.0 : 6.0);
    EXPECT_GT(light.correlation, 0.9);
  }
  Picture plain(64, 64);
  for (int i = 0; i < 64 * 64; ++i) SetGrey(plain, i % 64, i / 64, 0.5);
  const Exemplar exemplar = ExemplarOf(plain);
  EXPECT_EQ(FindPaintedLight(PaintSheet(exemplar, 2.0)).correlation, 0.0);
}

// A rim that leaves little of the sphere, or nothing, and pictures without room for one.
TEST(PaintedDisc, NoFringeWhereTheRimTakesAll) {
  for (const int size : {1, 2, 16, 64}) {
    PaintedSphere sphere;
    sphere.size = size, sphere.reach = 0.95;
    const Exemplar exemplar = ExemplarOf(PaintSphere(sphere));
    for (const double rim : {0.0, 0.44 * size, 0.5 * size, 0.6 * size, 16000.0}) {
      const PaintTraits traits = MeasurePaint(exemplar, rim, nullptr);
      if (rim > 0.0 || size == 1) {
        EXPECT_EQ(traits.fringe_percent, 0.0) << size << ", " << rim;
      }
    }
  }
}

TEST(PaintedDisc, CentreAndRadius) {
  for (const auto& [x, y, radius] :
       {std::tuple{0.5, 0.5, 0.5}, {0.52, 0.5, 0.5}, {0.47, 0.51, 0.49}, {0.5, 0.5, 0.4}}) {
    PaintedSphere sphere;
    sphere.x = x, sphere.y = y, sphere.radius = radius, sphere.reach = 1.0, sphere.waver = 0.0;
    const Exemplar exemplar = ExemplarOf(PaintSphere(sphere));
    const PaintSheet sheet(exemplar, 2.0);
    const PaintOnGround paint(sheet);
    ASSERT_TRUE(paint.known());
    const PaintedDisc disc = FindPaintedDisc(paint);
    SCOPED_TRACE(::testing::Message() << x << ", " << y << ", " << radius);
    ASSERT_TRUE(disc.found);
    EXPECT_NEAR(disc.x, 512.0 * x, 1.0);
    EXPECT_NEAR(disc.y, 512.0 * y, 1.0);
    EXPECT_NEAR(disc.radius, 512.0 * radius, 1.0);
  }
}

// Splashes outside and a light side that is left as paper do not pull the circle.
TEST(PaintedDisc, OutlineWithErrors) {
  PaintedSphere sphere;
  sphere.x = 0.49, sphere.radius = 0.45, sphere.reach = 1.0, sphere.waver = 0.0, sphere.light = 0.93,
  sphere.grain = 0.02;
  Picture picture = PaintSphere(sphere);
  for (int i = 0; i < 40; ++i) {
    const int x = static_cast<int>(Hash(i, 1) % 500), y = static_cast<int>(Hash(i, 2) % 40);
    for (int k = 0; k < 64; ++k) SetGrey(picture, x + k % 8, y + k / 8, 0.3);
  }
  const Exemplar exemplar = ExemplarOf(picture);
  const PaintSheet sheet(exemplar, 2.0);
  const PaintedDisc disc = FindPaintedDisc(PaintOnGround(sheet));
  ASSERT_TRUE(disc.found);
  EXPECT_NEAR(disc.x, 0.49 * 512, 1.5);
  EXPECT_NEAR(disc.radius, 0.45 * 512, 1.5);
}

TEST(PaintedDisc, NoCircleWherePaintRunsAsItLikes) {
  PaintedSphere sphere;
  sphere.waver = 0.3, sphere.reach = 1.2;
  const Exemplar wavering = ExemplarOf(PaintSphere(sphere));
  const PaintSheet sheet(wavering, 2.0);
  EXPECT_FALSE(FindPaintedDisc(PaintOnGround(sheet)).found);
  sphere.reach = 2.0, sphere.waver = 0.0;
  const Exemplar full = ExemplarOf(PaintSphere(sphere));
  const PaintSheet full_sheet(full, 2.0);
  const PaintOnGround paint(full_sheet);
  EXPECT_FALSE(paint.known()) << "paint fills the square";
  EXPECT_FALSE(FindPaintedDisc(paint).found);
  EXPECT_EQ(FringeOfRim(paint), 0.0);
}

TEST(PaintedDisc, FringeIsTheBareShareOfTheRim) {
  PaintedSphere sphere;
  sphere.dark = 0.2, sphere.light = 0.5;
  Picture picture = PaintSphere(sphere);
  // Bare beyond 96% of the radius, in a quarter of all directions.
  for (int y = 0; y < 512; ++y) {
    for (int x = 0; x < 512; ++x) {
      if (x >= 256 && y >= 256 && std::hypot(x - 255.5, y - 255.5) > 0.96 * 256) SetGrey(picture, x, y, sphere.paper);
    }
  }
  const Exemplar exemplar = ExemplarOf(picture);
  const PaintSheet sheet(exemplar, 2.0);
  EXPECT_NEAR(FringeOfRim(PaintOnGround(sheet)), 0.25, 0.02);
}

TEST(PaintTraits, CoverageIsPaintAndNotPaper) {
  PaintedSphere sphere;
  sphere.light = 0.6;
  Picture picture = PaintSphere(sphere);
  // A bare square of 100² and a transparent one of 50².
  for (int i = 0; i < 100 * 100; ++i) SetGrey(picture, 150 + i % 100, 150 + i / 100, sphere.paper);
  for (int i = 0; i < 50 * 50; ++i) picture.At(300 + i % 50, 300 + i / 50)[3] = 0;
  const PaintTraits traits = MeasurePaint(ExemplarOf(picture), 2.0, nullptr);
  const double disc = 3.14159265 * 254 * 254;
  EXPECT_NEAR(traits.covered_percent, 100.0 - 100.0 * 12500 / disc, 0.4);
  EXPECT_NEAR(traits.alpha.transparent_percent, 100.0 * 2500 / disc, 0.01);
  EXPECT_EQ(traits.alpha.holes.pixels, 2500u);
  EXPECT_EQ(traits.alpha.holes.count, 1u);
  EXPECT_NEAR(traits.alpha.holes.x, 324.5, 1.0);
  EXPECT_NEAR(traits.alpha.holes.y, 324.5, 1.0);
  EXPECT_FALSE(traits.template_light);
}

TEST(PaintTexture, AnisotropyOfStripesAndOfNoise) {
  const auto measure = [](const auto& tone) {
    Picture picture(512, 512);
    for (int i = 0; i < 512 * 512; ++i) SetGrey(picture, i % 512, i / 512, 0.5 + 0.2 * tone(i % 512, i / 512));
    const Exemplar exemplar = ExemplarOf(picture);
    return MeasureTexture(PaintSheet(exemplar, 2.0));
  };
  EXPECT_GT(measure([](int x, int) { return UnitFloat(Hash(x / 3)); }).anisotropy, 0.99);
  EXPECT_LT(measure([](int x, int y) { return UnitFloat(Hash(x / 3, y / 3)); }).anisotropy, 0.1);
  const TextureReport flat = measure([](int, int) { return 0.0; });
  EXPECT_EQ(flat.anisotropy, 0.0);
  EXPECT_EQ(flat.regularity.windows, 0);
}

TEST(PaintTraits, ScenesAreMeasuredWhereTheirGuidesCover) {
  GuideSet guides(64, 32);
  guides.Add(Layer::kCoverage);
  guides.Add(Layer::kNormal);
  Exemplar exemplar = ExemplarOf(Picture(64, 32));
  for (int i = 0; i < 64 * 32; ++i) {
    SetGrey(exemplar.picture, i % 64, i / 64, i % 64 < 32 ? 119.0 / 255.0 : 1.0);
    guides.Plane(Layer::kCoverage)[std::size_t(i)] = i % 64 < 32 ? 1.0f : 0.0f;
    guides.Plane(Layer::kNormal, 2)[std::size_t(i)] = 1.0f;
  }
  exemplar.guides = guides, exemplar.is_sphere = false;
  const PaintTraits traits = MeasurePaint(exemplar, 2.0, nullptr);
  EXPECT_NEAR(traits.tone.brightest, 50.03, 0.02);
  EXPECT_EQ(traits.covered_percent, 100.0);
  EXPECT_FALSE(traits.disc.found);
}

TEST(Patches, CountPlaceAndSize) {
  // Two patches that touch at a corner only, and a speck.
  const std::vector<std::uint8_t> mask = {1, 1, 0, 0, 0,  //
                                          1, 1, 0, 0, 1,  //
                                          0, 0, 1, 1, 0,  //
                                          0, 0, 1, 1, 0,  //
                                          0, 0, 1, 1, 0};
  const Patches all = FindPatches(mask, 5, 5);
  EXPECT_EQ(all.count, 3u);
  EXPECT_EQ(all.pixels, 11u);
  EXPECT_EQ(all.largest, 6u);
  EXPECT_EQ(all.y, 3);
  const Patches large = FindPatches(mask, 5, 5, 5);
  EXPECT_EQ(large.count, 1u);
  EXPECT_EQ(FindPatches(std::vector<std::uint8_t>(25, 0), 5, 5).count, 0u);
  // A square of 3×3 is full of ones round one pixel only: the middle of the lower patch has 6 of 9.
  const std::vector<std::uint8_t> two_thirds = MostlySet(mask, 5, 5, 1, 6.0 / 9.0);
  for (int i = 0; i < 25; ++i) {
    int set = 0;
    for (int j = 0; j < 9; ++j) {
      const int x = i % 5 + j % 3 - 1, y = i / 5 + j / 3 - 1;
      set += x >= 0 && y >= 0 && x < 5 && y < 5 && mask[std::size_t(y * 5 + x)];
    }
    EXPECT_EQ(two_thirds[std::size_t(i)] != 0, set >= 6) << i;
  }
}

}  // namespace
}  // namespace scumble
