// The reference of pictures, where the figures are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <memory>
#include <utility>

#include "guidegen/guidegen.h"
#include "pipeline/variant/variant_error.h"
#include "pipeline/variant/variant_guides.h"
#include "tests/support/transfer_fixtures.h"

namespace scumble {
namespace {

using namespace testing;

constexpr int kSize = 64;

Picture Noise(int size, std::uint64_t seed = 1) {
  Picture picture(size, size);
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) {
    picture.rgba[i] = i % 4 == 3 ? 65535 : static_cast<std::uint16_t>(Hash(seed, i) & 0xffff);
  }
  return picture;
}

std::shared_ptr<const GuideSet> SphereOf(int size, LayerSet layers = {}) {
  SphereOptions options;
  options.size = size, options.layers = layers;
  auto made = RenderSphereGuides(options);
  EXPECT_TRUE(made.ok());
  return std::make_shared<const GuideSet>(std::move(made->guides));
}

Style LitSphereStyle(int size) {
  Style style = PlainStyle(Noise(size));
  style.transfer.method = Method::kLitSphere, style.transfer.rim = 0.0, style.transfer.blend_radius = 0;
  return style;
}

struct Painted {
  PreparedStyle style;
  Picture picture;
  TransferScratch scratch;
};

Painted Paint(const Style& style, const GuideSet& guides) {
  Painted painted;
  auto prepared = Prepare(style, guides.height());
  EXPECT_TRUE(prepared.ok());
  painted.style = *prepared;
  TransferOptions options;
  options.keep_field = true;
  EXPECT_TRUE(Transfer(painted.style, guides, options, painted.scratch, painted.picture).ok());
  return painted;
}

TradeMeasure Measured(const TradeReference& reference, const Painted& painted) {
  TradeMeasure measure;
  EXPECT_TRUE(reference.MeasurePaint(painted.picture, &painted.scratch.field, {}, measure).ok());
  EXPECT_TRUE(reference.MeasureMosaic(painted.picture, painted.scratch.field, measure).ok());
  return measure;
}

// The sphere that was painted, in its own paint: every pixel's nearest neighbour is itself, so the picture is the
// exemplar. Its normals are Embree's, the exemplar's the formula's: they are a few ulps of a float apart, whose squares
// times λ are below 10 · 3 · (4 · 2^-24)², so nothing in single precision.
TEST(TradeReference, AStraightCopyOfTheExemplarScoresNothing) {
  const auto guides = SphereOf(kSize);
  const Painted painted = Paint(LitSphereStyle(kSize), *guides);
  const TradeReference reference(guides, painted.style, 0.0, 0);
  const TradeMeasure measure = Measured(reference, painted);
  EXPECT_LT(measure.both.mean, 1e-9);
  EXPECT_LT(measure.energy.mean, 1e-9);
  EXPECT_LT(measure.missing.mean, 1e-9);
  ASSERT_TRUE(measure.coherence && measure.guide_degrees && measure.repetition);
  EXPECT_EQ(*measure.coherence, 1.0) << "one piece";
  EXPECT_EQ(*measure.repetition, 1.0) << "nothing twice";
  EXPECT_LT(*measure.guide_degrees, 0.1);
  const auto off = reference.Compare(*guides);
  ASSERT_TRUE(off.ok());
  EXPECT_EQ(off->rms, 0.0);
  EXPECT_EQ(off->flip, 0.0);
}

TEST(TradeReference, AnotherPictureScoresMoreAndWithoutAFieldSaysNothingOfTheMosaic) {
  const auto guides = SphereOf(kSize);
  const Painted painted = Paint(LitSphereStyle(kSize), *guides);
  const TradeReference reference(guides, painted.style, 0.0, 0);
  TradeMeasure measure;
  ASSERT_TRUE(reference.MeasurePaint(Noise(kSize, 7), nullptr, {}, measure).ok());
  EXPECT_GT(measure.both.mean, 1.0);
  EXPECT_FALSE(measure.coherence || measure.chunk_area || measure.guide_degrees || measure.seam_excess ||
               measure.repetition);
}

// Where paint is the same, `texture` differs by what outlines do: kOutlinesInTexture of their error.
TEST(TradeReference, TextureCountsOutlines) {
  constexpr int kTextured = 192;
  SphereOptions options;
  options.size = kTextured;
  auto made = RenderSphereGuides(options);
  ASSERT_TRUE(made.ok());
  const auto guides = std::make_shared<const GuideSet>(std::move(made->guides));
  const Painted painted = Paint(LitSphereStyle(kTextured), *guides);
  const TradeReference reference(guides, painted.style, 0.0, 0);
  const auto texture = reference.Texture();
  ASSERT_TRUE(texture.ok());
  // Other paint, in the same outline, and in one whose pixels beside the background are half transparent.
  Picture sharp = Noise(kTextured, 7);
  for (std::size_t i = 3; i < sharp.rgba.size(); i += 4) sharp.rgba[i] = painted.picture.rgba[i];
  Picture frayed = sharp;
  for (int y = 1; y < kTextured - 1; ++y) {
    for (int x = 1; x < kTextured - 1; ++x) {
      const bool is_border = sharp.At(x - 1, y)[3] == 0 || sharp.At(x + 1, y)[3] == 0;
      if (is_border && sharp.At(x, y)[3] != 0) frayed.At(x, y)[3] = 32768;
    }
  }
  TradeMeasure clean, soft;
  ASSERT_TRUE(reference.MeasureTexture(*texture, sharp, clean).ok());
  ASSERT_TRUE(reference.MeasureTexture(*texture, frayed, soft).ok());
  const auto error = MeasureOutlines(sharp, *guides), more = MeasureOutlines(frayed, *guides);
  ASSERT_TRUE(error.ok() && more.ok());
  ASSERT_GT(more->error, error->error);
  ASSERT_TRUE(clean.texture && soft.texture);
  ASSERT_GT(*clean.texture, 0.0);
  EXPECT_NEAR(*soft.texture / *clean.texture,
              (1.0 + kOutlinesInTexture * more->error) / (1.0 + kOutlinesInTexture * error->error), 1e-9);
}

// All normals turned by an angle about z: the distance of each is 2 sin(angle / 2) · |(x, y)|, and the mean of x² + y²
// over the unit disc is a half.
TEST(TradeReference, TheDifferenceOfNormalsIsTheirRootMeanSquareDistance) {
  const auto guides = SphereOf(200);
  GuideSet turned = *guides;
  const double angle = 0.1;
  for (std::size_t i = 0; i < turned.pixel_count(); ++i) {
    const glm::vec3 n = guides->Vec3(Layer::kNormal, i);
    turned.Plane(Layer::kNormal, 0)[i] = float(std::cos(angle) * n.x - std::sin(angle) * n.y);
    turned.Plane(Layer::kNormal, 1)[i] = float(std::sin(angle) * n.x + std::cos(angle) * n.y);
  }
  const Painted painted = Paint(LitSphereStyle(32), *guides);
  const TradeReference reference(guides, painted.style, 0.0, 0);
  const auto off = reference.Compare(turned);
  ASSERT_TRUE(off.ok());
  const double expected = 2.0 * std::sin(angle / 2.0) * std::sqrt(0.5);
  EXPECT_NEAR(off->rms, expected, 0.01 * expected)
      << "pixels on the rim are whole: a share of 4 / 200 or less of the area";
  EXPECT_GT(off->flip, 0.0);
}

// A block of three covered pixels and one beside the thing: means of the three, and three quarters of coverage; one
// whose normals are opposite has no direction left; one of nothing is background.
TEST(TradeReference, LargerGuidesAreComparedByTheirMeans) {
  GuideSet large(6, 2);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kLuminance, Layer::kObject}) large.Add(layer);
  const auto set = [&](int x, int y, glm::vec3 normal, float light) {
    const std::size_t i = large.Index(x, y);
    large.Plane(Layer::kCoverage)[i] = 1.0f, large.Plane(Layer::kLuminance)[i] = light;
    for (int c = 0; c < 3; ++c) large.Plane(Layer::kNormal, c)[i] = normal[c];
  };
  set(0, 0, {1.0f, 0.0f, 0.0f}, 0.25f), set(1, 0, {0.0f, 1.0f, 0.0f}, 0.5f), set(0, 1, {0.0f, 0.0f, 1.0f}, 0.75f);
  set(2, 0, {0.0f, 0.0f, 1.0f}, 2.0f), set(3, 1, {0.0f, 0.0f, -1.0f}, 4.0f);
  const GuideSet small = AveragedGuides(large, 2);
  ASSERT_EQ(small.width(), 3);
  ASSERT_EQ(small.height(), 1);
  EXPECT_EQ(small.layers(), LayerSet({Layer::kCoverage, Layer::kNormal, Layer::kLuminance})) << "ids have no mean";
  EXPECT_EQ(small.Plane(Layer::kCoverage)[0], 0.75f);
  EXPECT_EQ(small.Plane(Layer::kLuminance)[0], 0.5f);
  for (int c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(small.Vec3(Layer::kNormal, 0)[c], float(std::sqrt(1.0 / 3.0)));
  EXPECT_EQ(small.Plane(Layer::kLuminance)[1], 3.0f);
  EXPECT_EQ(small.Vec3(Layer::kNormal, 1), glm::vec3(0.0f));
  EXPECT_EQ(small.Plane(Layer::kCoverage)[2], 0.0f);
  EXPECT_EQ(small.Plane(Layer::kLuminance)[2], 0.0f);
}

// A sphere of twice the size gives equal figures: its mean normals are those at the pixels' centres but for the second
// order of a quarter of a pixel, and for the rim, where pixels are partly beside the sphere.
TEST(TradeReference, TwiceTheResolutionIsCloseToTheExactGuides) {
  const auto guides = SphereOf(kSize), large = SphereOf(2 * kSize);
  const Painted painted = Paint(LitSphereStyle(kSize), *guides);
  const TradeReference reference(guides, painted.style, 0.0, 0);
  const auto off = reference.Compare(AveragedGuides(*large, 2));
  const auto half = reference.Compare(AveragedGuides(*guides, 1));
  ASSERT_TRUE(off.ok() && half.ok());
  EXPECT_LT(half->rms, 1e-6) << "blocks of one pixel are the guides themselves, but for their length's last bits";
  EXPECT_GT(off->rms, 0.0);
  EXPECT_LT(off->rms, 0.25 * std::sqrt(1.0 / 8.0))
      << "a pixel in from the rim the normal is sqrt(2 / 32) = 0.25 off; an eighth of all pixels is so near to it";
}

// Light counts instead of normals where there are several conditions; it is exposed, and cut at the brightest
// exemplar's.
TEST(TradeReference, OfAStyleWithLightItIsTheLight) {
  const auto guides = SphereOf(kSize, {Layer::kLuminance});
  Style style = LitSphereStyle(kSize);
  style.exemplars.push_back(style.exemplars.front());
  style.exemplars[0].luminance = 0.5, style.exemplars[1].luminance = 0.1;
  const Painted painted = Paint(style, *guides);
  const TradeReference reference(guides, painted.style, 0.0, 0);
  GuideSet other = *guides;
  for (float& z : other.Plane(Layer::kNormal, 2)) z = 0.0f;
  EXPECT_EQ(reference.Compare(other)->rms, 0.0) << "normals do not count";
  GuideSet dark = *guides, bright = *guides;
  for (float& value : dark.Plane(Layer::kLuminance)) value = 0.0f;
  for (float& value : bright.Plane(Layer::kLuminance)) value = 1.0f;
  // Against light of 1 everywhere, which is cut at 0.5 of 0.5: the difference to darkness is 1.
  const auto all = std::make_shared<const GuideSet>(bright);
  const TradeReference lit(all, painted.style, 0.0, 0);
  EXPECT_EQ(lit.Compare(dark)->rms, 1.0);
  for (float& value : bright.Plane(Layer::kLuminance)) value = 2.0f;
  EXPECT_EQ(lit.Compare(bright)->rms, 0.0) << "twice as bright is cut all the same";
  for (float& value : bright.Plane(Layer::kLuminance)) value = 0.125f;
  EXPECT_EQ(lit.Compare(bright)->rms, 0.75) << "a quarter of 0.5";
  EXPECT_EQ(TradeReference(all, painted.style, 1.0, 0).Compare(bright)->rms, 0.5)
      << "0.125 a stop brighter is half of 0.5";
}

// The wrong condition costs λ times the weighed difference of luminances, however well the paint fits.
TEST(TradeReference, PaintForOtherLightCosts) {
  const auto guides = SphereOf(kSize, {Layer::kLuminance});
  GuideSet bright = *guides;
  for (float& value : bright.Plane(Layer::kLuminance)) value = 0.5f;
  Style style = LitSphereStyle(kSize);
  style.exemplars.push_back(style.exemplars.front());
  style.exemplars[0].luminance = 0.5, style.exemplars[1].luminance = 0.1;
  style.exemplars[1].picture = Noise(kSize, 5);
  style.transfer.luminance_weight = 0.3f;
  const auto lit = std::make_shared<const GuideSet>(bright);
  const Painted right = Paint(style, *lit);
  const TradeReference reference(lit, right.style, 0.0, 0);
  EXPECT_LT(Measured(reference, right).energy.mean, 1e-9);
  GuideSet dark = bright;
  for (float& value : dark.Plane(Layer::kLuminance)) value = 0.1f;
  const Painted wrong = Paint(style, dark);  // all in the second exemplar's paint
  // In floats are the weight, 0.1 and their product, each off by 2^-24 of itself at most. Of the difference the last
  // two are a quarter, so it is off by 1.5 · 2^-24 and its square by 3; the normals are as near as in a straight copy.
  const double expected = 10.0 * std::pow(0.3 * (0.5 - 0.1), 2), normals = 10.0 * 3.0 * std::pow(4.0 * 0x1p-24, 2);
  EXPECT_NEAR(Measured(reference, wrong).energy.mean, expected, 3.0 * 0x1p-24 * expected + normals)
      << "noise of random colours has no nearer patch";
}

// A wall in paint that was copied from one place of a sphere: noise has no nearer patch, so each pixel costs λ times
// the square of what its source's normal is farther off than the chord of the variety.
TEST(TradeReference, WhatVarietyGrantsOnAWallIsFree) {
  constexpr int kWall = 20, kLeft = 14, kTop = 24;
  auto wall = std::make_shared<GuideSet>(kWall, kWall);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kObject}) wall->Add(layer);
  for (float& value : wall->Plane(Layer::kCoverage)) value = 1.0f;
  for (float& value : wall->Plane(Layer::kNormal, 2)) value = 1.0f;
  for (const double degrees : {0.0, 8.0, 15.0, 60.0}) {
    Style style = LitSphereStyle(kSize);
    style.transfer.variety = static_cast<float>(degrees);
    const auto prepared = Prepare(style, kWall);
    ASSERT_TRUE(prepared.ok());
    const PreparedExemplar& ball = *prepared->exemplar;
    ASSERT_EQ(ball.width(), kSize);
    Picture copied(kWall, kWall);
    const double chord = 2.0 * std::sin(degrees / 2.0 * 3.14159265358979323846 / 180.0);
    double sum = 0.0, slack = 0.0;
    for (int y = 0; y < kWall; ++y) {
      for (int x = 0; x < kWall; ++x) {
        std::copy_n(ball.picture().At(kLeft + x, kTop + y), 4, copied.At(x, y));
        const glm::dvec3 off = glm::dvec3(ball.Normal(kLeft + x, kTop + y)) - glm::dvec3(0.0, 0.0, 1.0);
        const double beyond = std::max(0.0, glm::length(off) - chord);
        sum += 10.0 * beyond * beyond;
        slack += 10.0 * 2.0 * beyond * (0x1p-24 * chord + 0x1p-50);
      }
    }
    TradeMeasure measure;
    ASSERT_TRUE(TradeReference(wall, *prepared, 0.0, 0).MeasurePaint(copied, nullptr, {}, measure).ok());
    // The chord is kept as a float, all else is double: lengths that lose less than 2^-50, and a sum of 400.
    EXPECT_NEAR(measure.energy.mean, sum / (kWall * kWall), (slack + 0x1p-43 * sum) / (kWall * kWall)) << degrees;
    EXPECT_EQ(sum == 0.0, degrees == 60.0) << "some costs, and at last nothing";
  }
}

// Nothing on a sphere is flat.
TEST(TradeReference, VarietyGrantsNothingWhereSurfacesBend) {
  const auto guides = SphereOf(kSize);
  double energies[2];
  for (const bool varied : {false, true}) {
    Style style = LitSphereStyle(kSize);
    style.transfer.variety = varied ? 15.0f : 0.0f;
    const auto prepared = Prepare(style, kSize);
    ASSERT_TRUE(prepared.ok());
    TradeMeasure measure;
    ASSERT_TRUE(TradeReference(guides, *prepared, 0.0, 0).MeasurePaint(Noise(kSize, 7), nullptr, {}, measure).ok());
    energies[varied] = measure.both.mean;
  }
  EXPECT_EQ(energies[0], energies[1]);
}

}  // namespace
}  // namespace scumble
