// scumble styles.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "cli/cache.h"
#include "cli/command.h"
#include "cli/json_text.h"
#include "cli/options.h"
#include "cli/transfer_run.h"
#include "style/style_file.h"
#include "style/style_keys.h"
#include "transfer/ambiguity.h"
#include "transfer/transfer.h"

namespace scumble {
namespace {

// A key that [[exemplar]] has.
struct StyleKeyLine {
  const char *key, *default_value, *help;
};

Expected<ExitCode> ListStyles(const Globals& globals) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  std::string text;
  ExitCode code = ExitCode::kOk;
  for (const auto& root : StyleRoots()) {
    for (const auto& folder : FindStyles(root)) {
      const Expected<Style> style = LoadStyle(folder);
      if (!style) {  // one broken style does not hide the others
        Warn("style " + folder.filename().string() + " is left out: " + style.error().message);
        code = ExitCodeFor(style.error().kind);
        continue;
      }
      const int size = std::max(style->exemplars.front().picture.width, style->exemplars.front().picture.height);
      json.push_back({{"name", folder.filename().string()},
                      {"folder", folder.string()},
                      {"size", size},
                      {"licence", style->licence}});
      text +=
          fmt::format("{:<16} {:>5}²  {:<10} {}\n", folder.filename().string(), size, style->licence, folder.string());
    }
  }
  Print(globals.json ? JsonText(json) : text.empty() ? "no bundled styles found\n" : text);
  return code;
}

Expected<ExitCode> ListKeys(const Globals& globals) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  std::string text;
  for (const StyleKey& key : StyleKeys()) {
    const std::string help = key.help + (key.built_in ? "" : " (not built in yet: only the default is accepted)");
    json.push_back({{"key", key.name}, {"default", key.default_value}, {"help", help}});
    text += fmt::format("{:<26} {:<12} {}\n", key.name, key.default_value, help);
  }
  const StyleKeyLine of_exemplars[] = {
      {"exemplar.image", "", "picture of the painted sphere, required; in style.toml only"},
      {"exemplar.guides", "\"\"", "guides of what is painted; empty: a sphere fills the square; in style.toml only"},
      {"exemplar.luminance", "", "of its light; left out: measured; --set exemplar.1.luminance=0.8 sets the first one's"}};
  for (const auto& [key, default_value, help] : of_exemplars) {
    json.push_back({{"key", key}, {"default", default_value}, {"help", help}});
    text += fmt::format("{:<26} {:<12} {}\n", key, default_value, help);
  }
  Print(globals.json ? JsonText(json) : text);
  return ExitCode::kOk;
}

// Of one painting's usable pixels.
struct PaintReport {
  double hole_percent = 0;   // not opaque
  double range_percent = 0;  // from the darkest to the brightest
  double lightness = 0;      // mean of green, 0 … 1 in sRGB
};

PaintReport LookAtPaint(const PreparedExemplar& exemplar, int index) {
  std::size_t usable = 0, transparent = 0;
  std::uint16_t darkest = 65535, brightest = 0;
  double sum = 0.0;
  for (int y = 0; y < exemplar.height(); ++y) {
    for (int x = 0; x < exemplar.width(); ++x) {
      if (!exemplar.Usable(x, y)) continue;
      const std::uint16_t* texel = exemplar.picture(index).At(x, y);
      ++usable;
      transparent += texel[3] < 65535;
      darkest = std::min(darkest, texel[1]), brightest = std::max(brightest, texel[1]);
      sum += texel[1];
    }
  }
  return {100.0 * static_cast<double>(transparent) / static_cast<double>(usable),
          100.0 * (brightest - darkest) / 65535.0, sum / 65535.0 / static_cast<double>(usable)};
}

void WarnOfPaint(const std::string& name, bool is_sphere, const PaintReport& paint) {
  constexpr double kLeastRange = 25.0;
  if (paint.hole_percent > 0.0) {
    Warn(fmt::format(
        "{}: {:.2f}% of the {} is transparent and will be so in pictures; fill the holes if that is not wanted", name,
        paint.hole_percent, is_sphere ? "sphere" : "painting"));
  }
  if (paint.range_percent < kLeastRange) {
    Warn(fmt::format(
        "{}: light and dark differ by {:.0f}% only, shapes will look flat; paint lights lighter and shades darker",
        name, paint.range_percent));
  }
}

// A painting for more light that is darker than one for less is legal, and most often a slip.
void WarnOfOppositeLight(const Style& style, const PreparedStyle& prepared, const std::vector<PaintReport>& paint) {
  constexpr double kClearly = 0.02;
  const auto luminances = prepared.illumination.luminances();
  for (std::size_t a = 0; a < luminances.size(); ++a) {
    for (std::size_t b = 0; b < luminances.size(); ++b) {
      if (!(luminances[a] > luminances[b] && paint[a].lightness + kClearly < paint[b].lightness)) continue;
      Warn(fmt::format("{} is for more light than {} ({:.4g} and {:.4g}), and its paint is darker: are the luminances "
                       "the wrong way round?",
                       style.exemplars[a].name, style.exemplars[b].name, luminances[a], luminances[b]));
    }
  }
}

void WarnOfAmbiguity(const std::string& name, const AmbiguityReport& report) {
  constexpr double kLeastCovered = 50.0, kMostFlat = 50.0;
  if (report.flat_percent > kMostFlat) {
    Warn(fmt::format(
        "{}: {:.0f}% of the painting shows flat faces: {} of {} directions, the fullest on {} pixels; curved "
        "surfaces will be flat patches; use a rounded shape",
        name, report.flat_percent, report.cells_shown, report.cells, report.most_repeats));
  } else if (report.covered_percent < kLeastCovered) {
    Warn(fmt::format(
        "{}: the painting shows {:.0f}% of the directions that face the viewer; surfaces that face elsewhere "
        "take paint that is up to {:.0f}° off; paint a rounder shape, or a larger picture of it",
        name, report.covered_percent, report.largest_error_degrees));
  }
}

std::string SizeText(const Picture& picture) {
  return picture.width == picture.height ? fmt::format("{}²", picture.width)
                                         : fmt::format("{}×{}", picture.width, picture.height);
}

// Of the first exemplar, as the rest of the report.
nlohmann::ordered_json SpaceToJson(const GuideSpace& space, const SpaceAmbiguity& report) {
  nlohmann::ordered_json json{{"dimensions", space.dimensions()},
                              {"covered_percent", report.covered_percent},
                              {"mean_error", report.mean_error},
                              {"cells_shown", report.cells_shown},
                              {"mean_repeats", report.mean_repeats},
                              {"most_repeats", report.most_repeats}};
  for (const Layer layer : space.layers()) {
    const auto range = space.RangeOf(0, layer);
    json["range"][Info(layer).name] = {range.least, range.largest};
  }
  return json;
}

std::string SpaceToText(const GuideSpace& space, const SpaceAmbiguity& report) {
  std::string text = fmt::format(
      "guides: {} dimensions; {:.1f}% of directions in all light covered within the threshold, {:.3f} off on average; "
      "{} places, each on {:.1f} pixels, {} at most\n",
      space.dimensions(), report.covered_percent, report.mean_error, report.cells_shown, report.mean_repeats,
      report.most_repeats);
  for (const Layer layer : space.layers()) {
    const auto range = space.RangeOf(0, layer);
    text += fmt::format("  {} shows {:.2f} to {:.2f} of 0 to 1\n", Info(layer).name, range.least, range.largest);
  }
  return text;
}

// Loads and prepares the style as a transfer would, and looks for what a painter overlooks.
Expected<ExitCode> CheckStyle(const std::string& path, const Globals& globals) {
  SCUMBLE_ASSIGN(const Style style, OpenStyle({path, {}, {}}));
  FileCache cache = UserCache();
  PrepareOptions options;
  options.cache = &cache;
  options.threads = globals.threads;
  SCUMBLE_ASSIGN(const PreparedStyle prepared, Prepare(style, 1080, options));
  const PreparedExemplar& exemplar = *prepared.exemplar;
  std::vector<PaintReport> paints;
  for (int k = 0; k < exemplar.count(); ++k) {
    paints.push_back(LookAtPaint(exemplar, k));
    WarnOfPaint(k == 0 ? path : style.exemplars[std::size_t(k)].name, exemplar.is_sphere(), paints.back());
  }
  const PaintReport& paint = paints.front();
  WarnOfEqualLight(style, prepared);
  WarnOfOppositeLight(style, prepared, paints);
  const AmbiguityReport report = MeasureAmbiguity(exemplar);
  WarnOfAmbiguity(path, report);
  std::optional<SpaceAmbiguity> space;
  if (prepared.space) {
    const GuideTest test(style.transfer.threshold, style.transfer.threshold_metric);
    space = MeasureAmbiguity(*prepared.space, exemplar, 0, test);
  }
  const Picture& picture = style.exemplars.front().picture;
  if (globals.json) {
    nlohmann::ordered_json json{{"name", style.name},
                                {"size", std::max(picture.width, picture.height)},
                                {"width", picture.width},
                                {"height", picture.height},
                                {"shape", exemplar.is_sphere() ? "sphere" : "scene"},
                                {"transparent_percent", paint.hole_percent},
                                {"range_percent", paint.range_percent}};
    if (exemplar.count() > 1) json["luminances"] = prepared.illumination.luminances();
    for (const Exemplar& one : style.exemplars) {
      nlohmann::ordered_json entry{{"image", one.name}};
      if (exemplar.count() > 1) entry["light"] = LightInWords(one, style.transfer.rim);
      json["exemplars"].push_back(std::move(entry));
    }
    json["directions"] = {{"covered_percent", report.covered_percent},
                          {"covered_within_degrees", kCoveredDegrees},
                          {"mean_error_degrees", report.mean_error_degrees},
                          {"largest_error_degrees", report.largest_error_degrees},
                          {"shown", report.cells_shown},
                          {"of", report.cells},
                          {"mean_repeats", report.mean_repeats},
                          {"most_repeats", report.most_repeats},
                          {"flat_percent", report.flat_percent}};
    if (space) json["guides"] = SpaceToJson(*prepared.space, *space);
    Print(JsonText(json));
  } else {
    Print(fmt::format("{}: {} pixels, tonal range {:.0f}%, transparent {:.2f}%: usable\n", style.name,
                      SizeText(picture), paint.range_percent, paint.hole_percent));
    if (exemplar.count() > 1) {
      for (const Exemplar& one : style.exemplars) {
        Print(fmt::format("{}: {}\n", one.name, LightInWords(one, style.transfer.rim)));
      }
    }
    Print(fmt::format("directions: {:.1f}% covered within {:.0f}°; error {:.2f}° on average, {:.1f}° at most\n",
                      report.covered_percent, kCoveredDegrees, report.mean_error_degrees,
                      report.largest_error_degrees));
    Print(
        fmt::format("repeats: {} of {} directions shown, each by {:.1f} pixels on average, {} at most; {:.0f}% flat\n",
                    report.cells_shown, report.cells, report.mean_repeats, report.most_repeats, report.flat_percent));
    if (space) Print(SpaceToText(*prepared.space, *space));
  }
  return ExitCode::kOk;
}

}  // namespace

void AddStylesVerb(CLI::App& app, Globals& globals, Action& chosen) {
  CLI::App* sub = app.add_subcommand("styles", "list the bundled styles; check one; list the keys of style.toml");
  auto keys = std::make_shared<bool>(false);
  auto checked = std::make_shared<std::string>();
  sub->add_flag("--keys", *keys, "list every key of style.toml with its default");
  CLI::App* check = sub->add_subcommand("check", "read a style as a transfer would and say what is wrong with it");
  check
      ->add_option("style", *checked,
                   "style folder, style.toml, picture of a painted sphere, or a bundled style's name")
      ->type_name("STYLE")
      ->required();
  AddGlobalOptions(*sub, globals);
  AddGlobalOptions(*check, globals);
  sub->callback([=, &globals, &chosen] {
    chosen = [=, &globals]() -> Expected<ExitCode> {
      if (!checked->empty()) return CheckStyle(*checked, globals);
      return *keys ? ListKeys(globals) : ListStyles(globals);
    };
  });
}

}  // namespace scumble
