// The circle of the paint, and the bare share of its rim, against the spheres that were painted.
#include "measure/painting/painted_disc.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "core/image/hash.h"
#include "measure/paint_traits.h"
#include "tests/support/painted_spheres.h"

namespace scumble {
namespace {

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

}  // namespace
}  // namespace scumble
