// Watercolour: densities against their formula.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "finish/area/noise.h"
#include "tests/finish/finish_fixtures.h"

namespace scumble {
namespace {

PigmentPass Nothing() {
  PigmentPass pass;
  pass.edge = pass.turbulence = pass.granulation = pass.thin = pass.tremor = 0.0;
  return pass;
}

TEST(Pigment, OfDensityOneChangesNoByte) {
  const GuideSet guides = BallGuides(60, 20.0f);
  const Picture picture = ColorfulPicture(60, 60);
  EXPECT_EQ(Finished(StepOf(Nothing()), &guides, picture).rgba, picture.rgba);
}

TEST(Pigment, LeavesWhiteWhiteAndBlackBlack) {
  const GuideSet guides = BallGuides(60, 20.0f);
  PigmentPass pass;
  pass.thin = 0.0;
  for (const std::uint16_t code : {std::uint16_t{0}, std::uint16_t{65535}}) {
    const Picture plain = PlainPicture(60, 60, code, code, code);
    EXPECT_EQ(Finished(StepOf(pass), &guides, plain).rgba, plain.rgba);
  }
}

// density = 1 + edge · x e^(1-x), x the distance to the border over half the width.
TEST(Pigment, GathersInsideBordersAsItsFormulaSays) {
  GuideSet guides = FlatGuides(80, 40);
  for (int y = 0; y < 40; ++y) {
    for (int x = 40; x < 80; ++x) guides.Plane(Layer::kObject)[guides.Index(x, y)] = 2.0f;
  }
  PigmentPass pass = Nothing();
  pass.edge = 0.8, pass.edge_width = 12.0;
  const double c = 0.6;
  const auto code = static_cast<std::uint16_t>(c * 65535.0 + 0.5);
  const Picture made = Finished(StepOf(pass), &guides, PlainPicture(80, 40, code, code, code));
  for (int x = 0; x < 80; ++x) {
    const double distance = x < 40 ? 39.5 - x + 0.5 : x - 39.5;  // of the middle of the pixel to x = 40
    const double at = (x < 40 ? 40.0 - (x + 0.5) : x + 0.5 - 40.0) / 6.0;
    const double density = 1.0 + 0.8 * at * std::exp(1.0 - at);
    EXPECT_NEAR(made.At(x, 20)[0] / 65535.0, c * (1.0 - (1.0 - c) * (density - 1.0)), 2e-5) << x << ' ' << distance;
  }
  EXPECT_LT(made.At(34, 20)[0], made.At(39, 20)[0]) << "darkest inside, not on the border";
  EXPECT_LT(made.At(34, 20)[0], made.At(20, 20)[0]);
}

TEST(Pigment, LiesThinnerInLight) {
  PigmentPass pass = Nothing();
  pass.thin = 0.5;
  const Picture made = Finished(StepOf(pass), nullptr, PlainPicture(4, 4, 32768, 16384, 0));
  // density = 1 - 0.5 · 0.5
  for (const auto& [channel, c] : {std::pair(0, 32768 / 65535.0), {1, 16384 / 65535.0}})
    EXPECT_NEAR(made.At(1, 1)[channel] / 65535.0, c * (1.0 + (1.0 - c) * 0.5 * 32768 / 65535.0), 2e-5);
}

TEST(Pigment, TremblesNoFurtherThanItSays) {
  const GuideSet guides = BallGuides(120, 40.0f);
  Picture picture(120, 120);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    const auto alpha = static_cast<std::uint16_t>(guides.Plane(Layer::kCoverage)[i] * 65535.0f);
    if (alpha > 0) picture.rgba[4 * i] = 50000;
    picture.rgba[4 * i + 3] = alpha;
  }
  PigmentPass pass = Nothing();
  pass.tremor = 4.0, pass.tremor_size = 16.0;
  const Picture made = Finished(StepOf(pass), &guides, picture);
  double furthest = 0.0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 120; ++x) {
      const double radius = std::hypot(x - 59.5, y - 59.5);
      const bool full = made.At(x, y)[3] == 65535, clear = made.At(x, y)[3] == 0;
      if (full) {
        EXPECT_EQ(made.At(x, y)[0], 50000);
      }
      if (full != (radius < 40.0) || clear != (radius >= 40.0)) furthest = std::max(furthest, std::fabs(radius - 40.0));
    }
  }
  EXPECT_LT(furthest, 4.0 * std::sqrt(2.0) + 1.5);
  EXPECT_GT(furthest, 1.5);
}

// A plane that slides through the picture: its noise slides along.
TEST(SurfaceNoise, GoesWhereTheSurfaceGoes) {
  const auto guides_at = [](float shift, float depth) {
    GuideSet guides = FlatGuides(160, 48);
    guides.Add(Layer::kPref);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 160; ++x) {
        const std::size_t i = guides.Index(x, y);
        guides.Plane(Layer::kDepth)[i] = depth;
        guides.Plane(Layer::kPref, 0)[i] = (static_cast<float>(x) - shift) * 0.01f * depth;
        guides.Plane(Layer::kPref, 1)[i] = static_cast<float>(y) * 0.01f * depth;
        guides.Plane(Layer::kPref, 2)[i] = 0.3f;
      }
    }
    return guides;
  };
  const GuideSet still = guides_at(0.0f, 4.0f), moved = guides_at(17.0f, 4.0f);
  const internal::SurfaceScale surface(still), later(moved);
  const internal::NoiseField one(3, 20.0, &surface, 160, 48), other(3, 20.0, &later, 160, 48);
  float least = 1.0f, most = -1.0f;
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x + 17 < 160; ++x) {
      EXPECT_NEAR(one.At(x, y), other.At(x + 17, y), 2e-3);
      least = std::min(least, one.At(x, y)), most = std::max(most, one.At(x, y));
    }
  }
  EXPECT_LT(least, -0.3f);
  EXPECT_GT(most, 0.3f);
  // Twice as far, waves are as long in the picture: as many changes of sign, give or take.
  const auto changes = [](const internal::NoiseField& field) {
    int count = 0;
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x + 1 < 160; ++x) count += (field.At(x, y) > 0.0f) != (field.At(x + 1, y) > 0.0f);
    }
    return count;
  };
  const GuideSet far = guides_at(0.0f, 8.0f);
  const internal::SurfaceScale from_far(far);
  const internal::NoiseField small(3, 20.0, &from_far, 160, 48);
  EXPECT_NEAR(double(changes(small)) / changes(one), 1.0, 0.35);
}

TEST(SurfaceNoise, OfThePictureHasNoSeams) {
  const internal::NoiseField field(9, 13.0, nullptr, 301, 77);
  for (int y = 0; y < 77; ++y) {
    for (int x = 0; x + 1 < 301; ++x) {
      const float value = field.At(x, y);
      EXPECT_LE(std::fabs(value), 1.0f);
      EXPECT_LT(std::fabs(value - field.At(x + 1, y)), 0.3f);
      EXPECT_NEAR(value, internal::Noise(9, glm::vec2((x + 0.5f) / 13.0f, (y + 0.5f) / 13.0f)), 1e-4f);
    }
  }
}

}  // namespace
}  // namespace scumble
