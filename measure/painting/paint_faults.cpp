#include "measure/paint_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace scumble {
namespace {

using Weight = PaintFault::Weight;

// Limits, calibrated on the bundled styles, all without faults, and on exemplars with one mistake each.
constexpr int kSmallest = 256;                         // pixels
constexpr double kMarginRatio = 0.8;                   // sphere to template: 1 / (1 + 2 · 1/8)
constexpr double kOffCentre = 0.01;                    // of the diameter
constexpr double kTooSmall = 0.985;                    // of the radius
constexpr double kTurned = 1.0;                        // degrees: a rim moves by 0.9% of the diameter
constexpr double kLeastFringe = 4.0;                   // % of the rim
constexpr double kLeastTemplate = 0.2;                 // % of the disc
constexpr double kLeastTranslucent = 0.1;              // % of the disc
constexpr double kLeastRange = 25.0;                   // L*, of the style
constexpr double kLeastRangeOfOne = 10.0;              // L*, of one of several lights
constexpr double kSeesLight = 0.3, kClearLight = 0.5;  // correlation
constexpr double kOtherLight = 45.0;                   // degrees
// A pattern that is equally regular everywhere; or less so, but as strong after many periods as after one; or with a
// direction of its own in each window. Hatching by hand, ink and woodcut included, stays below 0.35, 0.7 of its peak,
// and 0.5.
constexpr double kRegular = 0.45, kWeakly = 0.15, kEchoes = 0.85, kRegularLocally = 0.6;

// Of a percentage that is not 0.
std::string Percent(double percent) {
  if (percent < 0.05) return "less than 0.1%";
  return percent < 9.95 ? fmt::format("{:.1f}%", percent) : fmt::format("{:.0f}%", percent);
}

class Faults {
 public:
  Faults(const PaintTraits& traits, const PaintFaultContext& context) : traits_(traits), context_(context) {}

  void Add(const char* code, std::string what, std::string remedy) {
    found_.push_back({code, Weight::kMistake, std::move(what), std::move(remedy), std::nullopt});
  }
  // `place` in the picture, which may be cut out of its file.
  void AddAt(const char* code, int x, int y, std::string what, std::string remedy) {
    const std::pair<int, int> place(x + context_.origin.x, y + context_.origin.y);
    found_.push_back({code, Weight::kMistake, fmt::format("{}, around x={}, y={}", what, place.first, place.second),
                      std::move(remedy), place});
  }
  void AddOffCentre(double x, double y, double dx, double dy);
  void AddSmallSphere(double x, double y, double radius);
  void Remark(const char* code, std::string what, std::string remedy) {
    Add(code, std::move(what), std::move(remedy));
    found_.back().weight = Weight::kRemark;
  }
  bool Has(const std::string& code) const {
    return std::any_of(found_.begin(), found_.end(), [&](const PaintFault& fault) { return fault.code == code; });
  }

  void LookAtSize();
  void LookAtMarks();
  void LookAtDisc();
  void LookAtHoles();
  void LookAtAlpha();
  void LookAtTone();
  void LookAtPattern();
  bool Misplaced() const { return Has("margin") || Has("off-centre") || Has("small-sphere") || Has("turned"); }
  std::vector<PaintFault> Take() { return std::move(found_); }

 private:
  const char* Thing() const { return traits_.is_sphere ? "sphere" : "painting"; }

  const PaintTraits& traits_;
  const PaintFaultContext& context_;
  std::vector<PaintFault> found_;
};

void Faults::LookAtSize() {
  const int size = std::max(traits_.width, traits_.height);
  if (size < kSmallest) {
    Add("too-small", fmt::format("the picture is {} pixels wide, too few for strokes to be seen", size),
        "paint at 1024, 256 at the least: scumble sphere --size 1024");
  }
  if (size < context_.largest_size) {
    Add("other-size",
        fmt::format(
            "it is {} pixels wide and the style's largest painting {}: all are brought to the first one's size, and "
            "their strokes with them",
            size, context_.largest_size),
        "paint all lights at one size");
  }
}

// "24 pixels left and 3 up"
std::string Variant(double dx, double dy) {
  const long x = std::lround(dx), y = std::lround(dy);
  std::string way;
  if (x != 0) way = fmt::format("{} pixels {}", std::abs(x), x > 0 ? "to the right" : "to the left");
  if (y != 0) way += fmt::format("{}{} pixels {}", way.empty() ? "" : " and ", std::abs(y), y > 0 ? "down" : "up");
  return way;
}

void Faults::AddOffCentre(double x, double y, double dx, double dy) {
  Add("off-centre",
      fmt::format("the painted sphere is {:.1f}% of its diameter off the middle; its centre is at x={:.0f}, y={:.0f}",
                  100.0 * std::hypot(dx, dy) / traits_.width, x + context_.origin.x, y + context_.origin.y),
      fmt::format("move the painting {}", Variant(-dx, -dy)));
}

void Faults::AddSmallSphere(double x, double y, double radius) {
  const double ratio = 2.0 * radius / traits_.width;
  Add("small-sphere",
      fmt::format("the painted sphere fills {:.1f}% of the square's width; its rim takes what lies round it",
                  100.0 * ratio),
      fmt::format("enlarge the painting to {:.1f}%, or crop it to the sphere: {:.0f} pixels from x={:.0f}, y={:.0f}",
                  100.0 / ratio, 2.0 * radius, x - radius + context_.origin.x, y - radius + context_.origin.y));
}

void Faults::LookAtMarks() {
  if (!context_.marked) return;
  const double middle = 0.5 * traits_.width;
  const MarkedSphere& marked = *context_.marked;
  const double dx = marked.x - middle, dy = marked.y - middle;
  if (std::hypot(dx, dy) > kOffCentre * traits_.width) AddOffCentre(marked.x, marked.y, dx, dy);
  if (marked.radius < kTooSmall * middle) AddSmallSphere(marked.x, marked.y, marked.radius);
  if (std::fabs(marked.turn) > kTurned) {
    Add("turned",
        fmt::format("the painting is turned by {:.1f}°, as the template's marks show", std::fabs(marked.turn)),
        fmt::format("turn it back {}", marked.turn > 0 ? "counter-clockwise" : "clockwise"));
  }
}

void Faults::LookAtDisc() {
  const double size = traits_.width, middle = 0.5 * size;
  const PaintedDisc& disc = traits_.disc;
  const double dx = disc.x - middle, dy = disc.y - middle, shift = std::hypot(dx, dy), ratio = disc.radius / middle;
  const bool as_in_template = disc.found && std::fabs(ratio - kMarginRatio) < 0.015 && shift < 0.02 * size;
  if (context_.shows_marks || as_in_template) {
    const int sphere = static_cast<int>(std::lround(size * kMarginRatio));
    return Add(
        "margin",
        fmt::format("this is a whole template: the sphere takes {} of {} pixels, the rest is the template's margin",
                    sphere, traits_.width),
        fmt::format(
            "crop it to the middle {0}×{0} pixels, or name the guides.exr that came with the template as guides "
            "in style.toml",
            sphere));
  }
  if (!disc.found) return;
  // If paint covers the whole sphere, its own outline does no harm.
  if (shift > kOffCentre * size && disc.radius - shift < 0.995 * middle) {
    return AddOffCentre(disc.x, disc.y, dx, dy);
  }
  if (ratio < kTooSmall) AddSmallSphere(disc.x, disc.y, disc.radius);
}

void Faults::LookAtHoles() {
  const Patches &holes = traits_.alpha.holes, &bare = traits_.bare_template, &shade = traits_.bare_shade;
  if (holes.pixels > 0) {
    const double share = traits_.alpha.transparent_percent - traits_.alpha.translucent_percent;
    AddAt("holes", holes.x, holes.y,
          fmt::format("{} of the {} is transparent and will be so in pictures, in {} hole{}, the largest",
                      Percent(share), Thing(), holes.count, holes.count == 1 ? "" : "s"),
          "fill the holes if that is not wanted");
  }
  if (traits_.template_percent >= kLeastTemplate) {
    AddAt(
        "bare-template", bare.x, bare.y,
        fmt::format("{} of the sphere is still the template's own grey, most of it", Percent(traits_.template_percent)),
        "paint over it, or switch the template's layer off before you export");
  }
  if (Misplaced()) return;
  if (traits_.fringe_percent >= kLeastFringe) {
    Add("fringe",
        fmt::format(
            "paper shows at {:.0f}% of the sphere's rim, where the paint ends too early; outlines will have a fringe",
            traits_.fringe_percent),
        "let strokes run over the sphere's edge, some 10 pixels: what lies outside is never shown");
  }
  if (shade.pixels > 0) {
    AddAt("bare-paper", shade.x, shade.y, "bare paper shows in the shade and will look like light there",
          "paint over it; leave paper for lights alone");
  }
}

void Faults::LookAtAlpha() {
  const AlphaReport& alpha = traits_.alpha;
  if (alpha.soft_edge > 0) {
    Add("soft-edge", DescribeSoftEdge(alpha.soft_edge),
        fmt::format("write rim = {} into [transfer], or flatten the picture on its paper", alpha.soft_edge));
  }
  if (alpha.premultiplied) {
    Add("premultiplied", "colours fade to black where the paint is see-through: they were saved premultiplied by alpha",
        "export with straight (unassociated) alpha, or flatten the picture on its paper");
  } else if (alpha.translucent_percent >= kLeastTranslucent) {
    AddAt("see-through", alpha.translucent.x, alpha.translucent.y,
          fmt::format("{} of the {} is half see-through; what is behind objects will shine through, most of it",
                      Percent(alpha.translucent_percent), Thing()),
          "flatten the picture on its paper before you export it; a soft edge alone is left out by a larger rim");
  }
  if (alpha.clear_corners && context_.has_paper && alpha.holes.pixels == 0 && alpha.translucent.pixels == 0) {
    Remark("clear-corners", "round the sphere the picture is transparent, and the style puts paper behind",
           "flatten the picture on that paper if it is meant to look like one sheet");
  }
}

std::string InWords(const PaintedLight& light) {
  return fmt::format("azimuth {:.0f}°, elevation {:.0f}°", light.azimuth, light.elevation);
}

void Faults::LookAtTone() {
  const double range = context_.several ? context_.tonal_range : traits_.tone.range();
  if (context_.brightest && range < kLeastRange) {
    Add("flat",
        fmt::format("light and dark differ by {:.0f}% only (lightness {:.0f} to {:.0f} of 100), shapes will look flat",
                    range, traits_.tone.darkest, traits_.tone.brightest),
        "paint lights lighter and shades darker");
  } else if (context_.several && traits_.tone.range() < kLeastRangeOfOne) {
    Add("flat",
        fmt::format("light and dark differ by {:.0f}% only in this light (lightness {:.0f} to {:.0f} of 100), shapes "
                    "will look flat",
                    traits_.tone.range(), traits_.tone.darkest, traits_.tone.brightest),
        "let the form be read here too: reflected light, a darker core");
  }
  if (Has("flat") || !context_.brightest) return;
  const PaintedLight& light = traits_.light;
  if (light.correlation < kSeesLight) {
    return Add("no-light", "light and dark do not follow the form: no light can be made out",
               "paint one side light and the other dark, as the template shows it");
  }
  if (!traits_.template_light || light.correlation < kClearLight) return;
  const PaintedLight& drawn = *traits_.template_light;
  const double angle = AngleBetween(light, drawn);
  if (angle < kOtherLight) return;
  const std::string what = fmt::format("the painted light comes from {}, {:.0f}° away from the template's ({})",
                                       InWords(light), angle, InWords(drawn));
  if (context_.knows_guides) {
    Add("other-light", what,
        "turn or mirror the painting back, or make a template for that light: scumble sphere --light");
  } else {
    Remark("other-light", what, "nothing if that is wanted; beside the bundled styles it will look lit from elsewhere");
  }
}

void Faults::LookAtPattern() {
  const RegularityReport& report = traits_.texture.regularity;
  const bool machined = report.peak >= kWeakly && report.echo >= kEchoes * report.peak;
  if (report.peak < kRegular && !machined && report.local_echo < kRegularLocally) return;
  AddAt("regular-pattern", report.x, report.y,
        fmt::format(
            "a regular pattern ({}) comes back every {:.1f} pixels at {:.0f}°, {:.0f}% the same; it will tear where "
            "chunks of the painting meet; clearest",
            report.grid ? "dots, squares or weave" : "even lines", report.period, report.direction,
            100.0 * std::max(report.peak, report.local_echo)),
        report.grid ? "take halftone screens, canvas and pattern fills out; scan paper without its weave"
                    : "draw lines by hand, at uneven distances and with breaks");
}

}  // namespace

std::string DescribeSoftEdge(int pixels) {
  return fmt::format("the edge of the sphere is see-through up to {} pixel{} inside it; these pixels are left out",
                     pixels, pixels == 1 ? "" : "s");
}

std::vector<PaintFault> FindPaintFaults(const PaintTraits& traits, const PaintFaultContext& context) {
  Faults faults(traits, context);
  faults.LookAtSize();
  if (traits.is_sphere) faults.LookAtMarks();
  if (traits.is_sphere && !faults.Misplaced()) faults.LookAtDisc();
  faults.LookAtHoles();
  faults.LookAtAlpha();
  faults.LookAtTone();
  faults.LookAtPattern();
  return faults.Take();
}

}  // namespace scumble
