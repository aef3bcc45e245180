// Figures of the energy that follow from the formula, and of pictures that the engine made.
#include "measure/energy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>

#include "tests/measure/energy_fixtures.h"
#include "tests/support/transfer_fixtures.h"

namespace scumble::testing {
namespace {

EnergyOptions All(double lambda = 10.0) {
  EnergyOptions options;
  options.lambda = lambda, options.samples = 0;
  return options;
}

TEST(Energy, APictureThatIsTheExemplarScoresNothing) {
  EnergyScene ball = Ball(40);
  ball.Paint([](int x, int y) { return NoiseColor(1, x, y); });
  const EnergyReport report = MustMeasure(ball, ball, All());
  EXPECT_EQ(report.energy.mean, 0.0);
  EXPECT_EQ(report.color.mean, 0.0);
  EXPECT_EQ(report.guide.mean, 0.0);
  EXPECT_EQ(report.degrees.mean, 0.0);
  EXPECT_EQ(report.missing.mean, 0.0);
  EXPECT_EQ(report.both.mean, 0.0);
  std::size_t covered = 0;
  for (const float a : ball.coverage) covered += a > 0.0f;
  EXPECT_EQ(report.measured, covered);
  EXPECT_EQ(report.asked_for, covered);
  for (const EnergySample& sample : report.samples) {
    EXPECT_EQ(sample.source_x, sample.x) << "in noise no other patch is equal";
    EXPECT_EQ(sample.source_y, sample.y);
  }
}

// One colour each, one normal each: all patches are equally far, and sums of colours count as 25 terms wherever the
// patch is cut. The normals are 0.6 apart in x: that is not what the scene asks for.
TEST(Energy, FlatColoursAndNormalsAsTheyFollowByHand) {
  EnergyScene target(12, 9), exemplar(20, 20);
  target.Paint([](int, int) { return std::array<int, 3>{13107, 0, 65535}; });       // 0.2, 0, 1
  exemplar.Paint([](int, int) { return std::array<int, 3>{39321, 6553, 65535}; });  // 0.6, 6553/65535, 1
  exemplar.ForEach([&](int x, int y) {
    exemplar.SetNormal(x, y, {0.6f, 0.0f, 0.8f});
  });  // 36.87 degrees from (0, 0, 1)
  const EnergyReport report = MustMeasure(target, exemplar, All(3.0));
  const double color = 25.0 * (0.4 * 0.4 + std::pow(6553.0 / 65535.0, 2));
  const double x = 0.6f, z = 1.0 - double(0.8f), guide = x * x + z * z;  // in exact numbers 0.4
  EXPECT_NEAR(report.color.mean, color, 1e-12 * color);
  EXPECT_NEAR(report.guide.mean, guide, 1e-12 * guide);
  EXPECT_NEAR(guide, 0.4, 1e-6);
  EXPECT_NEAR(report.energy.mean, color + 3.0 * guide, 1e-12 * (color + 3.0 * guide));
  EXPECT_NEAR(report.degrees.mean, std::atan2(double(0.6f), double(0.8f)) * 180.0 / 3.14159265358979323846, 1e-9);
  EXPECT_EQ(report.measured, 12u * 9u);
  EXPECT_EQ(report.asked_for, 0u);
  EXPECT_EQ(report.missing.mean, 0.0);
  target.ForEach([&](int tx, int ty) { target.SetNormal(tx, ty, {0.6f, 0.0f, 0.8f}); });
  const EnergyReport same = MustMeasure(target, exemplar, All(3.0));
  EXPECT_EQ(same.asked_for, 20u * 20u);
  EXPECT_NEAR(same.missing.mean, color, 1e-12 * color) << "now both sides see one difference";
  EXPECT_NEAR(same.both.mean, 2.0 * color, 1e-12 * color);
}

// A straight copy from the wrong place: nothing in colour at λ = 0, and never more than its own guide error costs.
TEST(Energy, AStraightCopyPaysForItsGuidesAlone) {
  EnergyScene exemplar = Ball(48), target(20, 20);
  exemplar.Paint([](int x, int y) { return NoiseColor(2, x, y); });
  target.Paint([&](int x, int y) { return NoiseColor(2, x + 9, y + 17); });
  double own = 0.0;
  target.ForEach([&](int x, int y) {
    const glm::dvec3 d = target.Normal(x, y) - exemplar.Normal(x + 9, y + 17);
    own += glm::dot(d, d) / 400.0;
  });
  EXPECT_EQ(MustMeasure(target, exemplar, All(0.0)).energy.mean, 0.0);
  double before = 0.0;
  for (const double lambda : {0.1, 10.0, 10000.0}) {
    const EnergyReport report = MustMeasure(target, exemplar, All(lambda));
    EXPECT_LE(report.energy.mean, lambda * own * (1.0 + 1e-12)) << lambda;
    EXPECT_GT(report.energy.mean, before) << "more for more";
    before = report.energy.mean;
  }
  // In noise no other patch is near, so where guides count little the copy's own place is the nearest.
  EXPECT_NEAR(MustMeasure(target, exemplar, All(0.1)).energy.mean, 0.1 * own, 1e-12 * own);
}

// One wrong pixel stands in the 25 patches around it, each of which it makes worse by its squared error: the mean over
// 900 pixels is 25 · d² / 900.
TEST(Energy, OneWrongPixelCosts25TimesItsSquareOverAll) {
  EnergyScene exemplar(30, 30);
  exemplar.Paint([](int x, int y) { return NoiseColor(3, x, y); });
  EnergyScene target = exemplar;
  std::uint16_t& red = target.picture.At(14, 16)[0];
  red = static_cast<std::uint16_t>(red > 30000 ? red - 10000 : red + 10000);
  const double d = 10000.0 / 65535.0;
  const EnergyReport report = MustMeasure(target, exemplar, All());
  EXPECT_NEAR(report.energy.mean, 25.0 * d * d / 900.0, 1e-12);
  EXPECT_NEAR(report.missing.mean, 25.0 * d * d / 900.0, 1e-12) << "the 25 patches of the exemplar that it spoils";
}

// Half of the exemplar is copied, and the other half is nowhere: the copied half costs nothing, and the other half is
// missing.
TEST(Energy, WhatThePictureLacksIsMissing) {
  EnergyScene exemplar(40, 20), target(20, 20);
  exemplar.Paint([](int x, int y) { return x < 20 ? NoiseColor(3, x, y) : std::array<int, 3>{65535, 65535, 65535}; });
  target.picture = Picture(20, 20);
  target.Paint([](int x, int y) { return NoiseColor(3, x, y); });
  EXPECT_EQ(MustMeasure(target, exemplar, All()).energy.mean, 0.0);
  EXPECT_GT(MustMeasure(target, exemplar, All()).missing.mean, 0.5 * 25.0 * 3.0 * 0.1)
      << "half is white: far from noise";
  EXPECT_EQ(MustMeasure(exemplar, target, All()).missing.mean, 0.0) << "all of the half is in the whole";
}

TEST(Energy, SeveralExemplarsNeverCostMoreThanOne) {
  EnergyScene target = Ball(30), lit = Ball(40), shade = Ball(40);
  target.Paint([](int x, int y) { return NoiseColor(4, x / 2, y / 2); });
  lit.Paint([](int x, int y) { return NoiseColor(5, x / 2, y / 2); });
  shade.Paint([](int x, int y) { return NoiseColor(6, x / 2, y / 2); });
  const EnergyExemplar both[] = {lit.Exemplar(), shade.Exemplar()};
  const EnergyReport report = MustMeasure(target.Target(), both, All());
  const EnergyReport one = MustMeasure(target, lit, All()), other = MustMeasure(target, shade, All());
  double expected = 0.0;
  for (std::size_t i = 0; i < report.samples.size(); ++i) {
    const auto energy = [](const EnergySample& s) { return s.color + 10.0 * s.guide; };
    expected += std::min(energy(one.samples[i]), energy(other.samples[i])) / double(report.samples.size());
  }
  EXPECT_NEAR(report.energy.mean, expected, 1e-12 * expected);
}

// Paint under a pixel that is partly covered is mixed with what lies behind, so it is not looked at, by itself or by
// others.
TEST(Energy, PixelsThatAreNotFullyCoveredDoNotCount) {
  EnergyScene exemplar = Ball(32);
  exemplar.Paint([](int x, int y) { return NoiseColor(7, x, y); });
  EnergyScene target = exemplar;
  target.coverage[target.Index(16, 16)] = 0.99f, target.picture.At(16, 16)[1] ^= 0x8000;
  target.SetNormal(16, 16, glm::vec3(std::nanf("")));
  const EnergyReport report = MustMeasure(target, exemplar, All());
  EXPECT_EQ(report.energy.mean, 0.0);
  EXPECT_GT(report.missing.mean, 0.0) << "what was there is hidden now";
  EXPECT_EQ(report.measured, MustMeasure(exemplar, exemplar, All()).measured - 1);
}

TEST(Energy, NothingCoveredIsNothing) {
  EnergyScene target(9, 9), exemplar(9, 9);
  target.coverage.assign(81, 0.0f);
  const EnergyReport report = MustMeasure(target, exemplar);
  EXPECT_EQ(report.measured, 0u);
  EXPECT_EQ(report.samples.size(), 0u);
  EXPECT_EQ(report.both.mean, 0.0);
  EXPECT_EQ(report.energy.standard_error, 0.0);
}

// ---- Samples ----

EnergyScene Patchy() {
  EnergyScene target = Ball(70);
  target.Paint([](int x, int y) { return NoiseColor(8, x / (1 + y / 20), y / 3); });
  return target;
}

EnergyScene Smooth() {
  EnergyScene exemplar = Ball(36);
  exemplar.Paint([](int x, int y) { return std::array<int, 3>{1500 * x, 1500 * y, 30000}; });
  return exemplar;
}

// The expectation of the estimate is the mean itself, and that of its squared error the squared standard error. Over 60
// seeds the mean estimate has 1/√60 of the error of one; beyond 4 of those one run in 16,000 would fall by chance, and
// the seeds are fixed. Of the mean square of 60 normal errors the standard deviation is √(2/60) = 0.18 of it, and that
// of the estimated ones is less; 0.4 … 1.8 leaves three of those and what errors that are not quite normal add.
TEST(Energy, SamplesEstimateTheMeanAndTheirOwnError) {
  const EnergyScene target = Patchy(), exemplar = Smooth();
  const EnergyReport all = MustMeasure(target, exemplar, All());
  std::vector<EnergyReport> reports;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    EnergyOptions options;
    options.samples = 200, options.seed = seed;
    reports.push_back(MustMeasure(target, exemplar, options));
    EXPECT_EQ(reports.back().samples.size(), 200u);
  }
  for (const auto part : {&EnergyReport::energy, &EnergyReport::missing, &EnergyReport::both}) {
    const double truth = (all.*part).mean;
    double sum = 0.0, squares = 0.0, claimed = 0.0;
    for (const EnergyReport& report : reports) {
      sum += (report.*part).mean / 60, squares += std::pow((report.*part).mean - truth, 2) / 60;
      claimed += std::pow((report.*part).standard_error, 2) / 60;
    }
    EXPECT_NEAR(sum, truth, 4.0 * std::sqrt(claimed / 60.0));
    EXPECT_GT(squares / claimed, 0.4);
    EXPECT_LT(squares / claimed, 1.8);
    EXPECT_LT(std::sqrt(claimed), 0.2 * truth);
  }
}

TEST(Energy, AsManySamplesAsPixelsAreAllOfThem) {
  EnergyScene target = Ball(20);
  target.Paint([](int x, int y) { return NoiseColor(9, x, y); });
  const EnergyScene exemplar = Smooth();
  const EnergyReport all = MustMeasure(target, exemplar, All());
  for (const std::size_t samples : {all.measured, all.measured + 1, ~std::size_t(0)}) {
    EnergyOptions options;
    options.samples = samples;
    EXPECT_EQ(MustMeasure(target, exemplar, options).energy.mean, all.energy.mean) << samples << " of " << all.measured;
  }
  EnergyOptions two;
  two.samples = 1;
  EXPECT_EQ(MustMeasure(target, exemplar, two).samples.size(), 2u) << "an error needs two";
}

TEST(Energy, SameBytesWithAnyNumberOfThreads) {
  const EnergyScene target = Patchy(), exemplar = Smooth();
  EnergyOptions options;
  options.samples = 300, options.threads = 1;
  const EnergyReport one = MustMeasure(target, exemplar, options);
  for (const int threads : {2, 3, 7}) {
    options.threads = threads;
    const EnergyReport many = MustMeasure(target, exemplar, options);
    EXPECT_EQ(std::memcmp(&one.both, &many.both, sizeof(Estimate)), 0) << threads;
    EXPECT_EQ(std::memcmp(&one.degrees, &many.degrees, sizeof(Estimate)), 0) << threads;
    EXPECT_TRUE(one.samples == many.samples) << threads;  // none is NaN, and their padding is anything
  }
  options.seed = 1;
  EXPECT_NE(MustMeasure(target, exemplar, options).energy.mean, one.energy.mean) << "other pixels";
}

// ---- Pictures that the engine made ----

// The sphere exemplar of a prepared style, as the measure takes it.
EnergyScene SceneOf(const PreparedExemplar& prepared) {
  EnergyScene scene(prepared.width(), prepared.height());
  scene.picture = prepared.picture();
  scene.ForEach([&](int x, int y) {
    scene.usable[scene.Index(x, y)] = prepared.Usable(x, y);
    if (prepared.Usable(x, y)) scene.SetNormal(x, y, prepared.Normal(x, y));
  });
  return scene;
}

struct Measured {
  EnergyReport report;
  double source_degrees = 0.0;
};

Measured MeasureStyle(const Style& style, const GuideSet& guides, const EnergyOptions& options = All(),
                      std::optional<Picture> instead = {}) {
  const auto prepared = Prepare(style, guides.height());
  EXPECT_TRUE(prepared.ok());
  const Transferred made = MustTransfer(style, guides);
  const EnergyScene scene = SceneOf(*prepared->exemplar);
  const Picture& picture = instead ? *instead : made.picture;
  const EnergyTarget target{
      &picture,
      {guides.Plane(Layer::kNormal, 0), guides.Plane(Layer::kNormal, 1), guides.Plane(Layer::kNormal, 2)},
      guides.Plane(Layer::kCoverage)};
  std::vector<std::uint8_t> covered;
  for (const std::int8_t level : made.field.level) covered.push_back(level != SourceField::kNoSource);
  const SourcePlanes sources{made.field.width, made.field.height, made.field.x, made.field.y, covered, {}};
  const EnergyExemplar exemplar = scene.Exemplar();
  EnergyOptions with_sources = options;
  with_sources.sources = &sources;
  const auto degrees = MeanSourceDegrees(target, {&exemplar, 1}, sources);
  EXPECT_TRUE(degrees.ok());
  Measured measured{MustMeasure(target, {&exemplar, 1}, with_sources), degrees.ok() ? *degrees : NAN};
  return measured;
}

// Strokes: smooth paint with structure of a few pixels, as the methods are made for.
Picture Strokes(int size) {
  Picture picture(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double along = 0.35 * x + 0.6 * y + 2.0 * std::sin(0.13 * x), tone = 0.5 + 0.2 * (x - y) / size;
      const double grey = tone + 0.15 * std::sin(along) + 0.1 * (UnitFloat(Hash(x / 2, y / 2)) - 0.5);
      for (int c = 0; c < 3; ++c) picture.At(x, y)[c] = static_cast<std::uint16_t>(65535 * std::clamp(grey, 0.0, 1.0));
      picture.At(x, y)[3] = 65535;
    }
  }
  return picture;
}

Style StrokesBy(Method method, int size, double rim) {
  Style style = PlainStyle(Strokes(size));
  style.transfer.method = method, style.transfer.rim = rim;
  return style;
}

// The sphere that was painted, painted by Lit Sphere: each pixel's nearest neighbour is itself, so it is the exemplar.
TEST(Energy, LitSphereOnTheExemplarsOwnSphereScoresNothing) {
  const Measured measured = MeasureStyle(StrokesBy(Method::kLitSphere, 48, 0.0), SphereGuides(48));
  EXPECT_EQ(measured.report.both.mean, 0.0);
  EXPECT_EQ(measured.source_degrees, 0.0);
  // On a larger one the paint is stretched: single pixels under perfect guides are no strokes.
  const Measured larger = MeasureStyle(StrokesBy(Method::kLitSphere, 48, 0.0), SphereGuides(80));
  EXPECT_GT(larger.report.both.mean, 0.1);
}

// Chunks keep strokes at the cost of guides, single pixels the reverse. One figure separates them although the sources'
// own normals are farther off in chunks. Noise is worse than both, and so is one colour, near as it is to some patch of
// any paint: this is why `missing` is part of the figure.
TEST(Energy, ChunksBeatSinglePixelsAndBothBeatNoiseAndFlatness) {
  const GuideSet hills = HillGuides(160, 140);
  const auto single = [&](std::optional<Picture> instead = {}) {
    return MeasureStyle(StrokesBy(Method::kLitSphere, 120, 2.0), hills, {}, instead);
  };
  const Measured chunks = MeasureStyle(StrokesBy(Method::kStyleBlit, 120, 2.0), hills, {});
  const Measured oracle = MeasureStyle(StrokesBy(Method::kBruteForce, 120, 2.0), hills, {});
  const Measured pixels = single();
  Picture noise(160, 140), flat(160, 140);
  for (std::size_t i = 0; i < noise.rgba.size(); ++i) noise.rgba[i] = i % 4 == 3 ? 65535 : Hash(i) & 0xffff;
  std::fill(flat.rgba.begin(), flat.rgba.end(), 32768);
  const auto record = [&](const char* name, const Measured& m) {
    RecordProperty(name, std::to_string(m.report.energy.mean) + " + " + std::to_string(m.report.missing.mean));
    return m.report.both.mean;
  };
  const double of_chunks = record("chunks", chunks), of_oracle = record("oracle", oracle),
               of_pixels = record("pixels", pixels);
  EXPECT_LT(of_chunks, of_pixels);
  EXPECT_LT(of_oracle, of_pixels);
  EXPECT_LT(of_pixels, record("noise", single(noise)));
  const Measured flat_one = single(flat);
  EXPECT_LT(of_pixels, record("flat", flat_one));
  EXPECT_LT(flat_one.report.energy.mean, pixels.report.energy.mean) << "the energy alone cannot rank";
  EXPECT_GT(chunks.source_degrees, pixels.source_degrees);
}

// ---- Refusals ----

void ExpectRefusal(const Expected<EnergyReport>& report, ErrorKind kind, const std::string& what) {
  ASSERT_FALSE(report.ok()) << what;
  EXPECT_EQ(report.error().kind, kind) << report.error().message;
  EXPECT_NE(report.error().message.find(what), std::string::npos) << report.error().message;
}

TEST(Energy, RefusesWhatItCannotMeasure) {
  const EnergyScene scene(8, 6);
  const EnergyExemplar exemplar = scene.Exemplar();
  const auto measure = [&](const EnergyTarget& target, const EnergyExemplar& one, EnergyOptions options = {}) {
    return MeasureEnergy(target, {&one, 1}, options);
  };
  ExpectRefusal(MeasureEnergy(scene.Target(), {}, {}), ErrorKind::kInput, "there is no exemplar");
  for (const double lambda : {-1.0, std::nan(""), HUGE_VAL, 1e13}) {
    ExpectRefusal(measure(scene.Target(), exemplar, All(lambda)), ErrorKind::kUsage, "expected 0 … 1e12");
  }
  EnergyScene wrong = scene;
  wrong.coverage.pop_back();
  ExpectRefusal(measure(wrong.Target(), exemplar), ErrorKind::kInput,
                "the target's picture is 8×6, its guides are not");
  EnergyScene bare = scene;
  bare.usable.assign(bare.usable.size(), 0);
  ExpectRefusal(measure(scene.Target(), bare.Exemplar()), ErrorKind::kInput, "no exemplar has a usable pixel");
  EnergyScene broken = scene;
  broken.SetNormal(3, 2, glm::vec3(std::nanf(""), 0, 1));
  ExpectRefusal(measure(broken.Target(), exemplar), ErrorKind::kInput, "the target has a guide of nan at (3, 2)");
  ExpectRefusal(measure(scene.Target(), broken.Exemplar()), ErrorKind::kInput,
                "exemplar 0 has a guide of nan at (3, 2)");
  for (const float free : {-0.1f, 2.1f, std::nanf("")}) {
    EnergyScene granting = scene;
    granting.free.assign(48, 0.0f), granting.free[19] = free;
    ExpectRefusal(measure(granting.Target(), exemplar), ErrorKind::kInput, "at (3, 2): expected 0 … 2");
    granting.free.pop_back();
    ExpectRefusal(measure(granting.Target(), exemplar), ErrorKind::kInput, "free distances are not of its size");
  }
  EnergyScene more = scene;
  more.more.assign(1, std::vector<float>(48, 0.0f));
  ExpectRefusal(measure(more.Target(), exemplar), ErrorKind::kInput, "exemplar 0 has 3 guides, the target 4");
  more.more.assign(30, std::vector<float>(48, 0.0f));
  ExpectRefusal(measure(more.Target(), more.Exemplar()), ErrorKind::kInput, "there are 33 guides");
  const SourcePlanes sources{9, 6, {}, {}, {}, {}};
  EnergyOptions options;
  options.sources = &sources;
  ExpectRefusal(measure(scene.Target(), exemplar, options), ErrorKind::kInput,
                "the sources are 9×6, the picture is 8×6");
}

TEST(Energy, SourceDegreesAreTheMeanAngleOrARefusal) {
  EnergyScene target(2, 1), exemplar(4, 4);
  exemplar.SetNormal(3, 1, {0.6f, 0.0f, 0.8f});
  std::vector<std::int16_t> x = {0, 3}, y = {0, 1};
  const std::vector<std::uint8_t> covered = {1, 1};
  const EnergyExemplar one = exemplar.Exemplar();
  const auto degrees = [&] { return MeanSourceDegrees(target.Target(), {&one, 1}, {2, 1, x, y, covered, {}}); };
  EXPECT_NEAR(*degrees(), 0.5 * std::atan2(double(0.6f), double(0.8f)) * 180.0 / 3.14159265358979323846, 1e-9);
  x[1] = 4;
  ASSERT_FALSE(degrees().ok());
  EXPECT_NE(degrees().error().message.find("the source of pixel (1, 0) is (4, 1) of exemplar 0"), std::string::npos);
}

}  // namespace
}  // namespace scumble::testing
