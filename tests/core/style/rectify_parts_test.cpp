// The parts of --rectify against formulas.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/image/color.h"
#include "core/image/hash.h"
#include "core/style/scan/homography.h"
#include "core/style/scan/marker_detection.h"
#include "core/style/scan/resample_scan.h"
#include "core/style/sphere_template.h"
#include "tests/support/scan_fixtures.h"

namespace scumble {
namespace {

TEST(Homography, FourPointsAreMetAndMoreAreAveraged) {
  const glm::dmat3 truth(900, 40, 0.2, -60, 800, -0.1, 300, 200, 1);
  std::vector<glm::dvec2> from, to;
  for (int i = 0; i < 40; ++i) {
    from.emplace_back(UnitFloat(Hash(1, i)), UnitFloat(Hash(2, i)));
    to.push_back(Project(truth, from.back()));
    if (i != 3 && i != 39) continue;
    const auto map = FitHomography(from, to);
    ASSERT_TRUE(map);
    for (int k = 0; k < 9; ++k)
      EXPECT_NEAR((*map)[k / 3][k % 3], truth[k / 3][k % 3], 1e-6 * (1 + std::abs(truth[k / 3][k % 3])));
  }
}

TEST(Homography, WhatDoesNotDetermineItGivesNone) {
  const std::array<glm::dvec2, 4> line{{{0, 0}, {1, 1}, {2, 2}, {3, 3}}}, square{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  EXPECT_FALSE(FitHomography(line, square));
  EXPECT_FALSE(FitHomography(std::span(square).first(3), std::span(square).first(3)));
  std::array<double, 4> singular{1, 2, 2, 4};
  std::array<double, 2> right{1, 2};
  EXPECT_FALSE(SolveLinear(singular.data(), right.data(), 2));
}

Picture Grey(int width, int height, const auto& light) {
  Picture picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::fill_n(picture.At(x, y), 3, Srgb16FromLinear(float(light(x, y))));
      picture.At(x, y)[3] = 65535;
    }
  }
  return picture;
}

TEST(MarkerDetection, CornersAreFoundToAFractionOfAPixel) {
  Scan scan;
  scan.rotation = 17, scan.tilt = 15, scan.fill = 0.7, scan.noise = 4, scan.blur = 0.8;
  const ScanCamera camera(scan);
  const std::vector<FoundMark> marks = FindMarks(TakeScan(CharcoalSheet(), scan));
  ASSERT_EQ(marks.size(), std::size_t(kFiducialCount));
  double squares = 0;
  for (const FoundMark& mark : marks) {
    EXPECT_NEAR(mark.blur_pixels, 0.9, 0.4) << "and what the pixels' own size adds";
    for (int c = 0; c < 4; ++c) {
      const double off = glm::length(mark.corners[std::size_t(c)] - camera.ToPicture(PrintedCorner(mark.id, c)));
      EXPECT_LT(off, 0.6);
      squares += off * off / 48;
    }
  }
  EXPECT_LT(std::sqrt(squares), 0.2) << "pixels, root mean square";
}

// From the smallest template that a scan may show: all marks, at their places. Half a pixel off would show.
TEST(MarkerDetection, DrawnMarksAreReadAtAnySize) {
  for (int size = 200; size < 1300; size += 97) {
    const int margin = TemplateMargin(size), side = size + 2 * margin;
    Picture picture = Grey(side, side, [](int, int) { return 1.0; });
    DrawFiducials(picture, size, margin);
    const std::vector<FoundMark> marks = FindMarks(picture);
    ASSERT_EQ(marks.size(), std::size_t(kFiducialCount)) << size;
    for (const FoundMark& mark : marks) {
      for (int c = 0; c < 4; ++c) {
        const glm::dvec2 truth = double(margin) + PrintedCorner(mark.id, c) * double(size);
        EXPECT_LT(glm::length(mark.corners[std::size_t(c)] - truth), 0.1) << size << ", " << FiducialPlace(mark.id);
      }
    }
  }
}

TEST(ResampleScan, RampsStayRampsAtAnyScale) {
  const Picture ramp = Grey(400, 300, [](int x, int y) { return 0.1 + 0.0015 * (x + 0.5) + 0.0005 * (y + 0.5); });
  for (const double shrink : {0.4, 1.0, 1.7, 3.0, 6.3}) {
    const int width = 40, height = 30;
    const auto seen =
        ResampleScan(ramp, width, height, shrink, [&](glm::dvec2 p) { return glm::dvec2(30, 20) + p * shrink; });
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const double px = 30 + (x + 0.5) * shrink, py = 20 + (y + 0.5) * shrink;
        ASSERT_NEAR(seen.rgb[std::size_t(3 * (y * width + x) + 1)], 0.1 + 0.0015 * px + 0.0005 * py, 2e-3) << shrink;
      }
    }
  }
}

// A pattern finer than the new pixels must become its mean, not another pattern.
TEST(ResampleScan, FinePatternsBecomeGreyAndCoarseOnesStay) {
  const Picture lines = Grey(600, 600, [](int x, int y) { return (x / 3 + y / 3) % 2 ? 0.9 : 0.1; });
  const auto grey = ResampleScan(lines, 60, 60, 8.0, [](glm::dvec2 p) { return glm::dvec2(40, 40) + p * 8.0; });
  for (const float value : grey.rgb) ASSERT_NEAR(value, 0.5, 0.03);
  const Picture same = Grey(60, 60, [](int x, int y) { return UnitFloat(Hash(x, y)); });
  const auto copy = ResampleScan(same, 60, 60, 1.0, [](glm::dvec2 p) { return p; });
  for (int i = 0; i < 3600; ++i) {
    ASSERT_NEAR(copy.rgb[std::size_t(3 * i)], Srgb16ToLinear(same.rgba[std::size_t(4 * i)]), 1e-5);
  }
}

TEST(ResampleScan, BeyondTheScanItsBorderGoesOn) {
  const Picture one = Grey(1, 1, [](int, int) { return 0.25; });
  const auto seen = ResampleScan(one, 5, 4, 2.0, [](glm::dvec2 p) { return p * 900.0 - 2000.0; });
  for (const float value : seen.rgb) EXPECT_NEAR(value, 0.25, 1e-4);
}

}  // namespace
}  // namespace scumble
