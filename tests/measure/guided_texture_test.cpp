// The texture distance of pictures whose order is known: what spoils paint raises it.
#include "measure/guided_texture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/measure/energy_fixtures.h"

namespace scumble::testing {
namespace {

constexpr int kSize = 256;

// Smooth noise of strokes `width` pixels wide and three times as long, 0 … 1.
double Stroke(std::uint64_t seed, double x, double y, double width) {
  const double along = (0.8 * x + 0.6 * y) / (3.0 * width), across = (0.8 * y - 0.6 * x) / width;
  const int i = int(std::floor(along)), j = int(std::floor(across));
  const auto at = [&](int a, int b) { return double(Hash(seed, i + a, j + b) % 1000) / 999.0; };
  const auto smooth = [](double t) { return t * t * (3.0 - 2.0 * t); };
  const double u = smooth(along - i), v = smooth(across - j);
  return (1 - v) * ((1 - u) * at(0, 0) + u * at(1, 0)) + v * ((1 - u) * at(0, 1) + u * at(1, 1));
}

// Paint on a ball, lighter where it faces right.
std::array<int, 3> PaintAt(std::uint64_t seed, int x, int y, double width) {
  const double tone = 0.25 + 0.4 * x / kSize + 0.25 * Stroke(seed, x, y, width);
  return {int(65535 * tone), int(60000 * tone), int(40000 * tone)};
}

EnergyScene PaintedBall(std::uint64_t seed, double width = 6.0) {
  EnergyScene ball = Ball(kSize);
  ball.Paint([&](int x, int y) { return PaintAt(seed, x, y, width); });
  return ball;
}

GuidedTexture MustPrepare(const EnergyScene& exemplar) {
  const EnergyExemplar one = exemplar.Exemplar();
  auto texture = GuidedTexture::Of({&one, 1});
  EXPECT_TRUE(texture.ok());
  return *std::move(texture);
}

GuidedTextureReport MustMeasure(const GuidedTexture& texture, const EnergyScene& target, int threads = 0) {
  const std::vector<float> surface(target.coverage.size(), 1.0f);
  const auto report = texture.Measure(target.Target(), surface, threads);
  EXPECT_TRUE(report.ok()) << (report.ok() ? "" : report.error().message);
  return report.ok() ? *report : GuidedTextureReport{};
}

// The same with the colours of change(x, y).
template <class Change>
double DistanceOf(const GuidedTexture& texture, const Change& change) {
  EnergyScene ball = Ball(kSize);
  ball.Paint(change);
  return MustMeasure(texture, ball).distance;
}

TEST(GuidedTexture, AnExemplarHasItsOwnTexture) {
  const EnergyScene exemplar = PaintedBall(1);
  const GuidedTextureReport report = MustMeasure(MustPrepare(exemplar), exemplar);
  EXPECT_EQ(report.distance, 0.0);
  EXPECT_EQ(report.tone, 0.0);
  for (const double octave : report.strokes) EXPECT_EQ(octave, 0.0);
  EXPECT_GT(report.measured, 40000u);
}

TEST(GuidedTexture, HalvesThatAreTooSmallHaveNoDifference) {
  EnergyScene exemplar = PaintedBall(1);
  std::fill(exemplar.usable.begin(), exemplar.usable.end(), std::uint8_t{0});
  EXPECT_FALSE(MustPrepare(exemplar).floor());
}

// Other strokes of one kind differ by what two halves of the exemplar differ by; everything that spoils them by more.
TEST(GuidedTexture, WhatSpoilsPaintCosts) {
  const EnergyScene exemplar = PaintedBall(1);
  const GuidedTexture texture = MustPrepare(exemplar);
  const double other = MustMeasure(texture, PaintedBall(2)).distance;
  EXPECT_GT(other, 0.0);
  EXPECT_LT(other, 1.5 * texture.floor().value());
  const auto tone_alone = [](int x, int) {
    const double tone = 0.375 + 0.4 * x / kSize;
    return std::array<int, 3>{int(65535 * tone), int(60000 * tone), int(40000 * tone)};
  };
  EXPECT_GT(DistanceOf(texture, tone_alone), 1.7 * other) << "no strokes";
  EXPECT_GT(MustMeasure(texture, PaintedBall(2, 3.0)).distance, 1.8 * other) << "strokes of half the size";
  EXPECT_GT(MustMeasure(texture, PaintedBall(2, 12.0)).distance, 1.1 * other) << "strokes of twice the size";
  const auto turned = [](int x, int y) { return PaintAt(2, x, kSize - 1 - y, 6.0); };
  EXPECT_GT(DistanceOf(texture, turned), 1.5 * other) << "strokes of another direction";
  const auto lighter = [](int x, int y) {
    auto color = PaintAt(2, x, y, 6.0);
    for (int& channel : color) channel = std::min(65535, channel + 9000);
    return color;
  };
  EXPECT_GT(DistanceOf(texture, lighter), 1.5 * other) << "another tone";
  const auto noisy = [](int x, int y) {
    auto color = PaintAt(2, x, y, 6.0);
    for (int& channel : color) channel = std::clamp(channel + int(Hash(5, x, y) % 8000) - 4000, 0, 65535);
    return color;
  };
  EXPECT_GT(DistanceOf(texture, noisy), 1.5 * other) << "noise";
  // Tiles of 16 pixels, each from elsewhere: where they meet the strokes are cut.
  const auto mosaic = [](int x, int y) {
    const int dx = int(Hash(6, x / 16, y / 16) % 64), dy = int(Hash(7, x / 16, y / 16) % 64);
    const double tone = 0.25 + 0.4 * x / kSize + 0.25 * Stroke(2, x + dx, y + dy, 6.0);
    return std::array<int, 3>{int(65535 * tone), int(60000 * tone), int(40000 * tone)};
  };
  EXPECT_GT(DistanceOf(texture, mosaic), 1.3 * other) << "cut strokes";
}

// Dabs of one lightness, in red and green: what blurs them shows in colour alone.
TEST(GuidedTexture, DabsOfOneLightnessAreSharpToo) {
  const auto dab = [](std::uint64_t seed, int x, int y) {
    const double share = Stroke(seed, x, y, 2.5) > 0.5 ? 1.0 : 0.0;
    return std::array<double, 3>{26000.0 + 14000.0 * share, 33000.0 - 8000.0 * share, 20000.0};
  };
  const auto of = [&](std::uint64_t seed, int reach) {
    EnergyScene ball = Ball(kSize);
    ball.Paint([&](int x, int y) {
      std::array<double, 3> sum = {};
      for (int v = y - reach; v <= y + reach; ++v) {
        for (int u = x - reach; u <= x + reach; ++u) {
          const auto one = dab(seed, u, v);
          for (std::size_t c = 0; c < 3; ++c) sum[c] += one[c] / ((2 * reach + 1) * (2 * reach + 1));
        }
      }
      return std::array<int, 3>{int(sum[0]), int(sum[1]), int(sum[2])};
    });
    return ball;
  };
  const GuidedTexture texture = MustPrepare(of(1, 0));
  const GuidedTextureReport sharp = MustMeasure(texture, of(2, 0)), blurred = MustMeasure(texture, of(2, 1));
  EXPECT_GT(blurred.strokes[0], 1.5 * sharp.strokes[0]);
  EXPECT_GT(blurred.distance, 1.2 * sharp.distance);
}

// A wall with the exemplar's paint does not hide that a ball before it has none, though it has five times the pixels.
TEST(GuidedTexture, FormsCountBesideWalls) {
  const GuidedTexture texture = MustPrepare(PaintedBall(1));
  constexpr int kBall = 120;
  const EnergyScene ball = Ball(kBall);
  const auto of = [&](bool has_wall) {
    EnergyScene scene(kSize, kSize);
    std::vector<float> surface(scene.coverage.size());
    const auto on_ball = [&](int x, int y) { return x < kBall && y < kBall && ball.coverage[ball.Index(x, y)] > 0.0f; };
    scene.ForEach([&](int x, int y) {
      const bool is_ball = on_ball(x, y);
      surface[scene.Index(x, y)] = is_ball ? 1.0f : 2.0f;
      scene.coverage[scene.Index(x, y)] = is_ball || has_wall;
      scene.SetNormal(x, y, is_ball ? glm::vec3(ball.Normal(x, y)) : glm::vec3(0.5f, 0.0f, std::sqrt(0.75f)));
    });
    scene.Paint([&](int x, int y) {
      const double tone = on_ball(x, y) ? 0.375 + 0.4 * x / kBall : 0.55 + 0.25 * Stroke(3, x, y, 6.0);
      return std::array<int, 3>{int(65535 * tone), int(60000 * tone), int(40000 * tone)};
    });
    const auto report = texture.Measure(scene.Target(), surface);
    EXPECT_TRUE(report.ok());
    return report.ok() ? report->distance : 0.0;
  };
  const double alone = of(false), before_wall = of(true);
  EXPECT_LT(before_wall, alone);
  EXPECT_GT(before_wall, 0.5 * alone);
}

// The paint of a flat wall that is turned like a place of the ball is what that place shows, not the whole ball's.
TEST(GuidedTexture, PaintIsComparedWhereTheSurfaceIsTurnedAlike) {
  const EnergyScene exemplar = PaintedBall(1);
  const GuidedTexture texture = MustPrepare(exemplar);
  EnergyScene wall(200, 200);
  wall.ForEach([&](int x, int y) { wall.SetNormal(x, y, {0.5f, 0.0f, std::sqrt(0.75f)}); });
  const auto paint_of = [&](double column) {
    wall.Paint([&](int x, int y) {
      const double tone = 0.25 + 0.4 * column / kSize + 0.25 * Stroke(3, x, y, 6.0);
      return std::array<int, 3>{int(65535 * tone), int(60000 * tone), int(40000 * tone)};
    });
    return MustMeasure(texture, wall);
  };
  const GuidedTextureReport own = paint_of(0.75 * kSize), left = paint_of(0.25 * kSize);
  EXPECT_GT(own.measured, 30000u);
  EXPECT_GT(left.tone, 2.0 * own.tone);
  EXPECT_GT(left.distance, own.distance);
}

// With two paintings for two lights, a pixel is compared with the painting for its own.
TEST(GuidedTexture, APixelsPaintingIsThatOfItsLight) {
  EnergyScene lit = PaintedBall(1), dark = PaintedBall(4, 3.0);
  for (auto& value : dark.picture.rgba) value = std::uint16_t(value / 3);
  lit.more.assign(1, std::vector<float>(lit.coverage.size(), 0.8f));
  dark.more.assign(1, std::vector<float>(dark.coverage.size(), 0.1f));
  const std::array<EnergyExemplar, 2> both = {lit.Exemplar(), dark.Exemplar()};
  const auto texture = GuidedTexture::Of(both);
  ASSERT_TRUE(texture.ok());
  EXPECT_EQ(MustMeasure(*texture, lit).distance, 0.0);
  EXPECT_EQ(MustMeasure(*texture, dark).distance, 0.0);
  EnergyScene wrong = lit;
  wrong.more = dark.more;
  EXPECT_GT(MustMeasure(*texture, wrong).distance, 0.3);
}

TEST(GuidedTexture, TheSameForAnyThreads) {
  const GuidedTexture texture = MustPrepare(PaintedBall(1));
  const EnergyScene target = PaintedBall(2, 4.0);
  const GuidedTextureReport one = MustMeasure(texture, target, 1), four = MustMeasure(texture, target, 4);
  EXPECT_EQ(one.distance, four.distance);
  EXPECT_EQ(one.strokes, four.strokes);
}

TEST(GuidedTexture, SmallPicturesAndNoneAtAll) {
  const GuidedTexture texture = MustPrepare(PaintedBall(1));
  for (const int side : {1, 2, 7, 20}) {
    EnergyScene tiny(side, side);
    tiny.Paint([](int x, int y) { return NoiseColor(1, x, y); });
    const GuidedTextureReport report = MustMeasure(texture, tiny);
    EXPECT_TRUE(std::isfinite(report.distance)) << side;
    EXPECT_LE(report.measured, std::size_t(side) * std::size_t(side));
  }
  EnergyScene empty(40, 30);
  empty.coverage.assign(empty.coverage.size(), 0.0f);
  EXPECT_EQ(MustMeasure(texture, empty).measured, 0u);
  EXPECT_EQ(MustMeasure(texture, empty).distance, 0.0);
}

TEST(GuidedTexture, PlanesOfAnotherSizeAreRefused) {
  const EnergyScene exemplar = PaintedBall(1);
  EnergyExemplar cut = exemplar.Exemplar();
  cut.usable = cut.usable.first(10);
  const auto refused = GuidedTexture::Of({&cut, 1});
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("another number of values"), std::string::npos);
  EXPECT_FALSE(GuidedTexture::Of({}).ok());
  const std::vector<float> surface(3, 1.0f);
  EXPECT_FALSE(MustPrepare(exemplar).Measure(exemplar.Target(), surface).ok());
}

}  // namespace
}  // namespace scumble::testing
