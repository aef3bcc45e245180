// A scene and styles to pictures: one, or a range of frames.
#include <fmt/format.h>

#include <span>
#include <utility>

#include "core/image/stopwatch.h"
#include "core/io/blender_camera.h"
#include "core/io/format_dispatch.h"
#include "core/io/guide_file.h"
#include "core/io/picture_file.h"
#include "pipeline/memory_estimate.h"
#include "pipeline/run/kept_warnings.h"
#include "pipeline/run/picture_sequence.h"
#include "pipeline/run_requests.h"
#include "pipeline/scene/scene_sequence.h"

namespace scumble {
namespace {

LayersFor RequiredOfScene(StyleSet& styles, const std::string& scene, const FilesCheck& check_files) {
  return [&styles, scene, check_files](const SceneStyleRequests& of_scene) -> Expected<LayerSet> {
    SCUMBLE_ASSIGN(const LayerSet layers, RequiredLayers(styles, of_scene, scene));
    SCUMBLE_RETURN_IF_ERROR(check_files());
    return layers;
  };
}

// The guides' size for a picture of the request's size that is painted upsampled.
Status ShrinkGuides(StylizeRequest& request) {
  SCUMBLE_ASSIGN(request.scene.size, GuideSizeFor(request.scene.size, request.picture.upsample));
  return Ok();
}

// Refers to styles and context.
decltype(SceneRequest::more_memory) PaintingOf(const StyleSet& styles, const StylizeRequest& request, bool is_sequence,
                                               const RunContext& context) {
  return [&styles, picture = request.picture, aa = request.scene.aa, is_sequence, &context](
             const Size& size, const LayerSet& layers, MemoryNeed& need) {
    const std::size_t fragments = FragmentsExpected(size, aa);
    AddPicture(WorkOf(styles, picture, size, layers, fragments, is_sequence, context), picture, need);
  };
}

Expected<RunReport> StylizeSequence(const StylizeRequest& request, const Sequence& sequence, StyleSet& styles,
                                    const FilesCheck& check_files, const SequenceListener& listener,
                                    const RunContext& context) {
  const Size& size = request.scene.size;
  SceneRequest options = request.scene;
  options.seed = request.picture.seed, options.fps = request.picture.fps;
  SceneFrames scene(options, RequiredOfScene(styles, options.scene, check_files), false, context);
  PictureSequence pictures(styles, request.picture, context);
  const auto source = [&](const SceneGuides& made) -> FrameGuides {
    GuideSource from{request.scene.scene, made.times, request.explain ? made.plan : std::vector<PlanItem>(), made.cost,
                     made.memory};
    NameStylesInPlan(from.plan, styles);
    return {&made.guides, std::move(from)};
  };
  const GuidesAt guides_at = [&](int frame, const Progress& progress) -> Expected<FrameGuides> {
    SCUMBLE_ASSIGN(const SceneGuides* const made, scene.At(frame, progress));
    return source(*made);
  };
  // The first frame of the range is among those that were started with, one after it need not be.
  bool looks_further = false;
  const GuidesAt guides_ahead = [&](int frame, const Progress& progress) -> Expected<FrameGuides> {
    if (frame != sequence.frames.front() && !std::exchange(looks_further, true)) {
      SCUMBLE_RETURN_IF_ERROR(scene.Restart(std::span(sequence.frames).subspan(1)));
    }
    SCUMBLE_ASSIGN(const SceneGuides* const made, scene.Peek(frame, progress));
    return source(*made);
  };
  SequenceWork work;
  // How fast a .blend plays is known when it is exported.
  std::optional<FrameRate> fps = options.fps;
  if (!fps && !IsBlenderScene(options.scene)) fps = FrameRate();
  const Size larger{size.width * request.picture.upsample, size.height * request.picture.upsample};
  work.check = [&](int frame, const std::string& output) {
    return pictures.Check(frame, output, larger.width, larger.height, fps, SamplesText(options),
                          GuidesText({{kSettingsKey, GuideSettings(options)}}, ""));
  };
  // What is wrong with a scene in one frame is most likely wrong in all.
  const GuidesAhead ahead{guides_ahead, [](int) { return false; }};
  work.begin = [&](std::span<const int> frames, const Progress& progress, std::optional<int>& failed_at) -> Status {
    std::vector<int> wanted(frames.begin(), frames.end());
    const int first = sequence.frames.front();
    // What a .blend asks for is known when its first frame is there: it may be a style that is exposed.
    const bool may_want = IsBlenderScene(options.scene) && request.style.scene_styles && !request.picture.exposure;
    SCUMBLE_RETURN_IF_ERROR(pictures.ReadOverOfAll(larger));
    const bool look = sequence.frames.size() > 1 && (may_want || pictures.MustLookAhead(sequence));
    if (look && wanted.front() != first) wanted.insert(wanted.begin(), first);
    SCUMBLE_RETURN_IF_ERROR(scene.Start(wanted, progress));
    if (look && !pictures.MustLookAhead(sequence)) {
      const Expected<FrameGuides> seen = guides_ahead(first, {});
      if (!seen && seen.error().kind != ErrorKind::kInput) return seen.error();
      if (!seen) return Ok();  // reported when it is made
    }
    SCUMBLE_RETURN_IF_ERROR(pictures.Begin(sequence, larger, ahead, {}, failed_at));
    return looks_further ? scene.Restart(frames) : Ok();
  };
  work.make = [&](int frame, const std::string& output, const Progress& progress) {
    return pictures.Make(frame, output, guides_at, 0.5, progress);
  };
  return pictures.Run(sequence, work, listener, context.StartProgress("stylize"));
}

// Without a picture: the plan of a run, why it needs each layer, and its memory.
Expected<RunReport> PlanOf(const StylizeRequest& request, const std::optional<Sequence>& sequence, StyleSet& styles,
                           const RunContext& context) {
  SceneRequest scene = request.scene;
  scene.fps = request.picture.fps;
  const std::optional<int> frame = sequence ? sequence->frames.front() : request.picture.frame;
  SCUMBLE_ASSIGN(SceneGuides made, PlanSceneAt(frame, scene, RequiredOfScene(styles, scene.scene, Ok), context));
  NameStylesInPlan(made.plan, styles);
  RunReport report;
  report.plan = std::move(made.plan);
  report.memory = std::move(made.memory);
  return report;
}

// --quality and --budget-ms: by the first frame of a sequence.
Expected<std::optional<BudgetChoice>> ChooseForStylize(StylizeRequest& request, const std::optional<Sequence>& sequence,
                                                       StyleSet& styles, const RunContext& context) {
  SceneRequest scene = request.scene;
  scene.seed = request.picture.seed, scene.fps = request.picture.fps;
  scene.more_memory = PaintingOf(styles, request, sequence.has_value(), context);  // pictures are painted on trial
  const std::optional<int> frame = sequence ? sequence->frames.front() : request.picture.frame;
  const int before = request.picture.upsample;
  SCUMBLE_ASSIGN(const std::string over, OverOnTrial(request.picture, sequence));
  SCUMBLE_ASSIGN(auto choice, ChooseForScene(request.budget, scene, frame, over, styles, request.picture, context));
  request.scene.samples = scene.samples, request.scene.samples_given = scene.samples_given;
  if (request.picture.upsample != before) SCUMBLE_RETURN_IF_ERROR(ShrinkGuides(request));
  return choice;
}

Expected<RunReport> Stylize(StylizeRequest request, const SequenceListener& listener, const RunContext& context) {
  SCUMBLE_RETURN_IF_ERROR(CheckPictureRequest(request.picture));
  SCUMBLE_RETURN_IF_ERROR(ShrinkGuides(request));
  const bool plan_only = request.picture.output.empty();
  if (plan_only && !request.explain) {
    return UsageError("scumble stylize: -o FILE is required; with --explain and no -o the plan is printed alone");
  }
  if (!plan_only) SCUMBLE_RETURN_IF_ERROR(CheckPictureTarget(request.picture.output, {request.picture.bits}));
  SCUMBLE_ASSIGN(const auto sequence, PlanSequence(request.sequence, request.picture.frame, request.picture.output));
  if (!sequence && !plan_only) SCUMBLE_RETURN_IF_ERROR(NameOne(request.picture));
  SCUMBLE_RETURN_IF_ERROR(CheckSceneRequest(request.scene));
  if (!sequence && !request.picture.frame) SCUMBLE_RETURN_IF_ERROR(CheckAtRest(request.scene, false));
  if (plan_only) {
    SCUMBLE_ASSIGN(StyleSet styles, OpenStyles(request.style, context));
    SCUMBLE_RETURN_IF_ERROR(ChooseForStylize(request, sequence, styles, context));
    request.scene.more_memory = PaintingOf(styles, request, sequence.has_value(), context);
    return PlanOf(request, sequence, styles, context);
  }
  Stopwatch watch;
  request.style.reading.room = RoomForStyles(context);
  SCUMBLE_ASSIGN(StyleSet styles, OpenStyles(request.style, context));
  const double style_ms = watch.Lap();
  context.EndStage("style");
  RunInputs files;
  request.scene.on_file = files.ReadsScene(request.scene.scene);
  SCUMBLE_RETURN_IF_ERROR(CheckFiles(files, request.picture, sequence, styles));
  const FilesCheck check_files = CheckOfSceneStyles(files, request.picture, sequence, styles);
  SCUMBLE_ASSIGN(auto choice, ChooseForStylize(request, sequence, styles, context));
  request.scene.more_memory = PaintingOf(styles, request, sequence.has_value(), context);
  if (sequence) {
    SCUMBLE_ASSIGN(RunReport report, StylizeSequence(request, *sequence, styles, check_files, listener, context));
    report.choice = std::move(choice);
    return report;
  }
  const Progress all = context.StartProgress("stylize");
  SceneRequest scene = request.scene;
  scene.seed = request.picture.seed, scene.fps = request.picture.fps;
  const LayersFor layers_for = RequiredOfScene(styles, scene.scene, check_files);
  const Progress progress = Within(all, 0.0, 0.5);
  SCUMBLE_ASSIGN(SceneGuides made,
                 request.picture.frame
                     ? MakeGuidesAt(*request.picture.frame, scene, layers_for, false, context, progress)
                     : MakeStaticGuides(scene, layers_for, false, context, progress));
  SCUMBLE_RETURN_IF_ERROR(made.guides.Validate(request.scene.scene));
  made.times.insert(made.times.begin(), {"style", style_ms});
  NameStylesInPlan(made.plan, styles);
  if (!request.explain) made.plan.clear();
  const GuideSource source{request.scene.scene, std::move(made.times), std::move(made.plan), made.cost, made.memory};
  SCUMBLE_ASSIGN(RunReport report,
                 RunOnePicture(styles, made.guides, source, request.picture, context, Within(all, 0.5, 1.0)));
  report.choice = std::move(choice);
  return report;
}

}  // namespace

Expected<RunReport> RunStylize(StylizeRequest request, const SequenceListener& listener, const RunContext& context) {
  return KeepWarnings(context, [&](const RunContext& kept) { return Stylize(std::move(request), listener, kept); });
}

}  // namespace scumble
