#include "apps/cli/verbs/styles_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "apps/cli/app/json_text.h"
#include "apps/cli/app/options.h"
#include "apps/cli/verbs/paint_report.h"
#include "measure/paint_faults.h"
#include "pipeline/check_style.h"
#include "pipeline/prepare_frame.h"

namespace scumble {
namespace {

using Weight = PaintFault::Weight;

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

nlohmann::ordered_json ToJson(const CheckedStyle& checked) {
  const Style& style = checked.style;
  if (!style.unpainted.empty()) {
    return {{"name", style.name},
            {"licence", style.licence},
            {"method", style.unpainted},
            {"exemplars", nlohmann::ordered_json::array()},
            {"faults", nlohmann::ordered_json::array()}};
  }
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
  if (!style.unpainted.empty()) {
    return fmt::format("{}: no painting, method {}: usable\n", style.name, style.unpainted);
  }
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
    const Expected<CheckedStyle> checked = CheckStyle({path, {}, {}}, globals);
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
