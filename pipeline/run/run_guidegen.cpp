// A scene to guide files: one, or a range of frames.
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "core/image/stopwatch.h"
#include "core/io/atomic_file.h"
#include "core/io/existing_output.h"
#include "core/io/guide_file.h"
#include "pipeline/memory_estimate.h"
#include "pipeline/run/guide_casters.h"
#include "pipeline/run/kept_warnings.h"
#include "pipeline/run_inputs.h"
#include "pipeline/run_requests.h"
#include "pipeline/scene/scene_sequence.h"
#include "pipeline/style_set.h"

namespace scumble {
namespace {

// `guides` apart from the rest, so that nobody copies them.
FrameReport ReportOf(const GuidegenRequest& request, const std::string& output, const GuideSet& guides,
                     const SceneGuides& made) {
  const bool open_ended = request.scene.noise > 0.0 || request.scene.time_budget_seconds > 0.0;
  GuidesReport report{output,     guides.width(), guides.height(), guides.layers(), made.samples,
                      made.noise, open_ended,     made.times,      request.explain};
  return {std::move(report), made.plan, made.memory, made.cost, 0, 0.0};
}

Expected<RunReport> GuidegenSequence(const GuidegenRequest& request, const Sequence& sequence,
                                     const LayersFor& layers_for, bool motion, const std::optional<StyleSet>& styles,
                                     const SequenceListener& listener, const RunContext& context) {
  const Size& size = request.scene.size;
  SceneFrames scene(request.scene, layers_for, motion, context);
  const std::string settings = GuideSettings(request.scene);
  GuideCasters casters(context);
  SequenceWork work;
  // What the scene asks for is in the file as well, so that nothing is loaded where nothing is left to make.
  work.check = [&](int frame, const std::string& output) -> Status {
    const Expected<GuideFileInfo> info = InspectGuides(output);
    SCUMBLE_ASSIGN(LayerSet layers, layers_for(info ? SceneStyleRequestsOf(info->header) : SceneStyleRequests()));
    SCUMBLE_RETURN_IF_ERROR(CheckWholeGuides(output, {size.width, size.height, layers.Add(AlwaysWritten()),
                                                      request.scene.half, settings, request.write.cryptomatte}));
    if (info) casters.Add(frame, info->header.attributes);
    return Ok();
  };
  work.begin = [&](std::span<const int> frames, const Progress& progress, std::optional<int>&) {
    return scene.Start(frames, progress);
  };
  work.make = [&](int frame, const std::string& output, const Progress& progress) -> Expected<FrameWrite> {
    SCUMBLE_ASSIGN(const SceneGuides* const guides, scene.At(frame, progress));
    casters.Add(frame, guides->guides.attributes);
    SceneGuides report;  // all but the pixels
    report.times = guides->times, report.plan = guides->plan, report.cost = guides->cost;
    report.memory = guides->memory;
    report.samples = guides->samples, report.noise = guides->noise;
    if (styles) NameStylesInPlan(report.plan, *styles);
    return FrameWrite([&request, output, kept = scene.Keep(),
                       rest = std::make_shared<SceneGuides>(std::move(report))]() -> Expected<FrameReport> {
      Stopwatch watch;
      const std::uint64_t before = BytesWrittenByThisThread();
      SCUMBLE_RETURN_IF_ERROR(WriteGuides(output, kept->guides, request.write));
      const double ms = watch.Lap();
      rest->times.emplace_back("write", ms);
      FrameReport done = ReportOf(request, output, kept->guides, *rest);
      done.bytes_written = BytesWrittenByThisThread() - before;
      done.write_ms = ms;
      return done;
    });
  };
  RunReport report;
  SCUMBLE_ASSIGN(report.sequence, RunSequence(sequence, work, listener, context, context.StartProgress("guidegen")));
  return report;
}

Status CheckFiles(RunInputs& files, const GuidegenRequest& request, const std::optional<Sequence>& sequence,
                  const std::optional<StyleSet>& styles) {
  if (styles) files.ReadsStyles(*styles);
  SCUMBLE_ASSIGN(const auto outputs, NamesOf(request.output, sequence));
  return files.CheckOutputs(outputs, "-o", sequence && sequence->resume);
}

Expected<RunReport> Guidegen(GuidegenRequest request, const SequenceListener& listener, const RunContext& context) {
  const LayerSet asked = request.layers;
  const bool motion = asked.Has(Layer::kMotion);
  std::optional<StyleSet> styles;
  SCUMBLE_ASSIGN(const auto sequence, PlanSequence(request.sequence, request.scene.blender.frame, request.output));
  const bool plan_only = request.output.empty();
  RunInputs files;
  request.scene.on_file = files.ReadsScene(request.scene.scene);
  const LayersFor layers_for = [&](const SceneStyleRequests& of_scene) -> Expected<LayerSet> {
    LayerSet layers = asked;
    if (styles) {
      SCUMBLE_ASSIGN(const LayerSet read, RequiredLayers(*styles, of_scene, request.scene.scene));
      layers.Add(read);
    }
    // Once more, where the scene has named files or asked for styles.
    if (!plan_only && !files.IsChecked(styles ? &*styles : nullptr))
      SCUMBLE_RETURN_IF_ERROR(CheckFiles(files, request, sequence, styles));
    return layers;
  };
  const std::optional<int> frame = request.scene.blender.frame;
  if (plan_only && !request.explain)
    return UsageError("scumble guidegen: -o FILE is required; with --explain and no -o the plan is printed alone");
  if (!plan_only) SCUMBLE_RETURN_IF_ERROR(CheckGuideTarget(request.output, request.write));
  SCUMBLE_RETURN_IF_ERROR(CheckSceneRequest(request.scene));
  if (!sequence) {
    SCUMBLE_ASSIGN(request.output, NameOfOne(request.output, request.scene.blender.frame));
    if (!frame) SCUMBLE_RETURN_IF_ERROR(CheckAtRest(request.scene, motion));
  }
  if (request.style) {
    if (!request.output.empty()) request.style->reading.room = RoomForStyles(context);  // a plan refuses nothing
    SCUMBLE_ASSIGN(styles, OpenStyles(*request.style, context));
    context.EndStage("style");
  }
  if (!plan_only) SCUMBLE_RETURN_IF_ERROR(CheckFiles(files, request, sequence, styles));
  request.scene.more_memory = [behind = sequence.has_value(), cryptomatte = request.write.cryptomatte](
                                  const Size& size, const LayerSet& layers, MemoryNeed& need) {
    if (behind) AddGuidesBehind(size, layers, need);
    AddGuideFile(size, layers, cryptomatte, need);
  };
  if (sequence && !plan_only)
    return GuidegenSequence(request, *sequence, layers_for, motion, styles, listener, context);
  const Progress progress = context.StartProgress("guidegen");
  SceneGuides made;
  if (plan_only) {
    const std::optional<int> planned = sequence ? sequence->frames.front() : frame;
    SCUMBLE_ASSIGN(made, PlanSceneAt(planned, request.scene, layers_for, context));
  } else if (frame) {
    SCUMBLE_ASSIGN(made, MakeGuidesAt(*frame, request.scene, layers_for, motion, context, progress));
  } else {
    SCUMBLE_ASSIGN(made, MakeStaticGuides(request.scene, layers_for, motion, context, progress));
  }
  if (styles) NameStylesInPlan(made.plan, *styles);
  if (!plan_only) {
    Stopwatch watch;
    SCUMBLE_RETURN_IF_ERROR(WriteGuides(request.output, made.guides, request.write));
    made.times.emplace_back("write", watch.Lap());
    context.EndStage("write");
  }
  RunReport report;
  if (plan_only) {
    report.plan = std::move(made.plan);
    report.memory = std::move(made.memory);
    report.plan_times = std::move(made.times), report.plan_is_timed = true;
    return report;
  }
  report.frame = ReportOf(request, request.output, made.guides, made);
  report.frame->bytes_written = BytesWrittenByThisThread();
  return report;
}

}  // namespace

Expected<RunReport> RunGuidegen(GuidegenRequest request, const SequenceListener& listener, const RunContext& context) {
  return KeepWarnings(context, [&](const RunContext& kept) { return Guidegen(std::move(request), listener, kept); });
}

}  // namespace scumble
