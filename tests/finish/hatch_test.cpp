// Hatching: how much ink there is, which way strokes run, and what they leave alone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/image/color.h"
#include "core/io/picture_file.h"
#include "tests/finish/finish_fixtures.h"

namespace scumble {
namespace {

// White paper with black ink: the share of ink by pixel.
std::vector<double> HatchOf(HatchPass pass, const GuideSet& guides, double scale = 1.0) {
  pass.ink = {0, 0, 0};
  const Picture made =
      Finished(StepOf(pass), &guides, PlainPicture(guides.width(), guides.height(), 65535, 65535, 65535), {}, 0, scale);
  std::vector<double> ink;
  for (std::size_t i = 0; i < made.rgba.size(); i += 4) ink.push_back(1.0 - made.rgba[i] / 65535.0);
  return ink;
}

double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / double(values.size());
}

// Flat, in a light whose lightness is `tone`.
GuideSet FlatInLight(double tone, int size = 300) {
  GuideSet guides = FlatGuides(size, size);
  for (float& value : guides.Plane(Layer::kLuminance)) value = static_cast<float>(tone * tone * tone);
  return guides;
}

TEST(Hatch, InkIsWhatTheToneLacks) {
  for (const double tone : {0.95, 0.7, 0.5, 0.3, 0.1}) {
    for (const int layers : {1, 2, 3}) {
      HatchPass pass;
      pass.layers = layers, pass.wobble = 0.0, pass.angle = 27.0;
      EXPECT_NEAR(Mean(HatchOf(pass, FlatInLight(tone))), 1.0 - tone, 0.01) << tone << ' ' << layers;
    }
  }
}

TEST(Hatch, ThinLinesAndThinGapsKeepTheirShare) {
  HatchPass pass;
  pass.layers = 1, pass.wobble = 0.0, pass.angle = 13.0, pass.spacing = 2.5;
  for (const double tone : {0.9, 0.5, 0.08})
    EXPECT_NEAR(Mean(HatchOf(pass, FlatInLight(tone))), 1.0 - tone, 0.01) << tone;
}

TEST(Hatch, LightAboveTheLimitIsBare) {
  HatchPass pass;
  pass.bare = 0.6;
  EXPECT_EQ(Mean(HatchOf(pass, FlatInLight(0.65))), 0.0);
  EXPECT_GT(Mean(HatchOf(pass, FlatInLight(0.5))), 0.1);
  EXPECT_EQ(Mean(HatchOf({}, FlatInLight(1.0))), 0.0);
}

TEST(Hatch, DarknessIsFull) { EXPECT_NEAR(Mean(HatchOf({}, FlatInLight(0.0))), 1.0, 1e-3); }

TEST(Hatch, LessShadeLeavesPaperInTheDeepest) {
  HatchPass pass;
  pass.shade = 0.9;
  EXPECT_NEAR(Mean(HatchOf(pass, FlatInLight(0.0))), 0.9, 0.01);
}

// How much the ink changes from a pixel to one `dx`, `dy` away.
double Change(const std::vector<double>& ink, int width, int height, int dx, int dy) {
  double sum = 0.0;
  int count = 0;
  for (int y = 20; y < height - 20; ++y) {
    for (int x = 20; x < width - 20; ++x, ++count) {
      sum += std::fabs(ink[std::size_t(y * width + x)] - ink[std::size_t((y + dy) * width + x + dx)]);
    }
  }
  return sum / count;
}

// A cylinder over the whole picture whose axis is at 45 degrees, rising to the right (sign 1) or falling.
GuideSet Cylinder(int size, float sign) {
  GuideSet guides = GuidesOf(size, size, [=](glm::vec2 at) {
    const float across = ((at.x - float(size) / 2) + sign * (at.y - float(size) / 2)) / (1.5f * float(size));
    const float z = std::sqrt(std::max(0.0f, 1.0f - across * across));
    const float h = std::sqrt(0.5f);
    return SeenPoint{true, {across * h, -sign * across * h, z}, 5.0f, 1.0f};
  });
  guides.Add(Layer::kLuminance);
  for (float& value : guides.Plane(Layer::kLuminance)) value = 0.125f;
  return guides;
}

// Directions from lengths instead of a tensor, atan2(|n(x, y + 1) - n|, |n(x + 1, y) - n|), are one for both cylinders.
TEST(Hatch, LengthsOfDifferencesDoNotTellCylindersApart) {
  const auto angle = [](const GuideSet& guides) {
    const glm::vec3 here = guides.Vec3(Layer::kNormal, guides.Index(90, 100));
    const glm::vec3 right = guides.Vec3(Layer::kNormal, guides.Index(91, 100));
    const glm::vec3 below = guides.Vec3(Layer::kNormal, guides.Index(90, 101));
    return std::atan2(glm::length(below - here), glm::length(right - here));
  };
  EXPECT_NEAR(angle(Cylinder(200, 1.0f)), angle(Cylinder(200, -1.0f)), 1e-2);
}

TEST(Hatch, CylindersThatLeanTheOtherWayAreHatchedTheOtherWay) {
  HatchPass pass;
  pass.layers = 1, pass.wobble = 0.0, pass.angle = 0.0, pass.spacing = 8.0, pass.patch = 1000.0;
  for (const float sign : {1.0f, -1.0f}) {
    const GuideSet guides = Cylinder(200, sign);
    const int along = sign > 0 ? -4 : 4;  // the axis: where x rises, y falls
    pass.along = HatchPass::Along::kAlong;
    const auto strokes = HatchOf(pass, guides);
    EXPECT_LT(Change(strokes, 200, 200, 4, along), 0.2 * Change(strokes, 200, 200, 4, -along)) << sign;
    pass.along = HatchPass::Along::kAround;
    const auto rings = HatchOf(pass, guides);
    EXPECT_LT(Change(rings, 200, 200, 4, -along), 0.2 * Change(rings, 200, 200, 4, along)) << sign;
  }
}

// Light that falls off to the right, and a floor that goes away upwards.
TEST(Hatch, GoesByLightOrDepth) {
  GuideSet guides = FlatInLight(0.5);
  for (int y = 0; y < 300; ++y) {
    for (int x = 0; x < 300; ++x) {
      const float tone = 0.7f - 0.4f * float(x) / 300.0f;
      guides.Plane(Layer::kLuminance)[guides.Index(x, y)] = tone * tone * tone;
      guides.Plane(Layer::kDepth)[guides.Index(x, y)] = 1000.0f / (100.0f + float(y));
    }
  }
  HatchPass pass;
  pass.layers = 1, pass.wobble = 0.0, pass.spacing = 8.0, pass.angle = 45.0;
  for (const bool stick : {false, true}) {
    if (stick) {
      guides.Add(Layer::kPref);
      for (std::size_t i = 0; i < guides.pixel_count(); ++i)
        guides.Plane(Layer::kPref, 0)[i] = float(i % 300), guides.Plane(Layer::kPref, 1)[i] = -float(i / 300);
    }
    pass.stick = stick;
    pass.along = HatchPass::Along::kLight;
    const auto by_light = HatchOf(pass, guides);
    EXPECT_LT(Change(by_light, 300, 300, 4, 0), 0.5 * Change(by_light, 300, 300, 0, 4)) << stick;
    pass.along = HatchPass::Along::kDepth;
    const auto by_depth = HatchOf(pass, guides);
    EXPECT_LT(Change(by_depth, 300, 300, 0, 4), 0.5 * Change(by_depth, 300, 300, 4, 0)) << stick;
  }
}

// A wall that moves by eleven pixels takes its strokes along.
TEST(Hatch, SticksToSurfaces) {
  constexpr int kMove = 11;
  const auto moved = [](int by) {
    GuideSet guides = FlatInLight(0.5);
    guides.Add(Layer::kPref);
    for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
      guides.Plane(Layer::kPref, 0)[i] = 0.01f * (float(i % 300) - float(by));
      guides.Plane(Layer::kPref, 1)[i] = -0.01f * float(i / 300);
    }
    return guides;
  };
  const GuideSet before = moved(0), after = moved(kMove);
  const auto difference = [&](const HatchPass& pass) {
    const auto from = HatchOf(pass, before), to = HatchOf(pass, after);
    double sum = 0.0;
    int count = 0;
    for (int y = 0; y < 300; ++y) {
      for (int x = 60; x + 60 < 300; ++x, ++count)
        sum += std::fabs(from[std::size_t(y * 300 + x)] - to[std::size_t(y * 300 + x + kMove)]);
    }
    return sum / count;
  };
  HatchPass pass;
  const double loose = difference(pass);
  pass.stick = true;
  EXPECT_LT(difference(pass), 0.05 * loose);
  EXPECT_NEAR(Mean(HatchOf(pass, before)), 0.5, 0.02) << "as much ink as ever";
}

// Twice as much, or none.
TEST(Hatch, ShadeIsWhatTheLightLacks) {
  HatchPass pass;
  pass.wobble = 0.0, pass.angle = 27.0;
  for (const auto& [shade, ink] : {std::pair(0.0, 0.0), {0.5, 0.2}, {1.0, 0.4}, {2.0, 1.0 - 0.36}}) {
    pass.shade = shade;
    EXPECT_NEAR(Mean(HatchOf(pass, FlatInLight(0.6))), ink, 0.01) << shade;
  }
}

TEST(Hatch, FlatSurfacesTakeTheAngle) {
  HatchPass pass;
  pass.layers = 1, pass.wobble = 0.0, pass.angle = 90.0;
  const auto ink = HatchOf(pass, FlatInLight(0.5));
  EXPECT_EQ(Change(ink, 300, 300, 0, 5), 0.0);
  EXPECT_GT(Change(ink, 300, 300, 4, 0), 0.1);
}

// Two faces of one object, with a crease or a round edge of four pixels between them, have one direction each, up to
// the edge; so has the lid of a cylinder.
TEST(Hatch, EdgesOfFlatFacesDoNotTurnTheirStrokes) {
  HatchPass pass, fixed;
  fixed.along = HatchPass::Along::kFixed;
  const auto lit = [](GuideSet guides) {
    guides.Add(Layer::kLuminance);
    for (float& value : guides.Plane(Layer::kLuminance)) value = 0.125f;
    return guides;
  };
  for (const float round : {0.001f, 4.0f}) {
    const GuideSet faces = lit(GuidesOf(300, 100, [=](glm::vec2 at) {
      const float turn = 0.8f * std::clamp((at.x - 150.0f - 0.2f * at.y) / round, -1.0f, 1.0f);
      return SeenPoint{true, {std::sin(turn), 0.0f, std::cos(turn)}, 5.0f, 1.0f};
    }));
    const auto ink = HatchOf(pass, faces), plain = HatchOf(fixed, faces);
    for (std::size_t i = 0; i < ink.size(); ++i) {
      const float across = std::fabs(float(i % 300) - 150.0f - 0.2f * float(i / 300));
      if (across > round + 2.0f) {
        ASSERT_EQ(ink[i], plain[i]) << i % 300 << ' ' << i / 300;
      }
    }
  }
  const GuideSet can = lit(GuidesOf(300, 200, [](glm::vec2 at) {
    if (at.y < 100.0f) return SeenPoint{true, {0.0f, 0.9f, 0.436f}, 5.0f, 1.0f};
    const float x = (at.x - 150.0f) / 151.0f;
    return SeenPoint{true, {x, 0.0f, std::sqrt(1.0f - x * x)}, 5.0f, 1.0f};
  }));
  const auto ink = HatchOf(pass, can), plain = HatchOf(fixed, can);
  double side = 0.0;
  for (std::size_t i = 0; i < ink.size(); ++i) {
    // Where a patch shows little of the lid, that takes the directions of the side.
    if (i < 300 * 60) {
      ASSERT_EQ(ink[i], plain[i]) << i % 300 << ' ' << i / 300;
    }
    side += std::fabs(ink[i] - plain[i]) / (300.0 * 100.0);
  }
  EXPECT_GT(side, 0.2);
}

TEST(Hatch, ObjectsHaveTheirOwnPatches) {
  GuideSet guides = Cylinder(200, 1.0f);
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    if (i % 200 < 100) continue;
    guides.Plane(Layer::kObject)[i] = 2.0f;
    for (int c = 0; c < 3; ++c) guides.Plane(Layer::kNormal, c)[i] = c == 2 ? 1.0f : 0.0f;
  }
  HatchPass pass;
  pass.layers = 1, pass.wobble = 0.0, pass.angle = 0.0, pass.patch = 1000.0;
  const auto ink = HatchOf(pass, guides);
  double flat = 0.0, bent = 0.0;
  for (int x = 0; x < 90; ++x) {
    bent += std::fabs(ink[std::size_t(100 * 200 + x)] - ink[std::size_t(100 * 200 + x + 4)]);
    flat += std::fabs(ink[std::size_t(100 * 200 + x + 104)] - ink[std::size_t(100 * 200 + x + 108)]);
  }
  EXPECT_EQ(flat, 0.0) << "along a row";
  EXPECT_GT(bent, 10.0);
}

TEST(Hatch, LooksAtPaintToo) {
  GuideSet guides = FlatGuides(100, 100);
  HatchPass pass;
  pass.tone = HatchPass::Tone::kPaint, pass.along = HatchPass::Along::kFixed, pass.ink = {0, 0, 0};
  const Picture white = PlainPicture(100, 100, 65535, 65535, 65535);
  EXPECT_EQ(Finished(StepOf(pass), nullptr, white).rgba, white.rgba);
  const Picture grey = PlainPicture(100, 100, 20000, 20000, 20000);
  EXPECT_NE(Finished(StepOf(pass), nullptr, grey).rgba, grey.rgba);
}

// How much the ink of a picture of half the size differs from the mean of four pixels of the whole one, by pixel.
double ChangeAtHalfSize(const HatchPass& pass, const GuideSet& whole, const GuideSet& half) {
  const auto large = HatchOf(pass, whole), small = HatchOf(pass, half, 0.5);
  const auto width = std::size_t(half.width());
  double sum = 0.0;
  for (std::size_t i = 0; i < small.size(); ++i) {
    const double* const at = large.data() + 4 * width * (i / width) + 2 * (i % width);
    sum += std::fabs(small[i] - 0.25 * (at[0] + at[1] + at[2 * width] + at[2 * width + 1]));
  }
  return sum / double(small.size());
}

// A ball in grey light, whose normals turn in all directions.
GuideSet HatchedBall(int size) {
  GuideSet guides = BallGuides(size, 0.45f * static_cast<float>(size));
  guides.Add(Layer::kLuminance);
  for (float& value : guides.Plane(Layer::kLuminance)) value = 0.125f;
  return guides;
}

TEST(Hatch, HalfTheSizeHasTheSameStrokesAtTheSamePlaces) {
  for (const double spacing : {7.0, 5.0, 2.5}) {
    HatchPass pass;
    pass.spacing = spacing;
    EXPECT_LT(ChangeAtHalfSize(pass, HatchedBall(1000), HatchedBall(500)), 0.02) << spacing;
  }
}

// Slanted strokes are seen through the pixel's square, not through a strip as wide as its side.
TEST(Hatch, HalfTheSizeHasTheSameSlantedStrokes) {
  for (const double angle : {0.0, 20.0, 45.0, 70.0}) {
    HatchPass pass;
    pass.along = HatchPass::Along::kFixed, pass.angle = angle, pass.layers = 1, pass.wobble = 0.0;
    EXPECT_LT(ChangeAtHalfSize(pass, FlatInLight(0.6), FlatInLight(0.6, 150)), 0.016) << angle;
  }
}

std::shared_ptr<const HatchTexture> Bundled(const std::string& tool) {
  const Expected<Picture> picture = ReadPicture(SCUMBLE_SOURCE_DIR "/finish/hatching/" + tool + ".png");
  EXPECT_TRUE(picture) << tool;
  Expected<HatchTexture> texture = MakeHatchTexture(*picture);
  EXPECT_TRUE(texture) << tool;
  return std::make_shared<const HatchTexture>(*std::move(texture));
}

// Over a square of whole tiles: as much ink as the tone lacks, from every size of the texture. The smallest is seen by
// few samples.
TEST(HatchTexture, InkIsWhatTheToneLacks) {
  for (const char* const tool : {"pencil", "pen", "charcoal"}) {
    HatchPass pass;
    pass.along = HatchPass::Along::kFixed;
    pass.texture = Bundled(tool), pass.layers = 1, pass.wobble = 0.0, pass.angle = 0.0;
    for (const double spacing : {300.0 / 24.0, 150.0 / 24.0, 75.0 / 24.0}) {
      pass.spacing = spacing;
      for (const double tone : {0.97, 0.85, 0.5, 0.2, 0.05})
        EXPECT_NEAR(Mean(HatchOf(pass, FlatInLight(tone))), 1.0 - tone, spacing > 4.0 ? 0.01 : 0.02)
            << tool << spacing << ' ' << tone;
    }
  }
}

TEST(HatchTexture, HalfTheSizeHasTheSameStrokesAtTheSamePlaces) {
  for (const char* const tool : {"pencil", "pen", "charcoal"}) {
    HatchPass pass;
    pass.texture = Bundled(tool), pass.spacing = 13.0;
    EXPECT_LT(ChangeAtHalfSize(pass, HatchedBall(600), HatchedBall(300)), 0.04) << tool;
  }
}

// Both sizes look at the texture at the same places.
TEST(HatchTexture, HalfTheSizeHasTheSameSlantedStrokes) {
  for (const char* const tool : {"pencil", "pen", "charcoal"}) {
    for (const double angle : {0.0, 20.0, 45.0}) {
      HatchPass pass;
      pass.texture = Bundled(tool), pass.spacing = 13.0, pass.wobble = 0.0;
      pass.along = HatchPass::Along::kFixed, pass.angle = angle, pass.layers = 1;
      EXPECT_LT(ChangeAtHalfSize(pass, FlatInLight(0.6), FlatInLight(0.6, 150)), 0.002) << tool << angle;
    }
  }
}

TEST(HatchTexture, DarkerTonesKeepTheStrokesOfLighterOnes) {
  HatchPass pass;
  pass.texture = Bundled("pencil"), pass.layers = 1;
  const auto light = HatchOf(pass, FlatInLight(0.8)), dark = HatchOf(pass, FlatInLight(0.5));
  for (std::size_t i = 0; i < light.size(); ++i) ASSERT_GE(dark[i], light[i] - 1e-4);
}

TEST(HatchTexture, StrokesRunInTheDirectionOfTheirAngle) {
  HatchPass pass;
  pass.along = HatchPass::Along::kFixed;
  pass.texture = Bundled("pen"), pass.layers = 1, pass.wobble = 0.0, pass.spacing = 10.0;
  const GuideSet guides = FlatInLight(0.8);
  const auto change = [&](double angle, int dx, int dy) {
    pass.angle = angle;
    const auto ink = HatchOf(pass, guides);
    double sum = 0.0;
    for (int y = 10; y < 290; ++y) {
      for (int x = 10; x < 290; ++x)
        sum += std::fabs(ink[std::size_t(y * 300 + x)] - ink[std::size_t((y + dy) * 300 + x + dx)]);
    }
    return sum;
  };
  EXPECT_LT(3.0 * change(0.0, 3, 0), change(0.0, 0, 3));
  EXPECT_LT(3.0 * change(90.0, 0, 3), change(90.0, 3, 0));
  EXPECT_LT(3.0 * change(45.0, 2, -2), change(45.0, 2, 2)) << "rows count downwards";
}

TEST(HatchTexture, MustBeASquare) {
  for (const Picture& picture : {Picture(64, 32), Picture(8, 8), Picture()}) {
    const auto made = MakeHatchTexture(picture);
    ASSERT_FALSE(made);
    EXPECT_THAT(made.error().message, ::testing::HasSubstr("expected a square"));
  }
}

// Black strokes whose shape is in alpha alone, and the same strokes on white.
TEST(HatchTexture, TransparencyIsWhite) {
  Picture clear(64, 64), white = PlainPicture(64, 64, 65535, 65535, 65535);
  for (std::size_t i = 0; i < clear.rgba.size(); i += 4) {
    const auto ink = static_cast<std::uint16_t>(257u * ((i / 4 / 64 * 4) % 256));
    clear.rgba[i + 3] = ink;
    std::fill_n(white.rgba.data() + i, 3, static_cast<std::uint16_t>(65535 - ink));
  }
  const auto of_alpha = MakeHatchTexture(clear), of_grey = MakeHatchTexture(white);
  ASSERT_TRUE(of_alpha && of_grey);
  EXPECT_EQ(of_alpha->levels[0].thresholds, of_grey->levels[0].thresholds);
}

TEST(HatchTexture, OneGreyShowsNoStrokes) {
  for (const Picture& picture : {PlainPicture(17, 17, 5, 5, 5), Picture(32, 32)}) {
    const auto made = MakeHatchTexture(picture);
    ASSERT_FALSE(made);
    EXPECT_THAT(made.error().message, ::testing::HasSubstr("one grey all over"));
  }
}

}  // namespace
}  // namespace scumble
