// Guides and styles to pictures: one, or a range of frames.
#include <fmt/format.h>

#include <span>
#include <utility>

#include "core/image/stopwatch.h"
#include "core/io/blender_camera.h"
#include "core/io/guide_file.h"
#include "core/io/picture_file.h"
#include "pipeline/memory_estimate.h"
#include "pipeline/run/guide_casters.h"
#include "pipeline/run/kept_warnings.h"
#include "pipeline/run/picture_sequence.h"
#include "pipeline/run_requests.h"
#include "pipeline/scene/scene_sequence.h"

namespace scumble {
namespace {

GuideReadOptions ReadOptions(const TransferRequest& request) {
  GuideReadOptions read;
  read.view_layer = request.view_layer;
  read.light_layer = request.light_layer;
  read.blender_camera = request.camera;
  return read;
}

// For GuidesText.
std::string ChosenOf(const TransferRequest& request) {
  std::string text;
  if (!request.view_layer.empty()) text += "; view_layer '" + request.view_layer + "'";
  if (!request.light_layer.empty()) text += "; light_layer '" + request.light_layer + "'";
  return text;
}

// Adds what the styles read, those included that the scene of a guide file asks for. A file that cannot be read asks
// for nothing here; reading it is an error later. Layers of names are optional: a render may have one of them. `read`
// is good as long as `styles`.
Status RequireOfFile(StyleSet& styles, const std::string& file, int upsample, GuideReadOptions& read) {
  SceneStyleRequests of_scene;
  if (styles.options.scene_styles) {
    if (const Expected<GuideFileInfo> info = InspectGuides(file)) of_scene = SceneStyleRequestsOf(info->header);
  }
  SCUMBLE_ASSIGN(read.required, StyleLayers(styles, of_scene, file));
  read.remedy = [&styles](const LayerSet& missing) {
    const std::string sets = SetsWithout(styles, missing);
    return sets.empty() ? sets : "; " + sets + " does without " + missing.ToString();
  };
  read.optional = styles.LayersOfNames(of_scene);
  // Upsampling looks for edges in them, whatever the style reads, as it does in guides that are made in memory.
  if (upsample > 1) read.optional.Add({Layer::kDepth, Layer::kObject});
  return Ok();
}

// Before any of it is taken. A file that cannot be read takes nothing; reading it is an error later.
Expected<MemoryNeed> CheckMemoryOfFile(const TransferRequest& request, const std::string& file, const StyleSet& styles,
                                       const GuideReadOptions& read, bool is_sequence, const RunContext& context) {
  MemoryNeed need;
  AddProgram(context.threads, need);
  if (const Expected<GuideFileInfo> info = InspectGuides(file)) {
    AddGuidesRead(*info, read, need);
    AddPicture(WorkOf(styles, request.picture, {info->width, info->height}, read.required, info->fragments, is_sequence,
                      context),
               request.picture, need);
  }
  const std::string fix =
      request.picture.upsample > 1 ? "take a smaller --upsample, or smaller guides" : "take smaller guides";
  SCUMBLE_RETURN_IF_ERROR(CheckMemory(need, context, fix));
  return need;
}

Expected<RunReport> TransferSequence(const TransferRequest& request, const Sequence& sequence, StyleSet& styles,
                                     const GuideReadOptions& read, const FilesCheck& check_files,
                                     const SequenceListener& listener, const RunContext& context) {
  SCUMBLE_ASSIGN(const FrameName guides_name, FrameName::Parse(request.guides));
  SCUMBLE_ASSIGN(const FrameName camera, FrameName::Parse(request.camera));
  PictureSequence pictures(styles, request.picture, context);
  std::optional<GuideSet> guides;
  std::string guides_file;  // that `guides` are from
  MemoryNeed memory;        // with them
  GuideCasters casters(context);
  const GuidesAt guides_at = [&](int frame, const Progress&) -> Expected<FrameGuides> {
    const std::string file = guides_name.At(frame);
    if (guides && file == guides_file) return FrameGuides{&*guides, {file, {}, {}, {}, memory, ChosenOf(request)}};
    guides.reset();
    GuideReadOptions one = read;
    SCUMBLE_RETURN_IF_ERROR(RequireOfFile(styles, file, request.picture.GuideFactor(), one));
    SCUMBLE_RETURN_IF_ERROR(check_files());
    one.blender_camera = camera.At(frame);
    SCUMBLE_ASSIGN(memory, CheckMemoryOfFile(request, file, styles, one, true, context));
    Stopwatch watch;
    SCUMBLE_ASSIGN(guides, ReadGuides(file, one));
    context.EndStage("read");
    guides_file = file;
    casters.Add(frame, guides->attributes);
    return FrameGuides{&*guides, {file, {{"read", watch.Lap()}}, {}, {}, memory, ChosenOf(request)}};
  };
  SequenceWork work;
  work.check = [&](int frame, const std::string& output) -> Status {
    // Guides that are gone do not tell the size of their picture, nor its rate.
    const auto info = InspectGuides(guides_name.At(frame));
    if (!info) return pictures.Check(frame, output, 0, 0, {}, {}, {});
    casters.Add(frame, info->header.attributes);
    const FrameRate fps = RateOf(request.picture.fps, info->header);
    const int factor = request.picture.upsample;
    return pictures.Check(frame, output, info->width * factor, info->height * factor, fps,
                          SamplesAsked(info->header.attributes),
                          GuidesText(info->header.attributes, ChosenOf(request)));
  };
  const GuidesAhead ahead{guides_at, [&](int frame) { return IsBroken(guides_name.At(frame)); }};
  work.begin = [&](std::span<const int> frames, const Progress& progress, std::optional<int>& failed_at) -> Status {
    if (!request.camera.empty() && !camera.has_place()) SCUMBLE_RETURN_IF_ERROR(ReadBlenderCamera(request.camera));
    // What is wrong with guides that serve all frames would be wrong in each.
    if (!guides_name.has_place()) SCUMBLE_RETURN_IF_ERROR(guides_at(frames.front(), {}));
    Size size{0, 0};
    for (const int frame : frames) {
      const auto info = InspectGuides(guides_name.At(frame));
      const int factor = request.picture.upsample;
      if (info) size = {info->width * factor, info->height * factor};
      if (info || request.picture.over.empty()) break;
    }
    return pictures.Begin(sequence, size, ahead, progress, failed_at);
  };
  work.make = [&](int frame, const std::string& output, const Progress& progress) {
    return pictures.Make(frame, output, guides_at, 0.1, progress);
  };
  return pictures.Run(sequence, work, listener, context.StartProgress("transfer"));
}

// --quality and --budget-ms of a sequence: by its first frame.
Expected<std::optional<BudgetChoice>> ChooseForSequence(TransferRequest& request, const Sequence& sequence,
                                                        StyleSet& styles, GuideReadOptions read,
                                                        const RunContext& context) {
  if (!request.budget.chooses()) return std::optional<BudgetChoice>();
  const int frame = sequence.frames.front();
  SCUMBLE_ASSIGN(const FrameName name, FrameName::Parse(request.guides));
  SCUMBLE_ASSIGN(const FrameName camera, FrameName::Parse(request.camera));
  const std::string file = name.At(frame);
  SCUMBLE_RETURN_IF_ERROR(RequireOfFile(styles, file, request.picture.GuideFactor(), read));
  read.blender_camera = camera.At(frame);
  SCUMBLE_RETURN_IF_ERROR(CheckMemoryOfFile(request, file, styles, read, true, context));
  SCUMBLE_ASSIGN(const GuideSet guides, ReadGuides(file, read));
  context.EndStage("read");
  SCUMBLE_ASSIGN(const std::string over, OverOnTrial(request.picture, sequence));
  return ChooseForGuides(request.budget, guides, frame, file, over, styles, request.picture, context);
}

Expected<RunReport> Transfer(TransferRequest request, const SequenceListener& listener, const RunContext& context) {
  if (IsScene(request.guides)) {
    return InputError(request.guides +
                      " is a scene: transfer takes guides; use `scumble stylize`, or `scumble guidegen` first");
  }
  SCUMBLE_RETURN_IF_ERROR(CheckPictureRequest(request.picture));
  SCUMBLE_RETURN_IF_ERROR(CheckPictureTarget(request.picture.output, {request.picture.bits}));
  SCUMBLE_ASSIGN(const auto sequence, PlanSequence(request.sequence, request.picture.frame, request.picture.output));
  if (!sequence) {
    SCUMBLE_RETURN_IF_ERROR(NameOne(request.picture));
    SCUMBLE_ASSIGN(request.guides, NameOfOne(request.guides, request.picture.frame));
    SCUMBLE_ASSIGN(request.camera, NameOfOne(request.camera, request.picture.frame));
  }
  request.style.reading.room = RoomForStyles(context);
  SCUMBLE_ASSIGN(StyleSet styles, OpenStyles(request.style, context));
  context.EndStage("style");
  RunInputs files;
  for (const auto& [what, name] : {std::pair("the guides", &request.guides), {"the .camera file", &request.camera}}) {
    SCUMBLE_ASSIGN(const auto names, NamesOf(*name, sequence));
    for (const std::string& file : names) files.Reads(what, file);
  }
  SCUMBLE_RETURN_IF_ERROR(CheckFiles(files, request.picture, sequence, styles));
  const FilesCheck check_files = CheckOfSceneStyles(files, request.picture, sequence, styles);
  GuideReadOptions read = ReadOptions(request);
  if (sequence) {
    SCUMBLE_ASSIGN(auto choice, ChooseForSequence(request, *sequence, styles, read, context));
    SCUMBLE_ASSIGN(RunReport report,
                   TransferSequence(request, *sequence, styles, read, check_files, listener, context));
    report.choice = std::move(choice);
    return report;
  }
  Stopwatch watch;
  SCUMBLE_RETURN_IF_ERROR(RequireOfFile(styles, request.guides, request.picture.GuideFactor(), read));
  SCUMBLE_RETURN_IF_ERROR(check_files());
  SCUMBLE_ASSIGN(const MemoryNeed memory, CheckMemoryOfFile(request, request.guides, styles, read, false, context));
  SCUMBLE_ASSIGN(const GuideSet guides, ReadGuides(request.guides, read));
  const double read_ms = watch.Lap();
  context.EndStage("read");
  SCUMBLE_ASSIGN(auto choice, ChooseForGuides(request.budget, guides, request.picture.frame, request.guides,
                                              request.picture.over, styles, request.picture, context));
  const GuideSource source{request.guides, {{"read", read_ms}}, {}, {}, memory, ChosenOf(request)};
  SCUMBLE_ASSIGN(RunReport report,
                 RunOnePicture(styles, guides, source, request.picture, context, context.StartProgress("transfer")));
  report.choice = std::move(choice);
  return report;
}

}  // namespace

Expected<RunReport> RunTransfer(TransferRequest request, const SequenceListener& listener, const RunContext& context) {
  return KeepWarnings(context, [&](const RunContext& kept) { return Transfer(std::move(request), listener, kept); });
}

}  // namespace scumble
