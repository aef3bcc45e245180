// scumble guidegen.
#include "guidegen/guidegen.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <span>

#include "cli/command.h"
#include "cli/json_text.h"
#include "cli/options.h"
#include "cli/progress_bar.h"
#include "cli/scene_frames.h"
#include "cli/sequence.h"
#include "io/atomic_file.h"
#include "io/guide_file.h"
#include "io/whole_output.h"
#include "style/style_keyframes.h"

namespace scumble {
namespace {

struct GuidegenVerb {
  SceneOptions scene;
  StyleOptions style;
  std::string layers;
  std::string compression = "zip";
  std::string output;
  SequenceOptions sequence;
};

// Whether the noise or the clock says how many samples are taken.
bool IsOpenEnded(const SceneOptions& scene) { return scene.noise > 0.0 || scene.time_budget_seconds > 0.0; }

// `guides` apart from the rest, so that nobody copies them.
FrameReport ReportOf(const GuidegenVerb& verb, const std::string& output, const GuideSet& guides,
                     const SceneGuides& made) {
  FrameReport report;
  nlohmann::ordered_json& json = report.json;
  if (!output.empty()) {
    json["output"] = output;
    json["width"] = guides.width();
    json["height"] = guides.height();
    json["layers"] = guides.layers().ToString();
    json["rays"] = {{"primary", made.rays.primary},
                    {"coverage", made.rays.coverage},
                    {"shadow", made.rays.shadow},
                    {"bounce", made.rays.bounce}};
    if (made.samples > 0 || IsOpenEnded(verb.scene)) json["samples"] = made.samples;
    if (made.noise > 0.0) json["noise"] = made.noise;
  }
  if (!made.plan.empty()) json["plan"] = PlanToJson(made.plan);
  for (const auto& [name, ms] : made.times) json["ms"][name] = ms;

  if (verb.scene.explain && !made.plan.empty()) report.text = PlanToText(made.plan);
  if (output.empty()) return report;
  std::string steps;
  for (const auto& [name, ms] : made.times) steps += fmt::format("{}{} {:.1f}", steps.empty() ? "" : ", ", name, ms);
  std::string samples;
  if (made.noise > 0.0) samples = fmt::format("; noise {:.3g}", made.noise);
  if (IsOpenEnded(verb.scene)) {
    samples += made.samples > 0 ? fmt::format("; repeat with --samples {}", made.samples) : "; free of noise, no samples";
  }
  report.text += fmt::format("{}  {}; {} ms{}\n", output, guides.layers().ToString(), steps, samples);
  return report;
}

Expected<ExitCode> GuidegenSequence(const GuidegenVerb& verb, const Sequence& sequence, const LayerSet& layers,
                                    const std::optional<Style>& style, const GuideWriteOptions& write,
                                    const Globals& globals) {
  SCUMBLE_ASSIGN(const Size size, ParseSize(verb.scene.size));
  SceneFrames scene(verb.scene, layers, globals);
  SequenceWork work;
  work.check = [&](int, const std::string& output) {
    return CheckWholeGuides(output, size.width, size.height, AlwaysWritten().Add(layers));
  };
  work.begin = [&](std::span<const int> frames, const Progress& progress) { return scene.Start(frames, progress); };
  work.make = [&](int frame, const std::string& output, const Progress& progress) -> Expected<FrameReport> {
    SCUMBLE_ASSIGN(const SceneGuides* const guides, scene.At(frame, progress));
    SceneGuides report;  // what there is to say; the pixels stay where they are
    Stopwatch watch;
    SCUMBLE_RETURN_IF_ERROR(WriteGuides(output, guides->guides, write));
    report.times = guides->times, report.plan = guides->plan, report.rays = guides->rays;
    report.samples = guides->samples, report.noise = guides->noise;
    report.times.emplace_back("write", watch.Lap());
    if (style) NameStyleInPlan(report.plan, *style);
    return ReportOf(verb, output, guides->guides, report);
  };
  ProgressBar bar("guidegen", globals.quiet);
  return RunSequence(sequence, work, bar, globals);
}

Expected<ExitCode> RunGuidegenVerb(GuidegenVerb verb, const Globals& globals) {
  SCUMBLE_ASSIGN(LayerSet layers, ParseLayers(verb.layers));
  std::optional<Style> style;
  if (!verb.style.style.empty()) {
    SCUMBLE_ASSIGN(style, OpenStyle(verb.style));
    SCUMBLE_ASSIGN(const LayerSet read, LayersOverTime(*style));
    layers.Add(read);
  }
  SCUMBLE_ASSIGN(const auto sequence, PlanSequence(verb.sequence, verb.scene.blender.frame, verb.output));
  if (verb.scene.blender.frame && !IsBlenderScene(verb.scene.scene)) {
    return UsageError("--frame is for .blend scenes; " + verb.scene.scene + " is one moment: leave it out");
  }
  const bool plan_only = verb.output.empty();
  if (plan_only && !verb.scene.explain)
    return UsageError("scumble guidegen: -o FILE is required; with --explain and no -o the plan is printed alone");
  const GuideWriteOptions write{verb.scene.half, verb.compression};
  if (!plan_only) SCUMBLE_RETURN_IF_ERROR(CheckGuideTarget(verb.output, write));
  if (verb.style.style.empty() && !verb.style.sets.empty()) return UsageError("--set changes a style: give --style too");
  if (sequence && !plan_only) return GuidegenSequence(verb, *sequence, layers, style, write, globals);
  if (sequence && IsBlenderScene(verb.scene.scene)) verb.scene.blender.frame = sequence->frames.front();
  if (!sequence) {
    SCUMBLE_ASSIGN(verb.output, NameOfOne(verb.output, verb.scene.blender.frame));
  }
  if (!plan_only) SCUMBLE_RETURN_IF_ERROR(CheckWritable(verb.output));
  ProgressBar bar("guidegen", globals.quiet);
  SCUMBLE_ASSIGN(SceneGuides made, MakeGuides(verb.scene, layers, globals, bar.Part(0.0, 1.0), plan_only));
  if (style) NameStyleInPlan(made.plan, *style);
  if (!plan_only) {
    Stopwatch watch;
    SCUMBLE_RETURN_IF_ERROR(WriteGuides(verb.output, made.guides, write));
    made.times.emplace_back("write", watch.Lap());
  }
  const FrameReport report = ReportOf(verb, verb.output, made.guides, made);
  Print(globals.json ? JsonText(report.json) : report.text);
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
  AddSequenceOptions(*sub, verb->sequence);
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, &globals, &chosen] { chosen = [verb, &globals] { return RunGuidegenVerb(*verb, globals); }; });
}

}  // namespace scumble
