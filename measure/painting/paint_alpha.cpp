#include "measure/painting/paint_alpha.h"

#include <cmath>
#include <vector>

#include "core/painting/bare_paper.h"

namespace scumble {
namespace {

constexpr std::uint16_t kOpaque = 65535;
constexpr int kEdge = 2;  // pixels that the soft edge of a hole takes

// The nearest opaque texel along the eight main directions, or null.
const std::uint16_t* OpaqueNear(const Picture& picture, int x, int y) {
  for (int reach = 1; reach <= 4; ++reach) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const int px = x + reach * dx, py = y + reach * dy;
        if (px < 0 || py < 0 || px >= picture.width || py >= picture.height) continue;
        if (const std::uint16_t* texel = picture.At(px, py); texel[3] == kOpaque) return texel;
      }
    }
  }
  return nullptr;
}

bool IsPremultiplied(const Picture& picture) {
  double as_straight = 0.0, as_premultiplied = 0.0;
  int pixels = 0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const std::uint16_t* texel = picture.At(x, y);
      if (texel[3] < kOpaque / 20 || texel[3] > kOpaque / 20 * 19) continue;
      const std::uint16_t* opaque = OpaqueNear(picture, x, y);
      if (!opaque) continue;
      ++pixels;
      for (int c = 0; c < 3; ++c) {
        as_straight += std::fabs(double(texel[c]) - opaque[c]);
        as_premultiplied += std::fabs(texel[c] - opaque[c] * (texel[3] / 65535.0));
      }
    }
  }
  return pixels >= 16 && as_premultiplied < 0.5 * as_straight;
}

}  // namespace

AlphaReport MeasureAlpha(const PaintSheet& sheet) {
  const Picture& picture = sheet.picture();
  std::vector<std::uint8_t> clear(sheet.lightness().size(), 0), veiled(clear.size(), 0);
  std::size_t not_opaque = 0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const std::uint16_t alpha = picture.At(x, y)[3];
      if (!sheet.Usable(x, y) || alpha == kOpaque) continue;
      ++not_opaque;
      (sheet.Shows(x, y) ? veiled : clear)[sheet.Index(x, y)] = 1;
    }
  }
  AlphaReport report;
  report.clear_corners = sheet.is_sphere() && FindBarePaper(picture).kind == BarePaper::Kind::kTransparent;
  if (sheet.soft_edge() > sheet.style_rim()) report.soft_edge = sheet.soft_edge();
  if (not_opaque == 0 && report.soft_edge == 0) return report;
  report.premultiplied = IsPremultiplied(picture);
  if (not_opaque == 0) return report;
  const std::vector<std::uint8_t> beside = MostlySet(clear, picture.width, picture.height, kEdge, 1e-9);
  std::vector<std::uint8_t> holes = clear;
  for (std::size_t i = 0; i < veiled.size(); ++i) {
    if (veiled[i] && beside[i]) holes[i] = 1, veiled[i] = 0;
  }
  report.holes = FindPatches(holes, picture.width, picture.height);
  report.translucent = FindPatches(veiled, picture.width, picture.height);
  const double percent = 100.0 / static_cast<double>(sheet.usable_pixels());
  report.transparent_percent = percent * static_cast<double>(not_opaque);
  report.translucent_percent = percent * static_cast<double>(report.translucent.pixels);
  return report;
}

}  // namespace scumble
