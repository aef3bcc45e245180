// Pictures that no exemplar can be made of: each is refused, with a helpful reason.
#include <gtest/gtest.h>

#include "core/style/rectify.h"
#include "core/style/sphere_template.h"
#include "tests/support/refusal.h"
#include "tests/support/scan_fixtures.h"

namespace scumble {
namespace {

Picture Filled(int width, int height, std::uint16_t grey) {
  Picture picture(width, height);
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) picture.rgba[i] = i % 4 == 3 ? 65535 : grey;
  return picture;
}

void ExpectRefused(const Picture& picture, const std::vector<std::string>& words, const RectifyOptions& options = {}) {
  ExpectRefusal(RectifyScan(picture, "scan.png", options), ErrorKind::kInput, words);
}

// The lower right part of a sheet that lies straight in the picture.
Picture Cropped(const Picture& sheet, int x0, int y0) {
  Picture part(sheet.width - x0, sheet.height - y0);
  for (int y = 0; y < part.height; ++y) std::copy_n(sheet.At(x0, y + y0), 4 * std::size_t(part.width), part.At(0, y));
  return part;
}

TEST(RectifyRefusal, PicturesWithoutMarks) {
  for (const std::uint16_t grey : {0, 30000, 65535}) {
    ExpectRefused(Filled(600, 500, grey), {"scan.png (600×500 pixels)", "none of the template's 12", "whole sheet"});
  }
  Picture noise = Filled(700, 600, 0);
  for (std::size_t i = 0; i < noise.rgba.size(); ++i) noise.rgba[i] = static_cast<std::uint16_t>(Hash(5, i));
  ExpectRefused(noise, {"none of the template's 12"});
  const auto painting = ReadPicture(SCUMBLE_SOURCE_DIR "/exemplars/charcoal/lit.png");
  ASSERT_TRUE(painting);
  ExpectRefused(*painting, {"none of the template's 12", "crosses are older"});
  ExpectRefused(Filled(40, 1, 65535), {"too small", "300 dpi"});
}

TEST(RectifyRefusal, TooFewMarksAreNamed) {
  const Picture& sheet = CharcoalSheet();
  ExpectRefused(Cropped(sheet, 800, 800),
                {"shows 3 of the template's 12 marks", "right side, lower, lower right corner, bottom side, right",
                 "at least 4", "missing: upper left corner"});
  ExpectRefused(Cropped(sheet, 1170, 1170), {"too small"});
}

TEST(RectifyRefusal, HalfAPage) {
  ExpectRefused(Cropped(CharcoalSheet(), 640, 0),
                {"a part of the sphere only", "50% of it lies beyond the left border"});
}

// The four marks of the left side, coarse and noisy: they do not determine the sphere's right side.
TEST(RectifyRefusal, MarksOnOneSideThatLeaveTheOtherOpen) {
  Scan scan;
  scan.covered = {1, 2, 3, 4, 5, 6, 7, 8}, scan.noise = 8, scan.blur = 0.8, scan.fill = 0.36;
  ExpectRefused(TakeScan(CharcoalSheet(), scan), {"leave open where the sphere is", "on all sides"});
}

TEST(RectifyRefusal, MirroredPictures) {
  Scan scan;
  scan.mirrored = true, scan.tilt = 10, scan.noise = 2;
  ExpectRefused(TakeScan(CharcoalSheet(), scan), {"mirrored", "flip"});
}

TEST(RectifyRefusal, TwoTemplatesInOnePicture) {
  const Picture& sheet = CharcoalSheet();
  Picture both = Filled(2 * sheet.width + 50, sheet.height, 65535);
  for (int y = 0; y < sheet.height; ++y) {
    std::copy_n(sheet.At(0, y), 4 * std::size_t(sheet.width), both.At(0, y));
    std::copy_n(sheet.At(0, y), 4 * std::size_t(sheet.width), both.At(sheet.width + 50, y));
  }
  ExpectRefused(both, {"two templates", "cut"});
}

TEST(RectifyRefusal, AMosaicOfTemplatesIsRefusedBeforeItIsFitted) {
  std::vector<FoundMark> marks;
  for (std::size_t i = 0; i <= kMostMarks; ++i) {
    FoundMark mark;
    mark.id = int(i) % kFiducialCount;
    const double sheet = 200.0 * double(i / kFiducialCount);
    for (int c = 0; c < 4; ++c) mark.corners[std::size_t(c)] = 100.0 * PrintedCorner(mark.id, c) + sheet + 50.0;
    marks.push_back(mark);
  }
  EXPECT_FALSE(FitTemplate(marks, 1400, 1400)) << "one too many";
  marks.pop_back();
  EXPECT_TRUE(FitTemplate(marks, 1400, 1400)) << "five sheets";

  // Six sheets of 256 pixels; a sheet's marks are found as well as any.
  constexpr int kTile = 256;
  const int margin = TemplateMargin(kTile), side = kTile + 2 * margin;
  Picture sheet = Filled(side, side, 65535), mosaic = Filled(3 * side, 2 * side, 65535);
  DrawFiducials(sheet, kTile, margin);
  for (int y = 0; y < mosaic.height; ++y) {
    for (int k = 0; k < 3; ++k) std::copy_n(sheet.At(0, y % side), 4 * std::size_t(side), mosaic.At(k * side, y));
  }
  ExpectRefused(mosaic, {"several templates", "72 marks", "cut"});
}

// Squares of another dictionary: black borders with bits that are no mark's.
TEST(RectifyRefusal, MarksOfOtherPrograms) {
  Picture page = Filled(900, 700, 65535);
  for (int k = 0; k < 12; ++k) {
    for (int i = 0; i < 60 * 60; ++i) {
      const int column = i % 60 / 10, row = i / 600;
      const bool border = column % 5 == 0 || row % 5 == 0;
      const bool black = border || (column + row) % 2 == 0;
      if (black) std::fill_n(page.At(60 + k % 4 * 200 + i % 60, 60 + k / 4 * 200 + i / 60), 3, std::uint16_t(0));
    }
  }
  ExpectRefused(page, {"none of the template's 12", "Marks of other programs"});
}

TEST(RectifyRefusal, CurledPaper) {
  Scan scan;
  scan.curl = 0.08, scan.noise = 1;
  ExpectRefused(TakeScan(CharcoalSheet(), scan),
                {"do not lie as on a flat sheet", "at most 1.00%", "worst at the", "curled"});
}

// Its upper and its lower part have marks of their own, which are not those of two sheets.
TEST(RectifyRefusal, StronglyBentPaper) {
  const Picture& sheet = CharcoalSheet();
  constexpr int kMost = 240;
  Picture bent = Filled(sheet.width + kMost, sheet.height, 65535);
  for (int y = 0; y < sheet.height; ++y) {
    const double v = 2.0 * y / sheet.height - 1.0;
    std::copy_n(sheet.At(0, y), 4 * std::size_t(sheet.width), bent.At(int(kMost * v * v), y));
  }
  ExpectRefused(bent, {"do not lie as on a flat sheet", "curled"});
}

TEST(RectifyRefusal, MarksThatWereMovedOnTheSheet) {
  Picture sheet = Filled(1280, 1280, 65535);
  const Picture& source = CharcoalSheet();
  const auto copy = [&](int id, int x, int y) {
    const int left = int(128 + Fiducials()[std::size_t(id)].left * 1024),
              top = int(128 + Fiducials()[std::size_t(id)].top * 1024);
    for (int j = -10; j < 106; ++j) std::copy_n(source.At(left - 10, top + j), 4 * 116, sheet.At(x, y + j));
  };
  for (int k = 0; k < 6; ++k) copy(k * 2, 150 + 37 * k % 600 + 140 * (k % 3), 120 + 190 * ((k * 5) % 6));
  ExpectRefused(sheet, {"6 of the template's marks", "one sheet"});
}

TEST(RectifyRefusal, TooCoarseAndTooFine) {
  Scan scan;
  scan.fill = 0.3;
  const Picture small = TakeScan(CharcoalSheet(), scan);
  ExpectRefused(small, {"the sphere is 17", "at least 200 are needed", "times as fine", "go closer"});
  RectifyOptions options;
  options.dpi = 100;
  ExpectRefused(small, {"scan it at 600 dpi or more"}, options);

  ExpectRefusal(CheckScanSize(14032, 19843, 1200, "a3.tif"), ErrorKind::kInput,
                {"a3.tif is 14032×19843 pixels", "150 million", "scan it at 600 dpi"});
  ExpectRefusal(CheckScanSize(14032, 19843, 0, "a3.tif"), ErrorKind::kInput, {"scale it down"});
  EXPECT_TRUE(CheckScanSize(9921, 14032, 1200, "a4.tif")) << "A4 at 1200 dpi";
}

}  // namespace
}  // namespace scumble
