// The cross-check for terminals and for machines.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "measure/crosscheck.h"
#include "measure/crosscheck/parts.h"
#include "measure/json_number.h"

namespace scumble {
namespace {

using Json = nlohmann::ordered_json;

std::string SetupText(const CrosscheckSetup& setup) {
  std::string text = fmt::format("{}×{}", setup.width, setup.height);
  if (!setup.camera.empty()) text += ", camera " + setup.camera;
  if (setup.frame) text += fmt::format(", frame {}", *setup.frame);
  if (!setup.blender_scene.empty()) text += ", scene " + setup.blender_scene;
  if (!setup.view_layer.empty()) text += ", view layer " + setup.view_layer;
  if (setup.samples > 0) {
    text += fmt::format(", {}, {}", internal::Counted(setup.samples, "sample"),
                        internal::Counted(setup.max_bounces, "bounce"));
  }
  return text;
}

std::string State(const CrosscheckFigure& figure) {
  if (figure.kept()) return figure.Unjudged() ? "not judged" : "kept";
  return figure.TooNoisy() ? "TOO NOISY" : "BROKEN";
}

std::string FigureLine(const CrosscheckFigure& figure) {
  const std::string error = figure.error > 0.0 ? fmt::format("± {:.2g}", figure.error) : "";
  std::string line = fmt::format("  {:<9} {:<16} {:>9.3g} {:<9} limit {:<8.3g} {:<12} {}", figure.layer, figure.name,
                                 figure.value, error, figure.LimitInForce(), figure.unit, State(figure));
  if (figure.TightenedByBaseline()) line += fmt::format(" (baseline; built in {:.3g})", figure.limit);
  if (!figure.note.empty()) line += ", " + figure.note;
  return line + "\n";
}

std::string NoiseText(const std::vector<CrosscheckNoise>& noise) {
  if (noise.empty()) return "";
  std::string text = "  root mean square difference of the pixels over the mean, by samples\n";
  for (const CrosscheckNoise& layer : noise) {
    text += fmt::format("  {:<9} ", layer.layer);
    if (layer.no_such_light) {
      text += "no such light\n";
      continue;
    }
    for (std::size_t i = 0; i < layer.samples.size(); ++i) {
      text += fmt::format("{:>5}: {:<8.3g}", layer.samples[i], layer.nrmse[i]);
    }
    text += layer.slope ? fmt::format("slope {:+.2f}", *layer.slope) : layer.free_of_noise ? "free of noise" : "";
    text += fmt::format("  most at ({}, {}): {:.4g} against {:.4g}\n", layer.worst_x, layer.worst_y, layer.worst_ours,
                        layer.worst_reference);
  }
  return text;
}

Json FigureJson(const CrosscheckFigure& figure) {
  Json json{{"layer", figure.layer},
            {"name", figure.name},
            {"unit", figure.unit},
            {"value", JsonNumber(figure.value)},
            {"error", JsonNumber(figure.error)},
            {"limit", JsonNumber(figure.LimitInForce())},
            {"built_in_limit", JsonNumber(figure.limit)},
            {"from_baseline", figure.TightenedByBaseline()},
            {"kept", figure.kept()},
            {"judged", !figure.Unjudged()},
            {"too_noisy", figure.TooNoisy()}};
  if (!figure.note.empty()) json["note"] = figure.note;
  return json;
}

Json NoiseJson(const CrosscheckNoise& noise) {
  Json json{{"layer", noise.layer}, {"no_such_light", noise.no_such_light}, {"free_of_noise", noise.free_of_noise}};
  if (noise.no_such_light) return json;
  json["samples"] = noise.samples;
  for (const double value : noise.nrmse) json["nrmse"].push_back(JsonNumber(value));
  json["slope"] = noise.slope ? JsonNumber(*noise.slope) : Json();
  json["worst"] = {{"difference", JsonNumber(noise.worst)},
                   {"x", noise.worst_x},
                   {"y", noise.worst_y},
                   {"reference", JsonNumber(noise.worst_reference)},
                   {"ours", JsonNumber(noise.worst_ours)}};
  return json;
}

Json ReportJson(const CrosscheckReport& report) {
  Json json{{"scene", report.scene},
            {"width", report.setup.width},
            {"height", report.setup.height},
            {"samples", report.setup.samples},
            {"max_bounces", report.setup.max_bounces},
            {"covered", report.covered},
            {"compared", report.compared},
            {"glossy", report.glossy},
            {"verdict", OutcomeName(report.Outcome())},
            {"passed", report.passed()},
            {"scumble", report.scumble_version},
            {"blender", report.blender_version}};
  if (!report.failure.empty()) json["failure"] = report.failure;
  if (!report.baseline_mismatch.empty()) json["baseline_mismatch"] = report.baseline_mismatch;
  if (!report.setup.camera.empty()) json["camera"] = report.setup.camera;
  if (report.setup.frame) json["frame"] = *report.setup.frame;
  if (!report.setup.blender_scene.empty()) json["blender_scene"] = report.setup.blender_scene;
  if (!report.setup.view_layer.empty()) json["view_layer"] = report.setup.view_layer;
  json["too_thin"] = report.too_thin;
  json["skipped"] = report.skipped;
  json["problems"] = report.problems;
  json["reasons"] = WhyCrosscheckFails(report);
  json["unsupported"] = report.unsupported;
  json["warnings"] = report.warnings;
  json["figures"] = Json::array();
  for (const CrosscheckFigure& figure : report.figures) json["figures"].push_back(FigureJson(figure));
  json["noise"] = Json::array();
  for (const CrosscheckNoise& noise : report.noise) json["noise"].push_back(NoiseJson(noise));
  return json;
}

}  // namespace

std::vector<std::string> WhyCrosscheckFails(const CrosscheckReport& report) {
  if (!report.failure.empty()) return {report.failure};
  std::vector<std::string> reasons;
  if (report.compared == 0) {
    reasons.push_back("nothing to compare: no object is wide enough, or the pictures do not agree at all");
  } else if (report.compared < kLeastCompared) {
    reasons.push_back(fmt::format("only {} pixels to compare, at least {} are needed: raise --size", report.compared,
                                  kLeastCompared));
  }
  for (const std::string& layer : report.skipped) reasons.push_back(layer + ": one of the two sides lacks it");
  for (const CrosscheckFigure& figure : report.figures) {
    if (figure.kept()) continue;
    const std::string what = figure.layer + " " + figure.name;
    const std::string limit = fmt::format("the {}limit of {:.3g} {}", figure.TightenedByBaseline() ? "baseline's " : "",
                                          figure.LimitInForce(), figure.unit);
    if (figure.TooNoisy()) {
      reasons.push_back(fmt::format("{}: {:.3g} give or take {:.3g} does not show whether {} is kept: raise --samples",
                                    what, figure.value, 2.0 * figure.error, limit));
    } else {
      reasons.push_back(fmt::format("{}: {:.3g} is above {}", what, figure.value, limit) +
                        (figure.note.empty() ? "" : ", " + figure.note));
    }
  }
  reasons.insert(reasons.end(), report.problems.begin(), report.problems.end());
  return reasons;
}

const char* OutcomeName(CrosscheckOutcome outcome) {
  switch (outcome) {
    case CrosscheckOutcome::kAgrees:
      return "agrees";
    case CrosscheckOutcome::kNotProved:
      return "not proved";
    case CrosscheckOutcome::kDiffers:
      return "differs";
    case CrosscheckOutcome::kNotCompared:
      return "could not be compared";
  }
  return "";
}

std::string CrosscheckVerdict(const CrosscheckReport& report) {
  const CrosscheckOutcome outcome = report.Outcome();
  std::string verdict = OutcomeName(outcome);
  if (outcome == CrosscheckOutcome::kNotCompared) return verdict + ": " + report.failure;
  const auto count = [&report](auto is) { return std::count_if(report.figures.begin(), report.figures.end(), is); };
  const auto noisy = count([](const CrosscheckFigure& figure) { return figure.TooNoisy(); });
  if (outcome == CrosscheckOutcome::kDiffers) verdict = "DIFFERS";
  if (outcome == CrosscheckOutcome::kNotProved) {
    verdict = fmt::format("NOT PROVED, {} too noisy: raise --samples",
                          noisy == 1 ? "1 figure is" : fmt::format("{} figures are", noisy));
  }
  if (!report.unsupported.empty() && count([](const CrosscheckFigure& figure) { return figure.broken(); }) > 0) {
    verdict += fmt::format(
        ", {} not expressed: see the list “not expressed”",
        report.unsupported.size() == 1 ? "1 thing is" : fmt::format("{} things are", report.unsupported.size()));
  }
  if (report.setup.samples == 0) return verdict + ", data layers alone: light was not compared (--samples 0)";
  return report.setup.max_bounces > 0 ? verdict : verdict + ", direct light alone (--max-bounces 0)";
}

std::string CrosscheckToText(const CrosscheckReport& report) {
  if (!report.failure.empty()) return report.scene + "\n  verdict: " + CrosscheckVerdict(report) + "\n";
  std::string text = fmt::format("{}  {}, {} of {} covered pixels compared\n", report.scene, SetupText(report.setup),
                                 report.compared, report.covered);
  for (const CrosscheckFigure& figure : report.figures) text += FigureLine(figure);
  text += NoiseText(report.noise);
  const auto list = [&text](const char* title, const std::vector<std::string>& lines) {
    if (!lines.empty()) text += fmt::format("  {}:\n", title);
    for (const std::string& line : lines) text += "    " + line + "\n";
  };
  if (!report.too_thin.empty()) text += "  too thin to compare at this size: " + report.too_thin + "\n";
  list("not compared as authored", report.warnings);
  list("not expressed", report.unsupported);
  for (const std::string& reason : WhyCrosscheckFails(report)) text += "  ! " + reason + "\n";
  return text + "  verdict: " + CrosscheckVerdict(report) + "\n";
}

std::string CrosscheckToJson(const std::vector<CrosscheckReport>& reports) {
  Json json = Json::array();
  for (const CrosscheckReport& report : reports) json.push_back(ReportJson(report));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace scumble
