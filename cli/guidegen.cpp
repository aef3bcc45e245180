// scumble guidegen.
#include "guidegen/guidegen.h"

#include <fmt/format.h>

#include <memory>
#include <optional>

#include "cli/command.h"
#include "cli/json_text.h"
#include "cli/options.h"
#include "cli/progress_bar.h"
#include "io/atomic_file.h"
#include "io/guide_file.h"

namespace scumble {
namespace {

struct GuidegenVerb {
  SceneOptions scene;
  StyleOptions style;
  std::string layers;
  std::string compression = "zip";
  std::string output;
};

// Whether the noise or the clock says how many samples are taken.
bool IsOpenEnded(const SceneOptions& scene) { return scene.noise > 0.0 || scene.time_budget_seconds > 0.0; }

void PrintResult(const GuidegenVerb& verb, const SceneGuides& made, const Globals& globals) {
  if (globals.json) {
    nlohmann::ordered_json json;
    if (!verb.output.empty()) {
      json["output"] = verb.output;
      json["width"] = made.guides.width();
      json["height"] = made.guides.height();
      json["layers"] = made.guides.layers().ToString();
      json["rays"] = {{"primary", made.rays.primary},
                      {"coverage", made.rays.coverage},
                      {"shadow", made.rays.shadow},
                      {"bounce", made.rays.bounce}};
      if (made.samples > 0 || IsOpenEnded(verb.scene)) json["samples"] = made.samples;
      if (made.noise > 0.0) json["noise"] = made.noise;
    }
    json["plan"] = PlanToJson(made.plan);
    for (const auto& [name, ms] : made.times) json["ms"][name] = ms;
    Print(JsonText(json));
    return;
  }
  if (verb.scene.explain) Print(PlanToText(made.plan));
  if (verb.output.empty()) return;
  std::string steps;
  for (const auto& [name, ms] : made.times) steps += fmt::format("{}{} {:.1f}", steps.empty() ? "" : ", ", name, ms);
  std::string samples;
  if (made.noise > 0.0) samples = fmt::format("; noise {:.3g}", made.noise);
  if (IsOpenEnded(verb.scene)) {
    samples += made.samples > 0 ? fmt::format("; repeat with --samples {}", made.samples) : "; free of noise, no samples";
  }
  Print(fmt::format("{}  {}; {} ms{}\n", verb.output, made.guides.layers().ToString(), steps, samples));
}

Expected<ExitCode> RunGuidegenVerb(const GuidegenVerb& verb, const Globals& globals) {
  SCUMBLE_ASSIGN(LayerSet layers, ParseLayers(verb.layers));
  std::optional<Style> style;
  if (!verb.style.style.empty()) {
    SCUMBLE_ASSIGN(style, OpenStyle(verb.style));
    layers.Add(RequiredLayers(style->transfer));
  }
  if (verb.scene.blender.frame && !IsBlenderScene(verb.scene.scene)) {
    return UsageError("--frame is for .blend scenes; " + verb.scene.scene + " is one moment: leave it out");
  }
  const bool plan_only = verb.output.empty();
  if (plan_only && !verb.scene.explain)
    return UsageError("scumble guidegen: -o FILE is required; with --explain and no -o the plan is printed alone");
  const GuideWriteOptions write{verb.scene.half, verb.compression};
  if (!plan_only) SCUMBLE_RETURN_IF_ERROR(CheckGuideTarget(verb.output, write));
  if (verb.style.style.empty() && !verb.style.sets.empty()) return UsageError("--set changes a style: give --style too");
  if (!plan_only) SCUMBLE_RETURN_IF_ERROR(CheckWritable(verb.output));
  ProgressBar bar("guidegen", globals.quiet);
  SCUMBLE_ASSIGN(SceneGuides made, MakeGuides(verb.scene, layers, globals, bar.Part(0.0, 1.0), plan_only));
  if (style) NameStyleInPlan(made.plan, *style);
  if (!plan_only) {
    Stopwatch watch;
    SCUMBLE_RETURN_IF_ERROR(WriteGuides(verb.output, made.guides, write));
    made.times.emplace_back("write", watch.Lap());
  }
  PrintResult(verb, made, globals);
  return ExitCode::kOk;
}

}  // namespace

void AddGuidegenVerb(CLI::App& app, Globals& globals, Action& chosen) {
  auto verb = std::make_shared<GuidegenVerb>();
  CLI::App* sub =
      app.add_subcommand("guidegen", "scene -> guides: what a renderer tells the transfer about every pixel");
  AddSceneOptions(*sub, verb->scene);
  AddStyleOptions(*sub, verb->style, false);
  sub->add_option("--frame", verb->scene.blender.frame,
                  "frame of a .blend scene; left out: the one it was saved at")
      ->type_name("N");
  AddLightPathOptions(*sub, verb->scene);
  sub->add_option(
         "--layers", verb->layers,
         "layers on top of A, normal, depth, object and material, with commas between: position, pref, albedo, "
         "luminance, shadow, lpe.full, lpe.LDE, lpe.LSE, lpe.LDDE, lpe.LD12E")
      ->type_name("LIST");
  sub->add_option("--compression", verb->compression, "none, rle, zips, zip or piz; all are lossless")
      ->type_name("NAME")
      ->capture_default_str();
  sub->add_option("-o,--output", verb->output, "guide file to write, .exr; required unless --explain is given")
      ->type_name("FILE");
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, &globals, &chosen] { chosen = [verb, &globals] { return RunGuidegenVerb(*verb, globals); }; });
}

}  // namespace scumble
