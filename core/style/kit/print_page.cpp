#include "core/style/kit/print_page.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "core/style/fiducials.h"
#include "core/style/sphere_template.h"

namespace scumble {
namespace {

constexpr double kMmPerInch = 25.4;

struct Sheet {
  PaperSize size;
  const char* option;
  const char* name;
  double width_mm, height_mm;
};
constexpr std::array<Sheet, 3> kPapers{{{PaperSize::kA4, "a4", "A4", 210, 297},
                                        {PaperSize::kLetter, "letter", "Letter", 8.5 * kMmPerInch, 11 * kMmPerInch},
                                        {PaperSize::kA3, "a3", "A3", 297, 420}}};

// "86.7", "210"
std::string Short(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  std::string number = text;
  if (number.size() > 2 && number.substr(number.size() - 2) == ".0") number.resize(number.size() - 2);
  return number;
}

int TemplateSide(int size) { return size + 2 * TemplateMargin(size); }

PrintPage Place(const std::string& name, double width_mm, double height_mm, int side, int dpi) {
  const double width = width_mm / kMmPerInch * dpi, top = kPageEdgeMm / kMmPerInch * dpi;
  return {name, width_mm, height_mm, static_cast<int>(std::lround((width - side) / 2)),
          static_cast<int>(std::lround(top))};
}

// Width and height that the paper leaves for the template.
double Room(const Sheet& paper) {
  return std::min(paper.width_mm - 2 * kPageEdgeMm, paper.height_mm - 2 * kPageEdgeMm - kWordsMm);
}

// The largest sphere, in pixels, whose template is that long at most.
int LargestSphere(double room_mm, int dpi) {
  const int side = static_cast<int>(room_mm / kMmPerInch * dpi);
  int size = side;
  while (size > 0 && TemplateSide(size) > side) --size;
  return size;
}

Expected<PrintPage> Fitting(int size, int dpi) {
  constexpr double kNarrowest = 170.0;      // for the text
  constexpr double kLargestPdfMm = 5080.0;  // 14,400 points, annex C of ISO 32000-1
  const double side = MillimetresOf(TemplateSide(size), dpi);
  const double width = std::max(side, kNarrowest) + 2 * kPageEdgeMm, height = side + 2 * kPageEdgeMm + kWordsMm;
  if (std::max(width, height) > kLargestPdfMm) {
    return UsageError("a sphere of " + Short(MillimetresOf(size, dpi)) + " mm makes a page of " + Short(width) + " × " +
                      Short(height) + " mm, and a PDF page is at most " + Short(kLargestPdfMm) +
                      " mm a side: take a higher --dpi or a smaller sphere, or leave the PDF out: --only png,ora");
  }
  // Whole points: readers round them differently.
  const auto whole = [](double mm) { return std::ceil(mm / kMmPerInch * 72) * kMmPerInch / 72; };
  return Place("fit", whole(width), whole(height), TemplateSide(size), dpi);
}

}  // namespace

int ScanDpi(int size, int dpi) {
  constexpr double kSpare = 1.25;
  constexpr int kUsual = 300, kStep = 50;
  const double least = kSpare * kMinScanSphere * dpi / size;
  return std::max({kUsual, dpi, static_cast<int>(std::ceil(least / kStep)) * kStep});
}

Expected<PrintPage> PlacePage(PaperSize wanted, int size, int dpi) {
  const double side = MillimetresOf(TemplateSide(size), dpi);
  for (const Sheet& paper : kPapers) {
    const bool candidate = wanted == PaperSize::kAuto ? paper.size != PaperSize::kLetter : wanted == paper.size;
    if (!candidate) continue;
    if (side <= Room(paper)) return Place(paper.name, paper.width_mm, paper.height_mm, TemplateSide(size), dpi);
    if (wanted == PaperSize::kAuto) continue;
    const int largest = LargestSphere(Room(paper), dpi);
    return UsageError("a sphere of " + Short(MillimetresOf(size, dpi)) + " mm with its margin is " + Short(side) +
                      " mm wide, and " + paper.name + " paper (" + Short(paper.width_mm) + " × " +
                      Short(paper.height_mm) + " mm) has room for " + Short(Room(paper)) +
                      " mm: the largest sphere on it is " + Short(std::floor(10 * MillimetresOf(largest, dpi)) / 10) +
                      " mm, --size " + std::to_string(largest) + " at " + std::to_string(dpi) +
                      " dpi; or take a larger --page, or --page fit");
  }
  return Fitting(size, dpi);
}

Expected<PaperSize> ParsePaperSize(const std::string& text) {
  for (const Sheet& paper : kPapers) {
    if (text == paper.option) return paper.size;
  }
  if (text == "fit") return PaperSize::kFit;
  if (text == "auto") return PaperSize::kAuto;
  return UsageError("--page " + text + ": expected auto, a4, letter, a3 or fit");
}

Expected<double> ParseLengthMm(const std::string& text) {
  const Error wrong = UsageError("'" + text + "': expected a length on paper with its unit, as 150mm, 15cm or 6in");
  double value = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (parsed.ec != std::errc() || !(value > 0) || !std::isfinite(value)) return wrong;
  std::string_view unit(parsed.ptr, std::size_t(text.data() + text.size() - parsed.ptr));
  while (!unit.empty() && unit.front() == ' ') unit.remove_prefix(1);
  if (unit == "mm") return value;
  if (unit == "cm") return value * 10;
  if (unit == "in" || unit == "\"") return value * kMmPerInch;
  return wrong;
}

}  // namespace scumble
