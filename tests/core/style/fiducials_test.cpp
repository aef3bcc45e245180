// The printed marks: their places, their bits, their drawing.
#include "core/style/fiducials.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>
#include <string>

#include "core/image/color.h"
#include "core/image/hash.h"
#include "core/style/sphere_kit.h"

namespace scumble {
namespace {

// A marker's 4 × 4 bits, rows from the top; 1 is white.
std::uint16_t Bits(int id) {
  std::uint16_t bits = 0;
  for (int i = 0; i < 16; ++i)
    bits = static_cast<std::uint16_t>(bits << 1 | !FiducialIsBlack(id, 1 + i % 4, 1 + i / 4));
  return bits;
}

// A quarter turn clockwise of a marker's 4 × 4 bits.
std::uint16_t Turned(std::uint16_t bits) {
  std::uint16_t turned = 0;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      const int from = 4 * (3 - column) + row;
      turned = static_cast<std::uint16_t>(turned << 1 | (bits >> (15 - from) & 1));
    }
  }
  return turned;
}

TEST(Fiducials, TheyLieInTheMarginApartFromEachOtherAndFromTheSphere) {
  std::set<std::string> places;
  for (const Fiducial& mark : Fiducials()) {
    EXPECT_EQ(&mark - Fiducials().data(), mark.id);
    EXPECT_TRUE(places.insert(FiducialPlace(mark.id)).second) << "two of one name";
    const double x0 = mark.left - kFiducialQuiet, x1 = mark.left + kFiducialSide + kFiducialQuiet;
    const double y0 = mark.top - kFiducialQuiet, y1 = mark.top + kFiducialSide + kFiducialQuiet;
    EXPECT_GE(std::min(x0, y0), -kFiducialMargin);
    EXPECT_LE(std::max(x1, y1), 1 + kFiducialMargin);
    EXPECT_TRUE(x1 <= 0 || x0 >= 1 || y1 <= 0 || y0 >= 1) << "outside the sphere's square";
    const double near_x = std::clamp(0.5, mark.left, mark.left + kFiducialSide);
    const double near_y = std::clamp(0.5, mark.top, mark.top + kFiducialSide);
    EXPECT_GT(std::hypot(near_x - 0.5, near_y - 0.5), 0.5 + 0.06) << "room for paint that runs over the sphere's edge";
    for (const Fiducial& other : Fiducials()) {
      if (other.id == mark.id) continue;
      const double apart = std::max(std::abs(other.left - mark.left), std::abs(other.top - mark.top));
      EXPECT_GE(apart, kFiducialSide + 2 * kFiducialQuiet) << mark.id << " and " << other.id;
    }
  }
  for (int size = 1; size < 9000; ++size) ASSERT_GE(TemplateMargin(size), kFiducialMargin * size);
}

TEST(Fiducials, TwoWrongBitsNeverMakeAnotherMarkerNorAnotherDirection) {
  for (int a = 0; a < kFiducialCount; ++a) {
    for (int b = 0; b < kFiducialCount; ++b) {
      std::uint16_t turned = Bits(b);
      for (int turn = 0; turn < 4; ++turn, turned = Turned(turned)) {
        if (a == b && turn == 0) continue;
        EXPECT_GE(std::popcount(unsigned(Bits(a) ^ turned)), 5) << a << " against " << b << " turned " << turn;
      }
      EXPECT_EQ(turned, Bits(b)) << "four turns are none";
    }
  }
}

// As the library draws them: markers 0 and 1 of tag16h5.
TEST(Fiducials, BitsAreReadFromTheUpperLeft) {
  const std::string drawn[2][6] = {{"######", "### ##", "###  #", "#### #", "# #  #", "######"},
                                   {"######", "### ##", "#   ##", "# # ##", "## # #", "######"}};
  for (int i = 0; i < 72; ++i) {
    const int id = i / 36, row = i / 6 % 6, column = i % 6;
    EXPECT_EQ(FiducialIsBlack(id, column, row), drawn[id][row][std::size_t(column)] == '#')
        << id << ": " << column << ", " << row;
  }
}

// Each pixel is the mean of many points in linear light.
TEST(Fiducials, DrawnAsTheMeanOfManyPoints) {
  for (const int size : {128, 131, 200}) {
    const int margin = TemplateMargin(size), side = size + 2 * margin, points = 8;
    Picture picture(side, side);
    constexpr std::uint16_t kGround = 30000;
    for (std::size_t i = 0; i < picture.rgba.size(); ++i) picture.rgba[i] = i % 4 == 3 ? 65535 : kGround;
    DrawFiducials(picture, size, margin);
    double worst = 0;
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        double light = 0;
        for (int j = 0; j < points * points; ++j) {
          const double u = (x + (j % points + 0.5) / points - margin) / size;
          const double v = (y + (j / points + 0.5) / points - margin) / size;
          double here = Srgb16ToLinear(kGround);
          for (const Fiducial& mark : Fiducials()) {
            const double column = std::floor((u - mark.left) / kFiducialModule),
                         row = std::floor((v - mark.top) / kFiducialModule);
            if (std::min(column, row) < -1 || std::max(column, row) > 6) continue;
            const bool border = std::min(column, row) < 0 || std::max(column, row) > 5;
            here = border || !FiducialIsBlack(mark.id, int(column), int(row)) ? 1.0 : 0.0;
          }
          light += here / (points * points);
        }
        for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(Srgb16ToLinear(picture.At(x, y)[c]) - light));
        ASSERT_EQ(picture.At(x, y)[3], 65535);
      }
    }
    EXPECT_LT(worst, 0.13) << "size " << size;
  }
}

TEST(Fiducials, OnTransparentPixelsTheyAreOpaque) {
  const int size = 192, margin = TemplateMargin(size);
  Picture picture(size + 2 * margin, size + 2 * margin);
  DrawFiducials(picture, size, margin);
  EXPECT_EQ(picture.At(0, 0)[3], 65535) << "quiet zone";
  EXPECT_EQ(picture.At(0, 0)[0], 65535);
  EXPECT_EQ(picture.At(4, 4)[3], 65535) << "border";
  EXPECT_EQ(picture.At(4, 4)[0], 0);
  EXPECT_EQ(picture.At(margin + 50, margin + 50)[3], 0) << "the sphere's square";
  EXPECT_EQ(picture.At(margin + size / 2, 4)[3], 0) << "the middle of a side";
}

TEST(Fiducials, AreSeenInPlaceAndNowhereElse) {
  for (const int size : {128, 133, 512, 1024}) {
    const int margin = TemplateMargin(size), side = size + 2 * margin;
    Picture picture(side, side);
    std::fill(picture.rgba.begin(), picture.rgba.end(), 65535);
    EXPECT_EQ(FiducialsInPlace(picture, size, margin), 0);
    DrawFiducials(picture, size, margin);
    EXPECT_EQ(FiducialsInPlace(picture, size, margin), kFiducialCount);
    EXPECT_EQ(FiducialsInPlace(picture, size - size / 16 * 2, margin + size / 16), 0) << "of another size";
    EXPECT_EQ(FiducialsInPlace(picture, size, margin + 1), 0);
    for (int y = 0; y < margin; ++y) {
      for (int x = 0; x < margin; ++x) picture.At(x, y)[1] = 30000;
    }
    EXPECT_EQ(FiducialsInPlace(picture, size, margin), kFiducialCount - 1) << "one painted over";
    for (std::size_t i = 0; i < picture.rgba.size(); ++i) picture.rgba[i] = static_cast<std::uint16_t>(Hash(size, i));
    EXPECT_EQ(FiducialsInPlace(picture, size, margin), 0) << "noise";
  }
  EXPECT_EQ(FiducialsInPlace(Picture(), 0, 0), 0);
  EXPECT_FALSE(FiducialsFit(127));
  EXPECT_TRUE(FiducialsFit(128));
}

}  // namespace
}  // namespace scumble
