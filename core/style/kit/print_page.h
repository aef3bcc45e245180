// The template's place on a sheet of paper, true to scale.
#pragma once

#include <string>

#include "core/image/status.h"

namespace scumble {

enum class PaperSize {
  kAuto,    // A4, or A3 where that is too small, or a page of the template's own size
  kA4,      // 210 × 297 mm
  kLetter,  // 8.5 × 11 in
  kA3,      // 297 × 420 mm
  kFit,     // as large as the template and the text under it need
};

struct PrintPage {
  std::string name;  // "A4"; "fit" for one of the template's own size
  double width_mm = 0, height_mm = 0;
  // The template's upper left corner from the page's, in the template's pixels: whole ones, so that the page rasterised
  // at its resolution shows the template's very pixels.
  int left = 0, top = 0;
};

// The white edge that most printers cannot print on.
inline constexpr double kPageEdgeMm = 8.0;
// Height of the text under the template.
inline constexpr double kWordsMm = 62.0;

inline double MillimetresOf(double pixels, int dpi) { return pixels * 25.4 / dpi; }

// Dots an inch at which a printed sphere should be scanned, in steps of 50. It is as fine as the sphere was printed, at
// least 300, and a quarter more than RectifyScan needs across a small one.
int ScanDpi(int size, int dpi);

// Places the template of a sphere `size` pixels across, printed at `dpi` pixels an inch. If the paper or any PDF cannot
// hold the template, the error is kUsage and gives the largest sphere that fits.
Expected<PrintPage> PlacePage(PaperSize paper, int size, int dpi);

// "a4", "letter", "a3", "fit", "auto".
Expected<PaperSize> ParsePaperSize(const std::string& text);

// A length on paper in millimetres, from "150mm", "15cm" or "6in". Without a unit, 0 or less it is kUsage.
Expected<double> ParseLengthMm(const std::string& text);

}  // namespace scumble
