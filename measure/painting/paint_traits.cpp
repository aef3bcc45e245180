#include "measure/paint_traits.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/image/check.h"
#include "core/image/direction.h"

namespace scumble {
namespace {

constexpr int kAlike = 2 * 257 + 128;   // with the rounding to 8 bits
constexpr int kAlikeInScans = 6 * 257;  // with paper's and scanner's noise
constexpr int kAnyGrey = 65536;
constexpr int kClearlyGrey = 245 * 257;  // of the printed one, whose lights are paper

// `lightest`: the template counts as paper where it is lighter than this.
Patches FindBareTemplate(const PaintSheet& sheet, const Picture& bare, int tolerance, int lightest) {
  SCUMBLE_CHECK(bare.width == sheet.width() && bare.height == sheet.height());
  std::vector<std::uint8_t> alike(sheet.lightness().size(), 0);
  for (int y = 0; y < bare.height; ++y) {
    for (int x = 0; x < bare.width; ++x) {
      if (!sheet.Usable(x, y)) continue;
      const std::uint16_t *paint = sheet.picture().At(x, y), *drawn = bare.At(x, y);
      bool same = paint[3] == 65535 && drawn[0] < lightest;
      for (int c = 0; c < 3; ++c) same = same && std::abs(int(paint[c]) - drawn[c]) <= tolerance;
      alike[sheet.Index(x, y)] = same;
    }
  }
  const auto least = static_cast<std::size_t>(0.0005 * static_cast<double>(sheet.usable_pixels()));
  return FindPatches(MostlySet(alike, bare.width, bare.height, 4, 0.9), bare.width, bare.height,
                     std::max<std::size_t>(4, least));
}

// The printed sphere is on white paper; grey paper may have its tone.
bool IsOnWhite(const PaintSheet& sheet) {
  constexpr float kWhite = 0.85f;  // linear; 237 of 255
  const BarePaper ground = FindBarePaper(sheet.picture());
  return ground.kind != BarePaper::Kind::kPaper || std::min({ground.color.x, ground.color.y, ground.color.z}) >= kWhite;
}

double Percent(std::size_t part, std::size_t whole) {
  return whole > 0 ? 100.0 * static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

void MeasureSphere(const PaintSheet& sheet, PaintTraits& traits) {
  const PaintOnGround paint(sheet);
  traits.ground_known = paint.known();
  traits.disc = FindPaintedDisc(paint);
  traits.fringe_percent = 100.0 * FringeOfRim(paint);
  constexpr double kClearlyLit = 0.5;
  if (traits.light.correlation >= kClearlyLit) {
    traits.bare_shade = BareShade(paint, glm::vec3(DirectionFromAngles(traits.light.azimuth, traits.light.elevation)));
  }
  std::size_t covered = 0;
  for (int y = 0; y < sheet.height(); ++y) {
    for (int x = 0; x < sheet.width(); ++x) {
      const bool on_paper = paint.ground().kind == BarePaper::Kind::kPaper;
      covered += sheet.Usable(x, y) && sheet.Shows(x, y) && (!on_paper || paint.IsPaint(x, y));
    }
  }
  traits.covered_percent = Percent(covered, sheet.usable_pixels());
}

}  // namespace

PaintTraits MeasurePaint(const Exemplar& exemplar, double rim, const Picture* bare_template,
                         const Picture* printed_template) {
  const PaintSheet sheet(exemplar, rim);
  PaintTraits traits;
  traits.width = sheet.width(), traits.height = sheet.height(), traits.is_sphere = sheet.is_sphere();
  traits.tone = MeasureTone(sheet);
  traits.light = FindPaintedLight(sheet);
  traits.texture = MeasureTexture(sheet);
  traits.alpha = MeasureAlpha(sheet);
  traits.covered_percent = 100.0 - traits.alpha.transparent_percent + traits.alpha.translucent_percent;
  if (!sheet.is_sphere()) return traits;
  MeasureSphere(sheet, traits);
  if (bare_template) {
    traits.bare_template = FindBareTemplate(sheet, *bare_template, kAlike, kAnyGrey);
    if (printed_template && IsOnWhite(sheet)) {
      const Patches printed = FindBareTemplate(sheet, *printed_template, kAlikeInScans, kClearlyGrey);
      if (printed.pixels > traits.bare_template.pixels) traits.bare_template = printed;
    }
    traits.template_percent = Percent(traits.bare_template.pixels, sheet.usable_pixels());
    const Exemplar drawn{"template", *bare_template, std::nullopt};
    traits.template_light = FindPaintedLight(PaintSheet(drawn, rim));
  }
  return traits;
}

}  // namespace scumble
