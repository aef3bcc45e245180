// Scans with a known camera and known light: the place of the template, and its colours.
#include "core/style/rectify.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "core/style/sphere_template.h"
#include "tests/support/scan_fixtures.h"

namespace scumble {
namespace {

// Kept small where the picture does not matter.
RectifyOptions Small() {
  RectifyOptions options;
  options.size = 64;
  return options;
}

struct Case {
  std::string name;
  Scan scan;
};

// One fault after the other, then all of them.
std::vector<Case> Cases() {
  std::vector<Case> cases;
  const auto add = [&](const std::string& name, const auto& change) {
    Scan scan;
    change(scan);
    cases.push_back({name, scan});
  };
  add("flatbed", [](Scan&) {});
  for (const int turn : {90, 180, 270})
    add("turned" + std::to_string(turn), [&](Scan& s) { s.rotation = turn, s.noise = 2; });
  for (const int towards : {0, 60, 135, 250}) {
    add("tilted" + std::to_string(towards),
        [&](Scan& s) { s.tilt = 20, s.towards = towards, s.rotation = 23 + towards, s.fill = 0.65, s.noise = 2; });
  }
  add("small", [](Scan& s) { s.fill = 0.4, s.noise = 2, s.blur = 0.7; });
  add("noisy", [](Scan& s) { s.noise = 14; });
  add("blurred", [](Scan& s) { s.blur = 2.2, s.noise = 2; });
  add("jpeg", [](Scan& s) { s.jpeg_quality = 60, s.rotation = 5; });
  add("light", [](Scan& s) { s.gradient = 0.4, s.cast = {1.0, 0.85, 0.6}, s.glare = 0.06, s.noise = 2; });
  add("covered", [](Scan& s) { s.covered = {0, 3, 5, 8}, s.tilt = 12, s.noise = 3; });
  add("left", [](Scan& s) { s.covered = {1, 2, 3, 4, 5, 6, 7, 8}, s.rotation = 5; });
  add("lens", [](Scan& s) { s.barrel = 0.03, s.tilt = 8, s.towards = 30, s.noise = 2; });
  add("all", [](Scan& s) {
    s.tilt = 20, s.towards = 110, s.rotation = -40, s.fill = 0.62, s.noise = 5, s.blur = 1.0, s.jpeg_quality = 75;
    s.gradient = 0.4, s.cast = {1.0, 0.9, 0.75}, s.glare = 0.04, s.covered = {6}, s.barrel = 0.02;
  });
  return cases;
}

class RectifyCase : public testing::TestWithParam<Case> {};

TEST_P(RectifyCase, IsRegisteredWithinTheLimitAndSaysHowWell) {
  const Scan& scan = GetParam().scan;
  const auto done = RectifyScan(TakeScan(CharcoalSheet(), scan), "scan.png", Small());
  ASSERT_TRUE(done) << done.error().message;
  const double error = TrueError(done->map, scan);
  EXPECT_LT(error, 0.003) << "of the sphere's diameter";
  EXPECT_LE(error, 2 * done->report.error + 0.0005) << "reported " << done->report.error;
  EXPECT_LT(done->report.error, 0.003) << "a good scan must not be called bad";
  EXPECT_EQ(done->report.found.size() + done->report.missing.size(), std::size_t(kFiducialCount));
  for (const int id : scan.covered) {
    EXPECT_EQ(std::count(done->report.found.begin(), done->report.found.end(), id), 0) << FiducialPlace(id);
  }
  EXPECT_EQ(done->report.missing.size(), scan.covered.size());
}

std::string CaseName(const testing::TestParamInfo<Case>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(Scans, RectifyCase, testing::ValuesIn(Cases()), CaseName);

TEST(Rectify, HowTheSheetWasHeldIsTold) {
  Scan scan;
  scan.rotation = 40, scan.tilt = 15, scan.towards = 0, scan.fill = 0.6;
  const auto held = RectifyScan(TakeScan(CharcoalSheet(), scan), "scan.png", Small());
  ASSERT_TRUE(held) << held.error().message;
  EXPECT_NEAR(held->report.rotation, 40, 1.5);
  EXPECT_NEAR(held->report.tilt, 15, 1);
  EXPECT_EQ(held->report.lens, 0) << "straight lines are straight";
  EXPECT_NEAR(held->report.sphere_pixels, ScanCamera(scan).SpherePixels(), 0.02 * held->report.sphere_pixels);

  scan = {};
  scan.barrel = 0.04;
  const auto bent = RectifyScan(TakeScan(CharcoalSheet(), scan), "scan.png", Small());
  ASSERT_TRUE(bent) << bent.error().message;
  EXPECT_NEAR(bent->report.lens, -0.04, 0.008);
}

// CIE Lab of linear Rec.709, D65.
glm::dvec3 Lab(glm::dvec3 rgb) {
  const glm::dvec3 xyz(0.4124 * rgb.r + 0.3576 * rgb.g + 0.1805 * rgb.b,
                       0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b,
                       0.0193 * rgb.r + 0.1192 * rgb.g + 0.9505 * rgb.b);
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
  const double x = f(xyz.x / 0.9505), y = f(xyz.y), z = f(xyz.z / 1.089);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

// The mean linear light of a square, a share of the picture's side wide, around a place of the whole template.
glm::dvec3 MeanAt(const Picture& picture, glm::dvec2 at, double half) {
  const int side = picture.width, x0 = int((at.x - half) * side), x1 = int((at.x + half) * side);
  const int y0 = int((at.y - half) * side), y1 = int((at.y + half) * side);
  glm::dvec3 sum(0.0);
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      for (int c = 0; c < 3; ++c) sum[c] += Srgb16ToLinear(picture.At(x, y)[c]);
    }
  }
  return sum / double((x1 - x0) * (y1 - y0));
}

// Differences of colour over the sphere in patches: mean and largest.
std::pair<double, double> ColourError(const Picture& sheet, const Picture& picture) {
  double sum = 0, most = 0;
  int count = 0;
  for (int j = 0; j < 12; ++j) {
    for (int i = 0; i < 12; ++i) {
      const glm::dvec2 at = glm::dvec2(i + 0.5, j + 0.5) / 12.0;
      if (glm::length(at - 0.5) > 0.38) continue;
      const double off = glm::length(Lab(kPaperWhite * MeanAt(sheet, at, 0.035)) - Lab(MeanAt(picture, at, 0.035)));
      sum += off, most = std::max(most, off), ++count;
    }
  }
  return {sum / count, most};
}

TEST(Rectify, ColoursComeBackFromUnevenColouredLight) {
  Scan scan;
  scan.gradient = 0.4, scan.cast = {1.0, 0.85, 0.6}, scan.glare = 0.06, scan.noise = 3, scan.jpeg_quality = 85,
  scan.rotation = 12;
  RectifyOptions options;
  options.size = 256;
  const Picture seen = TakeScan(CharcoalSheet(), scan);
  const auto done = RectifyScan(seen, "scan.jpg", options);
  ASSERT_TRUE(done) << done.error().message;
  const auto [mean, most] = ColourError(CharcoalSheet(), done->picture);
  EXPECT_LT(mean, 1.5) << "CIE76; a step that can just be seen is 2.3";
  EXPECT_LT(most, 3.5);
  EXPECT_NEAR(done->report.paper[1] / done->report.paper[0], 0.86, 0.02);
  EXPECT_NEAR(done->report.paper[2] / done->report.paper[0], 0.61, 0.02) << "with the glare";
  EXPECT_GT(done->report.unevenness, 0.2);
  EXPECT_NEAR(done->report.black, 0.06, 0.01);

  options.white_balance = false;
  const auto raw = RectifyScan(seen, "scan.jpg", options);
  ASSERT_TRUE(raw) << raw.error().message;
  EXPECT_GT(ColourError(CharcoalSheet(), raw->picture).first, 8) << "kept as it was seen";
  EXPECT_EQ(raw->report.paper[2], done->report.paper[2]) << "and told all the same";
}

// Paint of the palest kind all over the margin's inner half, and a third of the outer half.
TEST(Rectify, PaintOnTheMarginIsNotTakenForPaper) {
  Picture sheet = CharcoalSheet();
  const int margin = TemplateMargin(1024), side = sheet.width;
  const auto wash = [&](int x0, int y0, int x1, int y1) {
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) {
        std::uint16_t* p = sheet.At(x, y);
        if (std::min({p[0], p[1], p[2]}) < 60000) continue;
        p[0] = 62000, p[1] = 60000, p[2] = 52000;
      }
    }
  };
  wash(margin / 2 + 60, margin / 2 + 60, side - margin / 2 - 60, side - margin / 2 - 60);
  wash(0, side / 2, side / 5, side);
  Scan scan;
  scan.gradient = 0.2, scan.noise = 2;
  RectifyOptions options;
  options.size = 256;
  const auto done = RectifyScan(TakeScan(sheet, scan), "scan.jpg", options);
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_LT(ColourError(sheet, done->picture).second, 3);
}

// The template itself is a scan of itself: it comes back, and so do its marks at their places.
TEST(Rectify, TheTemplateComesBackAsItself) {
  const Picture& sheet = CharcoalSheet();
  RectifyOptions options;
  options.white_balance = false;
  const auto done = RectifyScan(sheet, "sheet.png", options);
  ASSERT_TRUE(done) << done.error().message;
  ASSERT_EQ(done->picture.width, sheet.width);
  EXPECT_LT(done->report.error, 1e-4);
  double off = 0;
  for (std::size_t i = 0; i < sheet.rgba.size(); ++i) off += std::abs(double(sheet.rgba[i]) - done->picture.rgba[i]);
  EXPECT_LT(off / double(sheet.rgba.size()), 100) << "of 65535";
  EXPECT_EQ(FiducialsInPlace(done->picture, 1024, TemplateMargin(1024)), kFiducialCount);

  const auto again = RectifyScan(sheet, "sheet.png", options);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->picture.rgba, done->picture.rgba) << "the same bytes again";

  options.with_margin = false, options.size = 300;
  const auto square = RectifyScan(sheet, "sheet.png", options);
  ASSERT_TRUE(square);
  EXPECT_EQ(square->picture.width, 300);
  EXPECT_EQ(square->picture.height, 300);
}

TEST(Rectify, WhatMaySpoilTheExemplarIsWarnedOf) {
  const auto warns = [](const Rectified& done, const std::string& words) {
    return std::any_of(done.report.warnings.begin(), done.report.warnings.end(),
                       [&](const std::string& warning) { return warning.find(words) != std::string::npos; });
  };
  Picture bare = CharcoalSheet();
  for (int y = 400; y < 900; ++y) {
    for (int x = 130; x < 500; ++x) std::fill_n(bare.At(x, y), 3, std::uint16_t(65535));
  }
  const auto done = RectifyScan(bare, "bare.png", Small());
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_NEAR(done->report.painted, 0.82, 0.05);
  EXPECT_TRUE(warns(*done, "of the sphere is bare paper"));
  EXPECT_TRUE(warns(*done, "edge is bare paper"));

  Picture shadowed = CharcoalSheet();
  for (int y = 0; y < shadowed.height; ++y) {
    for (int x = 0; x < shadowed.width / 2; ++x) {
      for (int c = 0; c < 3; ++c) shadowed.At(x, y)[c] = static_cast<std::uint16_t>(shadowed.At(x, y)[c] * 0.7);
    }
  }
  const auto shadow = RectifyScan(shadowed, "shadow.png", Small());
  ASSERT_TRUE(shadow) << shadow.error().message;
  EXPECT_TRUE(warns(*shadow, "shadow lies on the sheet"));

  Scan bright;
  bright.width = 450, bright.height = 360;
  for (const double exposure : {1.1, 1.6}) {
    bright.cast = {exposure, exposure, exposure};
    const auto exposed = RectifyScan(TakeScan(CharcoalSheet(), bright), "bright.png", Small());
    ASSERT_TRUE(exposed) << exposed.error().message;
    EXPECT_EQ(warns(*exposed, "of the paper is overexposed"), exposure > 1.2) << exposure;
  }

  Scan scan;
  scan.fill = 0.45;
  RectifyOptions options;
  options.size = 512;
  const auto coarse = RectifyScan(TakeScan(CharcoalSheet(), scan), "small.png", options);
  ASSERT_TRUE(coarse) << coarse.error().message;
  EXPECT_TRUE(warns(*coarse, "enlarged to 512"));
  EXPECT_FALSE(warns(*coarse, "bare")) << "neither sphere nor margin";
}

}  // namespace
}  // namespace scumble
