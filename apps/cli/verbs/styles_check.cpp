#include "apps/cli/verbs/styles_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "apps/cli/app/json_text.h"
#include "apps/cli/app/options.h"
#include "apps/cli/verbs/paint_report.h"
#include "core/style/kit/sphere_kit.h"
#include "core/style/place_sphere.h"
#include "measure/painting/paint_faults.h"
#include "measure/painting/paint_traits.h"
#include "pipeline/file_cache.h"
#include "pipeline/frame/paint_picture.h"
#include "pipeline/style/kit_template.h"
#include "pipeline/style/style_locations.h"
#include "transfer/exemplar/ambiguity.h"
#include "transfer/transfer.h"

namespace scumble {
namespace {

using Weight = PaintFault::Weight;

std::vector<PaintFault> AmbiguityFaults(const AmbiguityReport& report) {
  // A floor and a wall are flat too, and do no harm beside rounder objects.
  constexpr double kLeastCovered = 50.0, kMostFlat = 50.0, kRound = 80.0;
  if (report.flat_percent > kMostFlat && report.covered_percent < kRound) {
    return {
        {"flat-faces", Weight::kMistake,
         fmt::format("{:.0f}% of the painting shows flat faces: {} of {} directions, the fullest on {} pixels; curved "
                     "surfaces will be flat patches",
                     report.flat_percent, report.cells_shown, report.cells, report.most_repeats),
         "use a rounded shape", std::nullopt}};
  }
  if (report.covered_percent < kLeastCovered) {
    return {
        {"few-directions", Weight::kMistake,
         fmt::format("the painting shows {:.0f}% of the directions that face the viewer; surfaces that face elsewhere "
                     "take paint that is up to {:.0f}° off",
                     report.covered_percent, report.largest_error_degrees),
         "paint a rounder shape, or a larger picture of it", std::nullopt}};
  }
  return {};
}

// Of a sphere that does not fill its file.
std::vector<PaintFault> PlaceFaults(const Exemplar& exemplar) {
  if (!exemplar.cut) return {};
  return {
      {"taken-as-it-lies", Weight::kRemark, DescribeCut(*exemplar.cut),
       "if that is not where it is, crop it to the sphere; if the sphere fills the square, write fills = true under "
       "its [[exemplar]]",
       std::nullopt}};
}

// An exemplar for more light that is darker than one for less is legal, and most often a mistake.
std::vector<PaintFault> OppositeLights(const Style& style, std::span<const float> luminances,
                                       const std::vector<PaintTraits>& traits, std::size_t a) {
  constexpr double kClearly = 2.0;  // L*
  std::vector<PaintFault> faults;
  for (std::size_t b = 0; b < luminances.size(); ++b) {
    const ToneReport &more = traits[a].tone, &less = traits[b].tone;
    // Strong light makes deep shades too, so the lightest paint must be darker as well.
    const bool darker = more.mean + kClearly < less.mean && more.brightest < less.brightest;
    if (!(luminances[a] > luminances[b] && darker)) continue;
    faults.push_back({"opposite-light", Weight::kMistake,
                      fmt::format("it is for more light than {} ({:.4g} and {:.4g}), and its paint is darker",
                                  style.exemplars[b].name, luminances[a], luminances[b]),
                      "see whether the luminances in style.toml are the wrong way round", std::nullopt});
  }
  return faults;
}

std::string SizeText(const Picture& picture) {
  return picture.width == picture.height ? fmt::format("{}²", picture.width)
                                         : fmt::format("{}×{}", picture.width, picture.height);
}

// Of the first exemplar, like the other parts of the report.
nlohmann::ordered_json SpaceToJson(const GuideSpace& space, const SpaceAmbiguity& report) {
  nlohmann::ordered_json json{{"dimensions", space.dimensions()},    {"covered_percent", report.covered_percent},
                              {"mean_error", report.mean_error},     {"cells_shown", report.cells_shown},
                              {"mean_repeats", report.mean_repeats}, {"most_repeats", report.most_repeats}};
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

struct FoundFault {
  std::string image;
  PaintFault fault;
};

struct CheckedStyle {
  Style style;
  PreparedStyle prepared;
  std::vector<PaintTraits> traits;  // by exemplar
  AmbiguityReport directions;
  std::optional<SpaceAmbiguity> space;
  std::vector<FoundFault> faults;

  std::size_t Count(Weight weight) const {
    return static_cast<std::size_t>(std::count_if(
        faults.begin(), faults.end(), [&](const FoundFault& found) { return found.fault.weight == weight; }));
  }
};

void FindFaults(CheckedStyle& checked) {
  const Style& style = checked.style;
  const auto luminances = checked.prepared.illumination.luminances();
  PaintFaultContext context;
  context.several = style.exemplars.size() > 1;
  context.has_paper = style.paper.color || style.paper.picture;
  double darkest = 100.0, brightest = 0.0, most_light = 0.0;
  for (std::size_t k = 0; k < checked.traits.size(); ++k) {
    const PaintTraits& traits = checked.traits[k];
    context.largest_size = std::max({context.largest_size, traits.width, traits.height});
    darkest = std::min(darkest, traits.tone.darkest), brightest = std::max(brightest, traits.tone.brightest);
    if (context.several) most_light = std::max(most_light, double(luminances[k]));
  }
  context.tonal_range = brightest - darkest;
  for (std::size_t k = 0; k < checked.traits.size(); ++k) {
    const Exemplar& exemplar = style.exemplars[k];
    context.brightest = !context.several || luminances[k] == most_light;
    context.knows_guides = !exemplar.guides_file.empty();
    context.shows_marks = exemplar.is_sphere && LooksLikeTemplate(exemplar.picture);
    context.origin = exemplar.Origin();
    std::vector<PaintFault> faults = FindPaintFaults(checked.traits[k], context);
    for (PaintFault& fault : PlaceFaults(exemplar)) faults.push_back(std::move(fault));
    if (context.several) {
      for (PaintFault& fault : OppositeLights(style, luminances, checked.traits, k)) faults.push_back(std::move(fault));
    }
    for (PaintFault& fault : faults) checked.faults.push_back({exemplar.name, std::move(fault)});
  }
  for (EqualLight& equal : EqualLights(style, checked.prepared)) {
    checked.faults.push_back(
        {equal.image, {"equal-light", Weight::kMistake, "it " + equal.what, equal.fix, std::nullopt}});
  }
  for (PaintFault& fault : AmbiguityFaults(checked.directions))
    checked.faults.push_back({style.exemplars.front().name, std::move(fault)});
}

// Loads and prepares the style as a transfer would, and finds the mistakes that painters overlook.
Expected<CheckedStyle> Check(const std::string& path, const Globals& globals) {
  CheckedStyle checked;
  SCUMBLE_ASSIGN(checked.style, OpenStyle({path, {}, {}}, globals));
  FileCache cache(globals.cache_folder);
  PrepareOptions options;
  options.cache = &cache;
  options.threads = globals.threads;
  SCUMBLE_ASSIGN(checked.prepared, Prepare(checked.style, 1080, options));
  const PreparedStyle& prepared = checked.prepared;
  for (const Exemplar& exemplar : checked.style.exemplars) {
    SCUMBLE_ASSIGN(const std::optional<BareTemplates> bare, FindBareTemplates(exemplar, globals.threads));
    checked.traits.push_back(MeasurePaint(exemplar, checked.style.transfer.rim, bare ? &bare->drawn : nullptr,
                                          bare ? &bare->printed : nullptr));
  }
  checked.directions = MeasureAmbiguity(*prepared.exemplar);
  if (prepared.space) {
    const GuideTest test(checked.style.transfer.threshold, checked.style.transfer.threshold_metric);
    checked.space = MeasureAmbiguity(*prepared.space, *prepared.exemplar, 0, test);
  }
  FindFaults(checked);
  return checked;
}

nlohmann::ordered_json ToJson(const CheckedStyle& checked) {
  const Style& style = checked.style;
  const PaintTraits& first = checked.traits.front();
  const bool several = style.exemplars.size() > 1;
  nlohmann::ordered_json json{{"name", style.name},
                              {"licence", style.licence},
                              {"size", std::max(first.width, first.height)},
                              {"width", first.width},
                              {"height", first.height},
                              {"shape", first.is_sphere ? "sphere" : "scene"},
                              {"transparent_percent", first.alpha.transparent_percent},
                              {"range_percent", first.tone.range()}};
  if (several) json["luminances"] = checked.prepared.illumination.luminances();
  for (std::size_t k = 0; k < style.exemplars.size(); ++k) {
    const Exemplar& exemplar = style.exemplars[k];
    nlohmann::ordered_json entry{{"image", exemplar.name}};
    if (several) entry["light"] = DescribeLuminance(exemplar, style.transfer.rim);
    entry.update(TraitsToJson(checked.traits[k], exemplar));
    json["exemplars"].push_back(std::move(entry));
  }
  const AmbiguityReport& report = checked.directions;
  json["directions"] = {{"covered_percent", report.covered_percent},
                        {"covered_within_degrees", kCoveredDegrees},
                        {"mean_error_degrees", report.mean_error_degrees},
                        {"largest_error_degrees", report.largest_error_degrees},
                        {"shown", report.cells_shown},
                        {"of", report.cells},
                        {"mean_repeats", report.mean_repeats},
                        {"most_repeats", report.most_repeats},
                        {"flat_percent", report.flat_percent}};
  if (checked.space) json["guides"] = SpaceToJson(*checked.prepared.space, *checked.space);
  json["faults"] = nlohmann::ordered_json::array();
  for (const auto& [image, fault] : checked.faults) json["faults"].push_back(FaultToJson(image, fault));
  return json;
}

std::string VerdictOf(const CheckedStyle& checked) {
  const std::size_t mistakes = checked.Count(Weight::kMistake), remarks = checked.Count(Weight::kRemark);
  std::string verdict =
      mistakes == 0 ? "usable" : fmt::format("usable, with {} mistake{}", mistakes, mistakes == 1 ? "" : "s");
  if (remarks > 0) verdict += fmt::format(", {} remark{}", remarks, remarks == 1 ? "" : "s");
  return verdict;
}

std::string ToText(const CheckedStyle& checked) {
  const Style& style = checked.style;
  const PaintTraits& first = checked.traits.front();
  const AmbiguityReport& report = checked.directions;
  std::string text = fmt::format("{}: {} pixels, tonal range {:.0f}%, transparent {:.2f}%: {}\n", style.name,
                                 SizeText(style.exemplars.front().picture), first.tone.range(),
                                 first.alpha.transparent_percent, VerdictOf(checked));
  for (std::size_t k = 0; k < style.exemplars.size(); ++k) {
    const Exemplar& one = style.exemplars[k];
    text += style.exemplars.size() > 1 ? fmt::format("{}: {}\n", one.name, DescribeLuminance(one, style.transfer.rim))
                                       : one.name + "\n";
    text += TraitsToText(checked.traits[k]);
  }
  text += fmt::format("directions: {:.1f}% covered within {:.0f}°; error {:.2f}° on average, {:.1f}° at most\n",
                      report.covered_percent, kCoveredDegrees, report.mean_error_degrees, report.largest_error_degrees);
  text +=
      fmt::format("repeats: {} of {} directions shown, each by {:.1f} pixels on average, {} at most; {:.0f}% flat\n",
                  report.cells_shown, report.cells, report.mean_repeats, report.most_repeats, report.flat_percent);
  if (checked.space) text += SpaceToText(*checked.prepared.space, *checked.space);
  for (const auto& [image, fault] : checked.faults) {
    if (fault.weight == Weight::kRemark) text += "remark: " + FaultToText(image, fault) + "\n";
  }
  return text;
}

}  // namespace

Expected<ExitCode> CheckStyles(const StylesCheck& check, const Globals& globals) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  std::size_t mistakes = 0, at_fault = 0, unreadable = 0;
  ExitCode code = ExitCode::kOk;
  for (const std::string& path : check.styles) {
    const Expected<CheckedStyle> checked = Check(path, globals);
    if (!checked && check.styles.size() == 1) return checked.error();
    if (!checked) {
      globals.Warn(fmt::format("{} cannot be used: {}", path, checked.error().message));
      json.push_back({{"path", path}, {"error", checked.error().message}});
      code = ExitCodeFor(checked.error().kind);
      ++unreadable;
      continue;
    }
    for (const auto& [image, fault] : checked->faults) {
      if (fault.weight == Weight::kMistake) globals.Warn(FaultToText(image, fault));
    }
    const std::size_t count = checked->Count(Weight::kMistake);
    mistakes += count, at_fault += count > 0;
    json.push_back(ToJson(*checked));
    if (!globals.json) Print(ToText(*checked));
  }
  if (globals.json) {
    Print(JsonText(check.styles.size() == 1 ? json.front() : json));
  } else if (check.styles.size() > 1) {
    Print(fmt::format("{} styles: {} without a mistake, {} with {} mistakes, {} cannot be used\n", check.styles.size(),
                      check.styles.size() - at_fault - unreadable, at_fault, mistakes, unreadable));
  }
  if (code == ExitCode::kOk && check.strict && mistakes > 0) return ExitCode::kDiffers;
  return code;
}

}  // namespace scumble
