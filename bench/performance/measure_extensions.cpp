#include <memory>
#include <set>

#include "bench/performance/performance.h"
#include "transfer/style_map.h"

namespace scumble::bench {
namespace {

// An extension timed against the plain style, and its target.
struct Extension {
  std::string item;
  std::string what;
  std::unique_ptr<Engine> engine;
  std::optional<double> target;
  std::size_t against = 0;  // the index of the reference; 0 is the plain style
};

Extension Extended(const std::string& item, const std::string& what, const Style& style, const Frame& frame,
                   std::optional<double> target, std::size_t against = 0) {
  return {item, what, std::make_unique<Engine>(style, frame.guides.height()), target, against};
}

// The first is the plain style, which is timed as the reference.
void MeasureCosts(const Frame& frame, const std::vector<Extension>& extensions, const PerformanceOptions& options,
                  Report& report) {
  std::vector<std::function<void()>> contestants;
  for (const Extension& extension : extensions) contestants.push_back(Painting(*extension.engine, frame));
  const std::vector<Times> times = TakeTurns(contestants, options.repeats);
  for (std::size_t e = 1; e < extensions.size(); ++e) {
    const Extension& extension = extensions[e];
    const Spread ns = times[e].Milliseconds(Clock::kThread);
    report.Add({extension.item,
                extension.what,
                frame.name,
                "×",
                Ratio(times[e], times[extension.against], Clock::kThread),
                extension.target,
                false,
                {},
                {{"ns", ns.median * 1e6 / static_cast<double>(frame.covered)}}});
  }
}

Style With(const std::function<void(Style&)>& change) {
  Style style = PlainStyle();
  change(style);
  return style;
}

// One exemplar four times, for four lights: measures the cost of illumination, not of other paint.
Style Illuminated() {
  return With([](Style& style) {
    const Exemplar exemplar = style.exemplars.front();
    style.exemplars.clear();
    for (const double luminance : {0.8, 0.45, 0.2, 0.05}) {
      style.exemplars.push_back(exemplar);
      style.exemplars.back().luminance = luminance;
    }
  });
}

// Objects take the styles in turn.
StyleMap ByObject(const GuideSet& guides, std::size_t styles) {
  std::set<std::uint32_t> objects;
  for (const float id : guides.Plane(Layer::kObject)) objects.insert(static_cast<std::uint32_t>(id));
  StyleAssignment assignment;
  std::size_t next = 0;
  for (const std::uint32_t id : objects) {
    if (id != 0) assignment.of_object[id] = static_cast<std::uint16_t>(next++ % styles);
  }
  return MapStyles(guides, assignment);
}

// Slanted stripes of 96 pixels: every style is all over the picture.
StyleMap Striped(const GuideSet& guides, std::size_t styles) {
  StyleMap map;
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x < guides.width(); ++x)
      map.style.push_back(static_cast<std::uint16_t>((x + y) / 96 % int(styles)));
  }
  return map;
}

void MeasureTenStyles(const Frame& frame, const std::string& what, StyleMap (*map)(const GuideSet&, std::size_t),
                      const PerformanceOptions& options, Report& report) {
  const std::vector<Style> styles = TenStyles();
  std::vector<StyleMap> maps{map(frame.guides, styles.size()), map(frame.mirrored, styles.size())};
  std::vector<Extension> extensions;
  extensions.push_back(Extended("4", "plain", PlainStyle(), frame, {}));
  extensions.push_back({"4", what, std::make_unique<Engine>(styles, frame.guides.height(), std::move(maps)), 1.3});
  MeasureCosts(frame, extensions, options, report);
}

}  // namespace

void MeasureRadius(const PerformanceOptions& options, Report& report) {
  const auto [width, height] = options.sizes.front();
  const auto of_radius = [](int radius, bool edge_aware) {
    return With([=](Style& style) { style.transfer.blend_radius = radius, style.transfer.edge_aware = edge_aware; });
  };
  for (const Frame& frame : {WithMirrorImage(HillsFrame(width, height, true)), CloseUp(width, height),
                             SceneFrame("suzanne", width, height), SceneFrame("stilllife", width, height)}) {
    report.Say("radius 8: " + frame.name);
    std::vector<Extension> extensions;
    extensions.push_back(Extended("3", "plain", of_radius(1, false), frame, {}));
    extensions.push_back(Extended("3", "radius 8 against 1", of_radius(8, false), frame, 2.0));
    extensions.push_back(Extended("4", "edge-aware against plain", of_radius(1, true), frame, 1.2));
    extensions.push_back(Extended("3", "radius 8 against 1, edge-aware", of_radius(8, true), frame, 2.5, 2));
    MeasureCosts(frame, extensions, options, report);
  }
}

void MeasureExtensions(const PerformanceOptions& options, Report& report) {
  const auto [width, height] = options.sizes.front();
  const LayerSet layers{Layer::kLuminance, Layer::kAlbedo};
  for (const Frame& frame : {CloseUp(width, height, layers), SceneFrame("stilllife", width, height, layers)}) {
    report.Say("extensions: " + frame.name);
    std::vector<Extension> all;
    all.push_back(Extended("4", "plain", PlainStyle(), frame, {}));
    all.push_back(Extended("4", "four exemplars, illuminated, against plain", Illuminated(), frame, 1.5));
    const PreparedStyle& lit = all.back().engine->prepared();
    all.back().engine->options.exposure = MeasureExposure({&lit, 1}, frame.guides).value_or(0.0);
    const auto tinted = [](ColorizeMode mode) {
      return With([=](Style& style) { style.transfer.colorize = 1.0, style.transfer.colorize_mode = mode; });
    };
    all.push_back(Extended("4", "colorized by multiplying against plain", tinted(ColorizeMode::kMultiply), frame, 1.1));
    all.push_back(Extended("4", "colorized in Oklab against plain", tinted(ColorizeMode::kOklab), frame, 1.25));
    if (frame.name.starts_with("stilllife")) {
      const Style edges = With([](Style& style) { style.transfer.edge_aware = true; });
      all.push_back(Extended("4", "edge-aware against plain", edges, frame, 1.2));
    }
    const Style table = With([](Style& style) { style.transfer.nearest = NearestSearch::kTable; });
    all.push_back(Extended("4", "look-up table against the formula", table, frame, 1.2));
    const Style varied = With([](Style& style) { style.transfer.variety = 15.0; });
    all.push_back(Extended("4", "variety of 15° against plain", varied, frame, {}));
    MeasureCosts(frame, all, options, report);
  }
  report.Say("ten styles");
  MeasureTenStyles(SceneFrame("stilllife", width, height), "ten styles by object against one", ByObject, options,
                   report);
  MeasureTenStyles(CloseUp(width, height), "ten styles in stripes against one", Striped, options, report);
}

}  // namespace scumble::bench
