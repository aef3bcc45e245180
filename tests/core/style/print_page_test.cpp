// The template's place on paper, against sums in millimetres.
#include "core/style/kit/print_page.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/style/sphere_template.h"
#include "tests/support/refusal.h"

namespace scumble {
namespace {

constexpr PaperSize kEverySize[] = {PaperSize::kAuto, PaperSize::kA4, PaperSize::kLetter, PaperSize::kA3,
                                    PaperSize::kFit};

TEST(PrintPage, TheTemplateAndItsWordsAreOnThePage) {
  for (const PaperSize paper : kEverySize) {
    for (const int dpi : {72, 150, 300, 600, 2400}) {
      for (const int size : {16, 100, 333, 1024, 1500, 2048, 8192}) {
        const auto page = PlacePage(paper, size, dpi);
        if (!page) continue;
        const double side = size + 2 * TemplateMargin(size), pixel = 25.4 / dpi;
        const double right = page->width_mm - (page->left + side) * pixel,
                     below = page->height_mm - (page->top + side) * pixel;
        // To a pixel: the corner is a whole one.
        EXPECT_GE(page->left * pixel, kPageEdgeMm - pixel);
        EXPECT_GE(right, kPageEdgeMm - pixel);
        EXPECT_NEAR(page->left * pixel, right, 1.01 * pixel) << "in the middle";
        EXPECT_NEAR(page->top * pixel, kPageEdgeMm, pixel);
        EXPECT_GE(below, kWordsMm + kPageEdgeMm - pixel) << size << " at " << dpi << " on " << page->name;
      }
    }
  }
}

TEST(PrintPage, PapersHaveTheirSizes) {
  const auto a4 = PlacePage(PaperSize::kA4, 1024, 300), letter = PlacePage(PaperSize::kLetter, 1024, 300);
  EXPECT_EQ(a4->name, "A4");
  EXPECT_DOUBLE_EQ(a4->width_mm, 210);
  EXPECT_DOUBLE_EQ(a4->height_mm, 297);
  EXPECT_DOUBLE_EQ(letter->width_mm, 215.9);
  EXPECT_DOUBLE_EQ(letter->height_mm, 279.4);
  EXPECT_DOUBLE_EQ(PlacePage(PaperSize::kA3, 1024, 300)->height_mm, 420);
}

TEST(PrintPage, TheLargestSphereThatIsNamedFitsAndOneMorePixelDoesNot) {
  for (const PaperSize paper : {PaperSize::kA4, PaperSize::kLetter, PaperSize::kA3}) {
    for (const int dpi : {72, 300, 601}) {
      int largest = 16;
      while (PlacePage(paper, largest + 1, dpi)) ++largest;
      ExpectRefusal(PlacePage(paper, largest + 1, dpi), ErrorKind::kUsage,
                    {"the largest sphere on it is", "--size " + std::to_string(largest) + " at", "--page"});
      ExpectRefusal(PlacePage(paper, 8192, dpi), ErrorKind::kUsage, {"--size " + std::to_string(largest) + " at"});
    }
  }
}

TEST(PrintPage, SmallSpheresAreScannedFiner) {
  EXPECT_EQ(ScanDpi(1024, 300), 300);
  EXPECT_EQ(ScanDpi(1024, 150), 300);
  EXPECT_EQ(ScanDpi(2048, 600), 600);
  EXPECT_EQ(ScanDpi(250, 300), 300);
  EXPECT_EQ(ScanDpi(249, 300), 350);
  EXPECT_EQ(ScanDpi(128, 300), 600) << "586 dots an inch make 250 pixels of 128";
}

TEST(PrintPage, AutoTakesTheFirstThatHoldsIt) {
  EXPECT_EQ(PlacePage(PaperSize::kAuto, 1024, 300)->name, "A4");
  EXPECT_EQ(PlacePage(PaperSize::kAuto, 2000, 300)->name, "A3");
  EXPECT_EQ(PlacePage(PaperSize::kAuto, 4096, 300)->name, "fit");
  EXPECT_EQ(PlacePage(PaperSize::kAuto, 4096, 600)->name, "A3");
}

TEST(PrintPage, NoPdfIsLargerThanPdfsMayBe) {
  EXPECT_TRUE(PlacePage(PaperSize::kFit, 8192, 72));
  ExpectRefusal(PlacePage(PaperSize::kFit, 20000, 72), ErrorKind::kUsage, {"5080 mm", "--dpi", "--only png,ora"});
}

TEST(PrintPage, LengthsAndPapersByName) {
  EXPECT_DOUBLE_EQ(*ParseLengthMm("150mm"), 150);
  EXPECT_DOUBLE_EQ(*ParseLengthMm("15 cm"), 150);
  EXPECT_DOUBLE_EQ(*ParseLengthMm("6in"), 152.4);
  EXPECT_DOUBLE_EQ(*ParseLengthMm("5.5\""), 139.7);
  for (const char* wrong : {"", "150", "mm", "-3mm", "0in", "inf mm", "nan in", "12 feet", "1e999mm", "12mmm"}) {
    ExpectRefusal(ParseLengthMm(wrong), ErrorKind::kUsage, {"150mm, 15cm or 6in"});
  }
  EXPECT_EQ(*ParsePaperSize("letter"), PaperSize::kLetter);
  EXPECT_EQ(*ParsePaperSize("auto"), PaperSize::kAuto);
  ExpectRefusal(ParsePaperSize("A5"), ErrorKind::kUsage, {"--page A5", "a4, letter, a3 or fit"});
}

}  // namespace
}  // namespace scumble
