#include "apps/cli/app/frame_report.h"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <utility>

#include "apps/cli/app/json_text.h"
#include "apps/cli/app/run_report.h"

namespace scumble {
namespace {

using Json = nlohmann::ordered_json;

std::string StepsToText(const std::vector<StepSpread>& steps, int repeat) {
  std::string text;
  double total = 0;
  for (const StepSpread& step : steps) {
    total += step.median;
    text += fmt::format("{}{} {:.1f}", text.empty() ? "" : ", ", step.name, step.median);
    if (repeat > 1 && step.most > step.least) text += fmt::format(" ({:.1f}–{:.1f})", step.least, step.most);
  }
  return text + fmt::format(", total {:.1f} ms", total);
}

Json StyleToJson(const StyleInReport& style) {
  Json json{{"style", style.given},
            {"name", style.name},
            {"exemplars", style.exemplars},
            {"exemplar_width", style.exemplar_width},
            {"exemplar_height", style.exemplar_height},
            {"levels", style.levels},
            {"blend_radius", style.blend_radius}};
  if (!style.luminances.empty()) json["luminances"] = style.luminances;
  return json;
}

// Facts about a style outside "styles" are the default style's; a picture that is only finished has none.
void PictureToJson(const PictureReport& picture, const std::vector<PlanItem>& plan, Json& json) {
  json["output"] = picture.output;
  if (!picture.layers_output.empty()) {
    json["layers_output"] = picture.layers_output;
    json["layers"] = picture.layers;
  }
  if (!picture.styles.empty()) json["style"] = picture.styles.front().name;
  json["width"] = picture.width;
  json["height"] = picture.height;
  json["upsample"] = picture.upsample;
  json["upscale"] = picture.upscale;
  if (!picture.styles.empty()) {
    const StyleInReport& first = picture.styles.front();
    json["exemplar_size"] = first.exemplar_size;
    json["exemplar_width"] = first.exemplar_width;
    json["exemplar_height"] = first.exemplar_height;
    json["levels"] = first.levels;
    json["blend_radius"] = first.blend_radius;
  }
  for (const StyleInReport& style : picture.styles) json["styles"].push_back(StyleToJson(style));
  if (picture.chunks) {
    json["covered_pixels"] = picture.chunks->covered_pixels;
    json["coherence"] = picture.chunks->coherence;
    json["chunks"] = picture.chunks->chunks;
    json["mean_chunk_area"] = picture.chunks->mean_chunk_area;
  }
  json["seed"] = picture.seed;
  if (picture.exposure) json["exposure"] = *picture.exposure;
  json["version"] = SCUMBLE_VERSION;
  json["repeat"] = picture.repeat;
  if (!plan.empty()) json["plan"] = PlanToJson(plan);
  for (const StepSpread& step : picture.steps) {
    json["ms"][step.name] = {{"median", step.median}, {"min", step.least}, {"max", step.most}};
  }
}

void GuidesToJson(const GuidesReport& guides, const FrameReport& report, Json& json) {
  if (!guides.output.empty()) {
    json["output"] = guides.output;
    json["width"] = guides.width;
    json["height"] = guides.height;
    json["layers"] = guides.layers.ToString();
    if (report.cost) CostToJson(*report.cost, json);
    if (guides.samples > 0 || guides.open_ended) json["samples"] = guides.samples;
    if (guides.noise > 0.0) json["noise"] = guides.noise;
  }
  if (!report.plan.empty()) json["plan"] = PlanToJson(report.plan);
  json["memory"] = MemoryToJson(report.memory);
  for (const auto& [name, ms] : guides.times) json["ms"][name] = ms;
}

std::string GuidesToText(const GuidesReport& guides) {
  std::string steps, samples;
  for (const auto& [name, ms] : guides.times) steps += fmt::format("{}{} {:.1f}", steps.empty() ? "" : ", ", name, ms);
  if (guides.noise > 0.0) samples = fmt::format("; noise {:.3g}", guides.noise);
  if (guides.open_ended) {
    samples +=
        guides.samples > 0 ? fmt::format("; repeat with --samples {}", guides.samples) : "; free of noise, no samples";
  }
  return fmt::format("{}  {}; {} ms{}\n", guides.output, guides.layers.ToString(), steps, samples);
}

Json ChoiceToJson(const BudgetChoice& choice) {
  Json options = Json::array();
  for (const std::string& word : choice.options) options.push_back(word);
  if (choice.quality) return {{"quality", {{"name", *choice.quality}, {"options", options}}}};
  Json json{{"ms", choice.budget_ms},
            {"picked", choice.picked},
            {"predicted_ms", choice.predicted_ms},
            {"fits", choice.fits},
            {"measured_runs", choice.measured_runs},
            {"options", options}};
  return {{"budget", json}};
}

// Facts of a whole run.
void AddRun(const RunReport& report, const Globals& globals, Json& json) {
  json["warnings"] = report.warnings;
  if (report.choice) json.update(ChoiceToJson(*report.choice));
  if (globals.clock) json["timing"] = ClockToJson(*globals.clock);
}

void PrintTotals(const SequenceTotals& totals, const RunReport& report, const Globals& globals, Json entries) {
  if (globals.json) {
    Json json{{"frames", std::move(entries)}, {"made", totals.made},
              {"kept", totals.kept},          {"failed", totals.failed.size()},
              {"total_ms", totals.total_ms},  {"memory", {{"peak_bytes", PeakMemory()}}}};
    AddRun(report, globals, json);
    Print(JsonText(json));
    return;
  }
  if (totals.ended_by && totals.made + totals.kept == 0) return;  // the error says it all
  const std::size_t all = totals.frames();
  std::string text = fmt::format("{} frame{}: {} made", all, all == 1 ? "" : "s", totals.made);
  if (totals.resumed) text += fmt::format(", {} kept", totals.kept);
  if (!totals.failed.empty()) text += fmt::format(", {} not made", totals.failed.size());
  Print(text + fmt::format("; {:.1f} s\n", totals.total_ms / 1000.0));
  if (globals.clock) Print(ClockToText(*globals.clock));
}

}  // namespace

std::string FrameToText(const FrameReport& report) {
  std::string text;
  const auto* const guides = std::get_if<GuidesReport>(&report.made);
  if (!report.plan.empty() && (!guides || guides->explain)) {
    text = PlanToText(report.plan) + MemoryToText(report.memory);
    if (report.cost) text += CostToText(*report.cost);
  }
  if (const auto* const picture = std::get_if<PictureReport>(&report.made)) {
    text += fmt::format("{}  {}\n", picture->output, StepsToText(picture->steps, picture->repeat));
    if (picture->layers_output.empty()) return text;
    return text + fmt::format("{}  {}\n", picture->layers_output, fmt::join(picture->layers, ", "));
  }
  return text + GuidesToText(std::get<GuidesReport>(report.made));
}

nlohmann::ordered_json FrameToJson(const FrameReport& report) {
  Json json;
  if (const auto* const picture = std::get_if<PictureReport>(&report.made)) {
    PictureToJson(*picture, report.plan, json);
    if (report.cost) CostToJson(*report.cost, json);
  } else {
    GuidesToJson(std::get<GuidesReport>(report.made), report, json);
  }
  if (std::holds_alternative<PictureReport>(report.made)) json["memory"] = MemoryToJson(report.memory);
  json["work"]["bytes_written"] = report.bytes_written;
  return json;
}

SequencePrinter::SequencePrinter(const Globals& globals)
    : globals_(globals), entries_(std::make_unique<Json>(Json::array())) {}
SequencePrinter::~SequencePrinter() = default;

SequenceListener SequencePrinter::Listener() {
  const auto entry = [](int frame, const char* state, const std::string& output) {
    return Json{{"frame", frame}, {"state", state}, {"output", output}};
  };
  const auto tell = [this](const std::string& text) {
    Print(text);
    std::fflush(stdout);  // a farm's log shows the progress; a failed write is found at the end of the program
  };
  SequenceListener listener;
  listener.made = [=, this](int frame, const std::string& output, const FrameReport& report) {
    if (!globals_.json) return tell(FrameToText(report));
    Json json = entry(frame, "made", output);
    json.update(FrameToJson(report));
    entries_->push_back(std::move(json));
  };
  listener.kept = [=, this](int frame, const std::string& output) {
    if (!globals_.json) return tell(output + "  kept\n");
    entries_->push_back(entry(frame, "kept", output));
  };
  listener.failed = [=, this](int frame, const std::string& output, const std::string& reason) {
    if (!globals_.json) return;
    Json json = entry(frame, "failed", output);
    json["error"] = reason;
    entries_->push_back(std::move(json));
  };
  return listener;
}

Expected<ExitCode> PrintRun(const RunReport& report, const Globals& globals, SequencePrinter& printer) {
  if (report.sequence) {
    PrintTotals(*report.sequence, report, globals, std::move(*printer.entries_));
    SCUMBLE_RETURN_IF_ERROR(StatusOf(*report.sequence));
    return ExitCode::kOk;
  }
  if (!report.frame) {
    Json json{{"plan", PlanToJson(report.plan)}, {"memory", MemoryToJson(report.memory)}};
    for (const auto& [name, ms] : report.plan_times) json["ms"][name] = ms;
    json["warnings"] = report.warnings;
    const bool timed = report.plan_is_timed && globals.clock;
    if (timed) json["timing"] = ClockToJson(*globals.clock);
    Print(globals.json
              ? JsonText(json)
              : PlanToText(report.plan) + MemoryToText(report.memory) + (timed ? ClockToText(*globals.clock) : ""));
    return ExitCode::kOk;
  }
  if (!globals.json) {
    Print(FrameToText(*report.frame) + (globals.clock ? ClockToText(*globals.clock) : ""));
    return ExitCode::kOk;
  }
  Json json = FrameToJson(*report.frame);
  json["memory"]["peak_bytes"] = PeakMemory();
  AddRun(report, globals, json);
  Print(JsonText(json));
  return ExitCode::kOk;
}

}  // namespace scumble
