#include "measure/painting/paint_texture.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace scumble {
namespace {

constexpr int kLargestWindow = 128, kSmallestWindow = 16, kWindowsASide = 7;

// Whether every corner and every eighth pixel between them is usable.
bool IsInside(const PaintSheet& sheet, const PictureRegion& region) {
  const int step = std::max(1, region.width / 8);
  for (int y = 0; y < region.height; y += step) {
    for (int x = 0; x < region.width; x += step) {
      if (!sheet.Usable(region.x + x, region.y + y)) return false;
    }
  }
  return sheet.Usable(region.x + region.width - 1, region.y) && sheet.Usable(region.x, region.y + region.height - 1) &&
         sheet.Usable(region.x + region.width - 1, region.y + region.height - 1);
}

// A grid of windows, those that are not inside left out: on a sphere 21 to 25 of 49 stay.
std::vector<PictureRegion> Windows(const PaintSheet& sheet, int side) {
  std::vector<PictureRegion> windows;
  for (int j = 0; j < kWindowsASide; ++j) {
    for (int i = 0; i < kWindowsASide; ++i) {
      const PictureRegion region{(sheet.width() - side) * i / (kWindowsASide - 1),
                                 (sheet.height() - side) * j / (kWindowsASide - 1), side, side};
      if (IsInside(sheet, region)) windows.push_back(region);
    }
  }
  return windows;
}

double MeasureAnisotropy(const PaintSheet& sheet, const std::vector<PictureRegion>& windows) {
  const std::vector<float>& tones = sheet.lightness();
  double weights = 0.0, sum = 0.0;
  for (const PictureRegion& region : windows) {
    double xx = 0.0, yy = 0.0, xy = 0.0;
    for (int y = region.y + 1; y + 1 < region.y + region.height; ++y) {
      for (int x = region.x + 1; x + 1 < region.x + region.width; ++x) {
        const double dx = tones[sheet.Index(x + 1, y)] - tones[sheet.Index(x - 1, y)];
        const double dy = tones[sheet.Index(x, y + 1)] - tones[sheet.Index(x, y - 1)];
        xx += dx * dx, yy += dy * dy, xy += dx * dy;
      }
    }
    // Weight times coherence is the difference of the eigenvalues.
    weights += xx + yy;
    sum += std::hypot(xx - yy, 2.0 * xy);
  }
  return weights > 0.0 ? sum / weights : 0.0;
}

}  // namespace

TextureReport MeasureTexture(const PaintSheet& sheet) {
  RegularityOptions options;
  options.window = std::min(kLargestWindow, std::min(sheet.width(), sheet.height()) / 4);
  if (options.window < kSmallestWindow) return {};
  const std::vector<PictureRegion> windows = Windows(sheet, options.window);
  return {MeasureAnisotropy(sheet, windows), MeasureRegularity(sheet.lightness(), sheet.width(), windows, options)};
}

}  // namespace scumble
