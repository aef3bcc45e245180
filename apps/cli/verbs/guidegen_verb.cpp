// scumble guidegen.
#include "guidegen/guidegen.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <span>

#include "apps/cli/app/command.h"
#include "apps/cli/app/run_report.h"
#include "apps/cli/app/json_text.h"
#include "pipeline/memory/memory_estimate.h"
#include "apps/cli/app/options.h"
#include "apps/cli/app/progress_bar.h"
#include "pipeline/run/run_inputs.h"
#include "pipeline/scene/scene_sequence.h"
#include "pipeline/run/sequence.h"
#include "pipeline/style/style_set.h"
#include "apps/cli/app/timing.h"
#include "core/io/file/atomic_file.h"
#include "core/io/guide_file.h"
#include "core/io/existing_output.h"

namespace scumble {
namespace {

struct GuidegenVerb {
  SceneOptions scene;
  StyleOptions style;
  std::string layers;
  std::string compression = "zip";
  bool fast_io = false;
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
    CostToJson(made.cost, json);
    if (made.samples > 0 || IsOpenEnded(verb.scene)) json["samples"] = made.samples;
    if (made.noise > 0.0) json["noise"] = made.noise;
  }
  if (!made.plan.empty()) json["plan"] = PlanToJson(made.plan);
  json["memory"] = MemoryToJson(made.memory);
  for (const auto& [name, ms] : made.times) json["ms"][name] = ms;

  if (verb.scene.explain && !made.plan.empty()) report.text = PlanToText(made.plan) + MemoryToText(made.memory);
  if (output.empty()) return report;
  if (!report.text.empty()) report.text += CostToText(made.cost);
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

void NameStylesInPlan(std::vector<PlanItem>& plan, const std::optional<StyleSet>& styles) {
  if (!styles) return;
  for (const Style& style : styles->styles) NameStyleInPlan(plan, style);
}

Expected<ExitCode> GuidegenSequence(const GuidegenVerb& verb, const Sequence& sequence, const LayersFor& layers_for,
                                    bool motion, const std::optional<StyleSet>& styles, const GuideWriteOptions& write,
                                    const Globals& globals) {
  SCUMBLE_ASSIGN(const Size size, ParseSize(verb.scene.size));
  SceneFrames scene(verb.scene, layers_for, motion, globals);
  const std::string settings = GuideSettings(verb.scene);
  SequenceWork work;
  // What the scene wishes is in the file as well, so that nothing is loaded where nothing is left to make.
  work.check = [&](int, const std::string& output) -> Status {
    const Expected<GuideFileInfo> info = InspectGuides(output);
    SCUMBLE_ASSIGN(LayerSet layers, layers_for(info ? WishesOf(info->header) : StyleWishes()));
    return CheckWholeGuides(output, {size.width, size.height, layers.Add(AlwaysWritten()), verb.scene.half, settings});
  };
  work.begin = [&](std::span<const int> frames, const Progress& progress) { return scene.Start(frames, progress); };
  work.make = [&](int frame, const std::string& output, const Progress& progress) -> Expected<FrameWrite> {
    SCUMBLE_ASSIGN(const SceneGuides* const guides, scene.At(frame, progress));
    SceneGuides report;  // what there is to say; the pixels stay where they are
    report.times = guides->times, report.plan = guides->plan, report.cost = guides->cost;
    report.memory = guides->memory;
    report.samples = guides->samples, report.noise = guides->noise;
    NameStylesInPlan(report.plan, styles);
    return FrameWrite([&verb, &write, output, kept = scene.Keep(),
                       told = std::make_shared<SceneGuides>(std::move(report))]() -> Expected<FrameReport> {
      Stopwatch watch;
      const std::uint64_t before = BytesWrittenByThisThread();
      SCUMBLE_RETURN_IF_ERROR(WriteGuides(output, kept->guides, write));
      const double ms = watch.Lap();
      told->times.emplace_back("write", ms);
      FrameReport done = ReportOf(verb, output, kept->guides, *told);
      done.json["work"]["bytes_written"] = BytesWrittenByThisThread() - before;
      done.write_ms = ms;
      return done;
    });
  };
  ProgressBar bar("guidegen", globals.quiet);
  return RunSequence(sequence, work, bar, globals);
}

Status CheckFiles(RunFiles& files, const GuidegenVerb& verb, const std::optional<Sequence>& sequence,
                  const std::optional<StyleSet>& styles) {
  files.ReadsScene(verb.scene.scene);
  if (styles) files.ReadsStyles(*styles);
  SCUMBLE_ASSIGN(const auto outputs, NamesOf(verb.output, sequence));
  return files.CheckOutputs(outputs);
}

Expected<ExitCode> RunGuidegenVerb(GuidegenVerb verb, const Globals& globals) {
  SCUMBLE_ASSIGN(const LayerSet asked, ParseLayers(verb.layers));
  const bool motion = asked.Has(Layer::kMotion);
  std::optional<StyleSet> styles;
  if (!verb.style.style.empty()) {
    if (!verb.output.empty()) verb.style.room = RoomForStyles(globals);  // a plan refuses nothing
    SCUMBLE_ASSIGN(styles, OpenStyles(verb.style));
    EndStage(globals, "style");
  }
  SCUMBLE_ASSIGN(const auto sequence, PlanSequence(verb.sequence, verb.scene.blender.frame, verb.output));
  const bool plan_only = verb.output.empty();
  RunFiles files;
  const LayersFor layers_for = [&](const StyleWishes& wishes) -> Expected<LayerSet> {
    LayerSet layers = asked;
    if (!styles) return layers;
    SCUMBLE_ASSIGN(const LayerSet read, RequiredLayers(*styles, wishes, verb.scene.scene));
    // Once more, where the scene has asked for styles.
    if (!plan_only && !files.KnowsStyles(*styles)) SCUMBLE_RETURN_IF_ERROR(CheckFiles(files, verb, sequence, styles));
    return layers.Add(read);
  };
  const std::optional<int> frame = verb.scene.blender.frame;
  if (plan_only && !verb.scene.explain)
    return UsageError("scumble guidegen: -o FILE is required; with --explain and no -o the plan is printed alone");
  const GuideWriteOptions write{verb.scene.half, verb.fast_io ? kFastCompression : verb.compression};
  if (!plan_only) SCUMBLE_RETURN_IF_ERROR(CheckGuideTarget(verb.output, write));
  if (verb.style.style.empty() && !verb.style.sets.empty()) return UsageError("--set changes a style: give --style too");
  if (verb.style.style.empty() && !verb.style.assigned.empty()) {
    return UsageError("--assign goes with a style for all the rest: give --style too");
  }
  SCUMBLE_RETURN_IF_ERROR(CheckSceneOptions(verb.scene));
  if (!sequence) {
    SCUMBLE_ASSIGN(verb.output, NameOfOne(verb.output, verb.scene.blender.frame));
  }
  if (!plan_only) SCUMBLE_RETURN_IF_ERROR(CheckFiles(files, verb, sequence, styles));
  verb.scene.more_memory = [behind = sequence && !plan_only](const Size& size, const LayerSet& layers, MemoryNeed& need) {
    if (behind) AddGuidesBehind(size, layers, need);
    AddGuideFile(size, layers, need);
  };
  if (sequence && !plan_only) return GuidegenSequence(verb, *sequence, layers_for, motion, styles, write, globals);
  if (sequence && IsBlenderScene(verb.scene.scene)) verb.scene.blender.frame = sequence->frames.front();
  ProgressBar bar("guidegen", globals.quiet);
  SceneGuides made;
  if (frame && !plan_only) {
    SCUMBLE_ASSIGN(made, MakeGuidesAt(*frame, verb.scene, layers_for, motion, globals, bar.Part(0.0, 1.0)));
  } else {
    // A plan is the same at any time.
    const bool timeless = plan_only && (frame || sequence);
    SceneOptions scene = verb.scene;
    if (timeless) scene.animation.clear();
    SCUMBLE_ASSIGN(made, MakeGuidesAtRest(scene, layers_for, motion && !timeless, globals, bar.Part(0.0, 1.0),
                                          plan_only));
  }
  NameStylesInPlan(made.plan, styles);
  if (!plan_only) {
    Stopwatch watch;
    SCUMBLE_RETURN_IF_ERROR(WriteGuides(verb.output, made.guides, write));
    made.times.emplace_back("write", watch.Lap());
    EndStage(globals, "write");
  }
  FrameReport report = ReportOf(verb, verb.output, made.guides, made);
  if (!plan_only) report.json["work"]["bytes_written"] = BytesWrittenByThisThread();
  if (globals.timing) {
    report.json["timing"] = globals.timing->ToJson();
    report.text += globals.timing->ToText();
  }
  if (!plan_only) report.json["memory"]["peak_bytes"] = PeakMemory();
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
                  "frame of a scene that moves; left out: of a .blend the one it was saved at, of glTF the nodes as "
                  "they stand")
      ->type_name("N");
  AddFpsOption(*sub, verb->scene.fps, 
               "frames a second of a glTF animation, as 24 or 24000/1001: frame N is at N / RATE s; left out: 24. Of a "
               ".blend what its guides say to transfer; left out: its own");
  AddLightPathOptions(*sub, verb->scene);
  sub->add_option(
         "--layers", verb->layers,
         "layers on top of A, normal, depth, object and material, with commas between: position, pref, albedo, "
         "luminance, shadow, lpe.full, lpe.LDE, lpe.LSE, lpe.LDDE, lpe.LD12E; with --frame or --frames motion, to the "
         "next frame")
      ->type_name("LIST");
  auto* compression =
      sub->add_option("--compression", verb->compression, "none, rle, zips, zip or piz; all are lossless");
  compression->type_name("NAME")->capture_default_str();
  AddFastIoOption(*sub, verb->fast_io)->excludes(compression);
  sub->add_option("-o,--output", verb->output, "guide file to write, .exr; required unless --explain is given")
      ->type_name("FILE");
  AddSequenceOptions(*sub, verb->sequence);
  AddTimingOption(*sub, globals);
  AddMemoryOption(*sub, globals);
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, &globals, &chosen] { chosen = [verb, &globals] { return RunGuidegenVerb(*verb, globals); }; });
}

}  // namespace scumble
