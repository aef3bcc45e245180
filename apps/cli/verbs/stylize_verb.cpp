// scumble transfer, scumble stylize.
#include <fmt/format.h>

#include <functional>
#include <memory>
#include <span>
#include <utility>

#include "pipeline/quality/budget_choice.h"
#include "apps/cli/app/command.h"
#include "apps/cli/app/options.h"
#include "apps/cli/app/json_text.h"
#include "pipeline/memory/memory_estimate.h"
#include "pipeline/frame/provenance.h"
#include "apps/cli/app/progress_bar.h"
#include "pipeline/run/run_inputs.h"
#include "pipeline/scene/scene_sequence.h"
#include "pipeline/run/sequence.h"
#include "apps/cli/app/timing.h"
#include "pipeline/frame/paint_frame.h"
#include "core/io/blender/blender_camera.h"
#include "core/io/guide_file.h"
#include "core/io/picture_file.h"
#include "core/io/existing_output.h"
#include "core/style/style_keyframes.h"

namespace scumble {
namespace {

// The options of one frame of a sequence: its own names, its own number.
Expected<PictureOptions> OptionsAt(const PictureOptions& options, int frame, const std::string& output) {
  PictureOptions one = options;
  one.frame = frame, one.output = output;
  SCUMBLE_ASSIGN(const FrameName over, FrameName::Parse(options.over));
  one.over = over.At(frame);
  return one;
}

// Where the frames of a sequence get their guides from.
struct FrameGuides {
  const GuideSet* guides = nullptr;  // valid until the next call
  GuideSource source;
};
using GuidesAt = std::function<Expected<FrameGuides>(int frame, const Progress& progress)>;

// Styles, options and memory of a sequence of pictures.
class PictureSequence {
 public:
  PictureSequence(StyleSet& styles, const PictureOptions& options, const Globals& globals)
      : styles_(styles), options_(options), globals_(globals) {}

  // --exposure auto is measured on the first frame of the range, even where that one is kept: a sequence that is resumed
  // goes on as it began.
  // One picture underneath all frames must be there, and have the size of the first that is known.
  Status Begin(const Sequence& sequence, int width, int height, const GuidesAt& guides_at, const Progress& progress) {
    SCUMBLE_RETURN_IF_ERROR(ReadOverOfAll(width, height));
    if (!MustLookAhead(sequence)) return Ok();
    const int first = sequence.frames.front();
    const Expected<FrameGuides> found = guides_at(first, progress);
    if (!found) {
      return Error{found.error().kind, found.error().message + "; frame " + std::to_string(first) +
                                           " is the one that --exposure auto is measured on: give --exposure STOPS"};
    }
    SCUMBLE_ASSIGN(const PictureOptions one, OptionsAt(options_, first, options_.output));
    SCUMBLE_RETURN_IF_ERROR(PrepareFrame(styles_, *found->guides, one, globals_, memory_));
    Warn(fmt::format("the exposure of all frames was measured on frame {}: where a sequence is cut into several runs, "
                     "give each --exposure {:.2f}",
                     first, *memory_.exposure));
    return Ok();
  }
  Status ReadOverOfAll(int width, int height) {
    SCUMBLE_ASSIGN(const FrameName over, FrameName::Parse(options_.over));
    if (options_.over.empty() || over.has_place()) return Ok();
    SCUMBLE_RETURN_IF_ERROR(ReadOver(options_.over, memory_));
    if (width == 0 || (memory_.over->width == width && memory_.over->height == height)) return Ok();
    return InputError(fmt::format("--over {} is {}×{}, the frames are {}×{}: render both at one size", options_.over,
                                  memory_.over->width, memory_.over->height, width, height));
  }

  // Whether a picture that is there is one that Make would make, as far as can be told without its guides.
  // `samples`: of its guides' light, where that is known.
  Status Check(int frame, const std::string& output, int width, int height, std::optional<FrameRate> fps,
               std::optional<int> samples) {
    for (Style& style : styles_.styles) SCUMBLE_RETURN_IF_ERROR(SetStyleFrame(style, frame));
    SCUMBLE_ASSIGN(const std::optional<double> exposure, ParseExposure(options_.exposure));
    PictureShape shape{width, height, PictureChannels(output), PictureBits(output, {options_.bits}), {}};
    PictureSettings settings = SettingsOf(options_, fps, exposure, samples);
    if (exposure) settings.measured.reset();  // stops that were measured may be given to go on with
    shape.settings = SettingsText(styles_, settings, memory_.hashes);
    return CheckWholePicture(output, shape);
  }
  bool MustLookAhead(const Sequence& sequence) const {
    return sequence.frames.size() > 1 && MeasuresExposure(styles_, options_);
  }

  Expected<FrameWrite> Make(int frame, const std::string& output, const GuidesAt& guides_at, double guides_share,
                             const Progress& progress) {
    SCUMBLE_ASSIGN(const PictureOptions one, OptionsAt(options_, frame, output));
    SCUMBLE_ASSIGN(const FrameGuides found, guides_at(frame, Within(progress, 0.0, guides_share)));
    return TransferFrame(styles_, *found.guides, found.source, one, globals_, Within(progress, guides_share, 1.0),
                         memory_);
  }

 private:
  StyleSet& styles_;
  const PictureOptions& options_;
  const Globals& globals_;
  TransferMemory memory_;
};

struct TransferVerb {
  std::string guides;
  std::string view_layer;
  std::string camera;
  StyleOptions style;
  PictureOptions picture;
  BudgetOptions budget;
  SequenceOptions sequence;
};

GuideReadOptions ReadOptions(const TransferVerb& verb, const StyleSet& styles) {
  GuideReadOptions read;
  read.view_layer = verb.view_layer;
  read.blender_camera = verb.camera;
  if (styles.first().transfer.edge_aware) read.mend = "; --set transfer.edge_aware=false does without depth and object";
  return read;
}

// Adds what the styles read, those included that the scene of a guide file asks for. A file that cannot be read asks for
// nothing here; reading it says why. Layers that tell of names alone are optional: a render may have one of them.
Status RequireOfFile(StyleSet& styles, const std::string& file, GuideReadOptions& read) {
  StyleWishes wishes;
  if (styles.options.scene_styles) {
    if (const Expected<GuideFileInfo> info = InspectGuides(file)) wishes = WishesOf(info->header);
  }
  SCUMBLE_ASSIGN(read.required, StyleLayers(styles, wishes, file));
  read.optional = styles.LayersOfNames(wishes);
  return Ok();
}

// What painting a frame takes besides its guides.
PictureWork WorkOf(const StyleSet& styles, const PictureOptions& picture, const Size& guides, const LayerSet& layers,
                   bool is_sequence, const Globals& globals) {
  const bool has_map = styles.styles.size() > 1 || !styles.assigned.empty();
  return {styles.styles, has_map, guides, layers, is_sequence, globals.json || !picture.show.empty(), globals.threads};
}

// Before any of it is taken. A file that cannot be read takes nothing; reading it says why.
Expected<MemoryNeed> CheckMemoryOfFile(const TransferVerb& verb, const std::string& file, const StyleSet& styles,
                                       const GuideReadOptions& read, bool is_sequence, const Globals& globals) {
  MemoryNeed need;
  AddProgram(globals.threads, need);
  if (const Expected<GuideFileInfo> info = InspectGuides(file)) {
    AddGuidesRead(*info, read, need);
    AddPicture(WorkOf(styles, verb.picture, {info->width, info->height}, read.required, is_sequence, globals), verb.picture,
               need);
  }
  const std::string mend = verb.picture.upsample > 1 ? "take a smaller --upsample, or smaller guides" : "take smaller guides";
  SCUMBLE_RETURN_IF_ERROR(CheckMemory(need, globals, mend));
  return need;
}

nlohmann::ordered_json EndOfSequence(StyleSet& styles, const PictureOptions& picture) {
  nlohmann::ordered_json json = SayHowAssigned(styles);
  json.update(picture.chosen);
  return json;
}

// `files` has what the verb alone reads.
Status CheckFiles(RunFiles& files, const PictureOptions& picture, const std::optional<Sequence>& sequence,
                  const StyleSet& styles) {
  SCUMBLE_ASSIGN(const auto overs, NamesOf(picture.over, sequence));
  for (const std::string& over : overs) files.Reads("the picture of --over", over);
  files.ReadsStyles(styles);
  SCUMBLE_ASSIGN(const auto outputs, NamesOf(picture.output, sequence));
  return files.CheckOutputs(outputs);
}

// CheckFiles once more, where scene or guides have asked for styles that were not open then.
using FilesCheck = std::function<Status()>;
FilesCheck CheckOfWishes(RunFiles& files, const PictureOptions& picture, const std::optional<Sequence>& sequence,
                         const StyleSet& styles) {
  return [&] { return files.KnowsStyles(styles) ? Ok() : CheckFiles(files, picture, sequence, styles); };
}

Expected<ExitCode> TransferSequence(const TransferVerb& verb, const Sequence& sequence, StyleSet& styles,
                                    const GuideReadOptions& read, const FilesCheck& check_files, const Globals& globals) {
  SCUMBLE_ASSIGN(const FrameName guides_name, FrameName::Parse(verb.guides));
  SCUMBLE_ASSIGN(const FrameName camera, FrameName::Parse(verb.camera));
  PictureSequence pictures(styles, verb.picture, globals);
  std::optional<GuideSet> guides;
  std::string guides_file;  // that `guides` are from
  MemoryNeed memory;        // with them
  const GuidesAt guides_at = [&](int frame, const Progress&) -> Expected<FrameGuides> {
    const std::string file = guides_name.At(frame);
    if (guides && file == guides_file) return FrameGuides{&*guides, {file, {}, {}, {}, memory}};
    guides.reset();
    GuideReadOptions one = read;
    SCUMBLE_RETURN_IF_ERROR(RequireOfFile(styles, file, one));
    SCUMBLE_RETURN_IF_ERROR(check_files());
    one.blender_camera = camera.At(frame);
    SCUMBLE_ASSIGN(memory, CheckMemoryOfFile(verb, file, styles, one, true, globals));
    Stopwatch watch;
    SCUMBLE_ASSIGN(guides, ReadGuides(file, one));
    EndStage(globals, "read");
    guides_file = file;
    return FrameGuides{&*guides, {file, {{"read", watch.Lap()}}, {}, {}, memory}};
  };
  SequenceWork work;
  work.check = [&](int frame, const std::string& output) -> Status {
    // Guides that are gone cannot say how large their picture was to be, and how fast it plays.
    const auto info = InspectGuides(guides_name.At(frame));
    if (!info) return pictures.Check(frame, output, 0, 0, {}, {});
    SCUMBLE_ASSIGN(const FrameRate fps, RateFor(verb.picture, info->header));
    const int factor = verb.picture.upsample;
    return pictures.Check(frame, output, info->width * factor, info->height * factor, fps,
                          SamplesTold(info->header.attributes));
  };
  work.begin = [&](std::span<const int> frames, const Progress& progress) -> Status {
    if (!verb.camera.empty() && !camera.has_place()) SCUMBLE_RETURN_IF_ERROR(ReadBlenderCamera(verb.camera));
    // What is wrong with guides that serve all frames would be wrong in each.
    if (!guides_name.has_place()) SCUMBLE_RETURN_IF_ERROR(guides_at(frames.front(), {}));
    int width = 0, height = 0;
    for (const int frame : frames) {
      const auto info = InspectGuides(guides_name.At(frame));
      const int factor = verb.picture.upsample;
      if (info) width = info->width * factor, height = info->height * factor;
      if (info || verb.picture.over.empty()) break;
    }
    return pictures.Begin(sequence, width, height, guides_at, progress);
  };
  work.make = [&](int frame, const std::string& output, const Progress& progress) {
    return pictures.Make(frame, output, guides_at, 0.1, progress);
  };
  work.end = [&] { return EndOfSequence(styles, verb.picture); };
  ProgressBar bar("transfer", globals.quiet);
  return RunSequence(sequence, work, bar, globals);
}

// What trials of --budget-ms paint over: a sequence's first. A plan alone may leave open which frame it is of, and then
// nothing is underneath.
Expected<std::string> OverOnTrial(const PictureOptions& picture, const std::optional<Sequence>& sequence) {
  SCUMBLE_ASSIGN(const FrameName name, FrameName::Parse(picture.over));
  if (sequence) return name.At(sequence->frames.front());
  return name.must_have_frame() ? std::string() : picture.over;
}

// --quality and --budget-ms of a sequence: by its first frame.
Status ChooseForSequence(TransferVerb& verb, const Sequence& sequence, StyleSet& styles, GuideReadOptions read,
                         const Globals& globals) {
  if (!verb.budget.chooses()) return Ok();
  const int frame = sequence.frames.front();
  SCUMBLE_ASSIGN(const FrameName name, FrameName::Parse(verb.guides));
  SCUMBLE_ASSIGN(const FrameName camera, FrameName::Parse(verb.camera));
  const std::string file = name.At(frame);
  SCUMBLE_RETURN_IF_ERROR(RequireOfFile(styles, file, read));
  read.blender_camera = camera.At(frame);
  SCUMBLE_RETURN_IF_ERROR(CheckMemoryOfFile(verb, file, styles, read, true, globals));
  SCUMBLE_ASSIGN(const GuideSet guides, ReadGuides(file, read));
  EndStage(globals, "read");
  SCUMBLE_ASSIGN(const std::string over, OverOnTrial(verb.picture, sequence));
  return ChooseForGuides(verb.budget, guides, frame, file, over, styles, verb.picture, globals);
}

// Fills places for a frame's number in the names of a single picture.
Status NameOne(PictureOptions& picture) {
  SCUMBLE_ASSIGN(picture.output, NameOfOne(picture.output, picture.frame));
  SCUMBLE_ASSIGN(picture.over, NameOfOne(picture.over, picture.frame));
  return Ok();
}

Status CheckNumbers(const PictureOptions& picture) {
  SCUMBLE_RETURN_IF_ERROR(ParseExposure(picture.exposure));
  if (!picture.fps.empty()) SCUMBLE_RETURN_IF_ERROR(ParseFps(picture.fps));
  return Ok();
}

Expected<ExitCode> RunTransferVerb(TransferVerb verb, const Globals& globals) {
  if (IsScene(verb.guides)) {
    return InputError(verb.guides + " is a scene: transfer takes guides; use `scumble stylize`, or `scumble guidegen` first");
  }
  SCUMBLE_RETURN_IF_ERROR(CheckPictureTarget(verb.picture.output, {verb.picture.bits}));
  SCUMBLE_ASSIGN(const auto sequence, PlanSequence(verb.sequence, verb.picture.frame, verb.picture.output));
  if (!sequence) {
    SCUMBLE_RETURN_IF_ERROR(NameOne(verb.picture));
    SCUMBLE_ASSIGN(verb.guides, NameOfOne(verb.guides, verb.picture.frame));
    SCUMBLE_ASSIGN(verb.camera, NameOfOne(verb.camera, verb.picture.frame));
  }
  SCUMBLE_RETURN_IF_ERROR(CheckNumbers(verb.picture));
  verb.style.room = RoomForStyles(globals);
  SCUMBLE_ASSIGN(StyleSet styles, OpenStyles(verb.style));
  EndStage(globals, "style");
  RunFiles files;
  for (const auto& [what, name] : {std::pair("the guides", &verb.guides), {"the .camera file", &verb.camera}}) {
    SCUMBLE_ASSIGN(const auto names, NamesOf(*name, sequence));
    for (const std::string& file : names) files.Reads(what, file);
  }
  SCUMBLE_RETURN_IF_ERROR(CheckFiles(files, verb.picture, sequence, styles));
  const FilesCheck check_files = CheckOfWishes(files, verb.picture, sequence, styles);
  GuideReadOptions read = ReadOptions(verb, styles);
  if (sequence) {
    SCUMBLE_RETURN_IF_ERROR(ChooseForSequence(verb, *sequence, styles, read, globals));
    return TransferSequence(verb, *sequence, styles, read, check_files, globals);
  }
  Stopwatch watch;
  SCUMBLE_RETURN_IF_ERROR(RequireOfFile(styles, verb.guides, read));
  SCUMBLE_RETURN_IF_ERROR(check_files());
  SCUMBLE_ASSIGN(const MemoryNeed memory, CheckMemoryOfFile(verb, verb.guides, styles, read, false, globals));
  SCUMBLE_ASSIGN(const GuideSet guides, ReadGuides(verb.guides, read));
  const double read_ms = watch.Lap();
  EndStage(globals, "read");
  SCUMBLE_RETURN_IF_ERROR(ChooseForGuides(verb.budget, guides, verb.picture.frame, verb.guides, verb.picture.over, styles,
                                          verb.picture, globals));
  ProgressBar bar("transfer", globals.quiet);
  const GuideSource source{verb.guides, {{"read", read_ms}}, {}, {}, memory};
  return RunTransfer(styles, guides, source, verb.picture, globals, bar.Part(0.0, 1.0));
}

struct StylizeVerb {
  SceneOptions scene;
  StyleOptions style;
  PictureOptions picture;
  BudgetOptions budget;
  SequenceOptions sequence;
};

LayersFor RequiredOfScene(StyleSet& styles, const std::string& scene, const FilesCheck& check_files) {
  return [&styles, scene, check_files](const StyleWishes& wishes) -> Expected<LayerSet> {
    SCUMBLE_ASSIGN(const LayerSet layers, RequiredLayers(styles, wishes, scene));
    SCUMBLE_RETURN_IF_ERROR(check_files());
    return layers;
  };
}

// The guides' size for a picture of --size that is painted upsampled.
Status ShrinkGuides(StylizeVerb& verb) {
  const int factor = verb.picture.upsample;
  if (factor == 1) return Ok();
  SCUMBLE_ASSIGN(const Size size, ParseSize(verb.scene.size));
  if (size.width % factor || size.height % factor) {
    return UsageError(fmt::format("--size {} with --upsample {}: the guides are {} times smaller, so both sides must be "
                                  "multiples of {}; take --size {}x{}",
                                  verb.scene.size, factor, factor, factor, (size.width + factor - 1) / factor * factor,
                                  (size.height + factor - 1) / factor * factor));
  }
  verb.scene.size = fmt::format("{}x{}", size.width / factor, size.height / factor);
  return Ok();
}

// Refers to both.
decltype(SceneOptions::more_memory) PaintingOf(const StyleSet& styles, const PictureOptions& picture, bool is_sequence,
                                               const Globals& globals) {
  return [&styles, picture, is_sequence, &globals](const Size& size, const LayerSet& layers, MemoryNeed& need) {
    AddPicture(WorkOf(styles, picture, size, layers, is_sequence, globals), picture, need);
  };
}

Expected<ExitCode> StylizeSequence(const StylizeVerb& verb, const Sequence& sequence, StyleSet& styles,
                                   const FilesCheck& check_files, const Globals& globals) {
  SCUMBLE_ASSIGN(const Size size, ParseSize(verb.scene.size));
  SceneOptions options = verb.scene;
  options.seed = verb.picture.seed, options.fps = verb.picture.fps;
  SceneFrames scene(options, RequiredOfScene(styles, options.scene, check_files), false, globals);
  PictureSequence pictures(styles, verb.picture, globals);
  const auto source = [&](const SceneGuides& made) -> FrameGuides {
    GuideSource from{verb.scene.scene, made.times, verb.scene.explain ? made.plan : std::vector<PlanItem>(), made.cost,
                     made.memory};
    for (const Style& style : styles.styles) NameStyleInPlan(from.plan, style);
    return {&made.guides, std::move(from)};
  };
  const GuidesAt guides_at = [&](int frame, const Progress& progress) -> Expected<FrameGuides> {
    SCUMBLE_ASSIGN(const SceneGuides* const made, scene.At(frame, progress));
    return source(*made);
  };
  const GuidesAt guides_ahead = [&](int frame, const Progress& progress) -> Expected<FrameGuides> {
    SCUMBLE_ASSIGN(const SceneGuides* const made, scene.Ahead(frame, progress));
    return source(*made);
  };
  SequenceWork work;
  // How fast a .blend plays is known when it is exported.
  std::optional<FrameRate> fps;
  if (!options.fps.empty() || !IsBlenderScene(options.scene)) {
    SCUMBLE_ASSIGN(fps, ParseFps(options.fps.empty() ? kUsualFps : options.fps));
  }
  const int width = size.width * verb.picture.upsample, height = size.height * verb.picture.upsample;
  work.check = [&](int frame, const std::string& output) {
    return pictures.Check(frame, output, width, height, fps, options.samples);
  };
  work.begin = [&](std::span<const int> frames, const Progress& progress) -> Status {
    std::vector<int> wanted(frames.begin(), frames.end());
    const int first = sequence.frames.front();
    // What a .blend wants is known when its first frame is there: it may be a style that is exposed.
    const bool may_want = IsBlenderScene(options.scene) && verb.style.scene_styles && verb.picture.exposure == "auto";
    SCUMBLE_RETURN_IF_ERROR(pictures.ReadOverOfAll(width, height));
    const bool look = sequence.frames.size() > 1 && (may_want || pictures.MustLookAhead(sequence));
    if (look && wanted.front() != first) wanted.insert(wanted.begin(), first);
    SCUMBLE_RETURN_IF_ERROR(scene.Start(wanted, progress));
    if (look && !pictures.MustLookAhead(sequence) && !guides_ahead(first, {})) return Ok();  // said when it is made
    return pictures.Begin(sequence, width, height, guides_ahead, {});
  };
  work.make = [&](int frame, const std::string& output, const Progress& progress) {
    return pictures.Make(frame, output, guides_at, 0.5, progress);
  };
  work.end = [&] { return EndOfSequence(styles, verb.picture); };
  ProgressBar bar("stylize", globals.quiet);
  return RunSequence(sequence, work, bar, globals);
}

// Without a picture: what a run would cast, and why.
Expected<ExitCode> PrintPlan(const StylizeVerb& verb, StyleSet& styles, const Globals& globals) {
  SceneOptions scene = verb.scene;
  scene.animation.clear();  // a plan is the same at any time
  scene.blender.frame = verb.picture.frame;
  ProgressBar bar("stylize", globals.quiet);
  SCUMBLE_ASSIGN(SceneGuides made, MakeGuidesAtRest(scene, RequiredOfScene(styles, scene.scene, Ok), false, globals,
                                                    bar.Part(0.0, 1.0), true));
  for (const Style& style : styles.styles) NameStyleInPlan(made.plan, style);
  bar.Clear();
  const nlohmann::ordered_json json{{"plan", PlanToJson(made.plan)}, {"memory", MemoryToJson(made.memory)}};
  Print(globals.json ? JsonText(json) : PlanToText(made.plan) + MemoryToText(made.memory));
  return ExitCode::kOk;
}

// --quality and --budget-ms: by the first frame of a sequence.
Status ChooseForStylize(StylizeVerb& verb, const std::optional<Sequence>& sequence, StyleSet& styles, const Globals& globals) {
  SceneOptions scene = verb.scene;
  scene.seed = verb.picture.seed, scene.fps = verb.picture.fps;
  scene.more_memory = PaintingOf(styles, verb.picture, sequence.has_value(), globals);  // pictures are painted on trial
  const std::optional<int> frame = sequence ? sequence->frames.front() : verb.picture.frame;
  if (!frame && verb.scene.explain && verb.picture.output.empty()) scene.animation.clear();  // a plan is the same at any time
  const int before = verb.picture.upsample;
  SCUMBLE_ASSIGN(const std::string over, OverOnTrial(verb.picture, sequence));
  SCUMBLE_RETURN_IF_ERROR(ChooseForScene(verb.budget, scene, frame, over, styles, verb.picture, globals));
  verb.scene.samples = scene.samples;
  return verb.picture.upsample == before ? Ok() : ShrinkGuides(verb);
}

Expected<ExitCode> RunStylizeVerb(StylizeVerb verb, const Globals& globals) {
  SCUMBLE_RETURN_IF_ERROR(ShrinkGuides(verb));
  if (verb.picture.output.empty()) {
    if (!verb.scene.explain) {
      return UsageError("scumble stylize: -o FILE is required; with --explain and no -o the plan is printed alone");
    }
    SCUMBLE_RETURN_IF_ERROR(CheckSceneOptions(verb.scene));
    SCUMBLE_ASSIGN(StyleSet styles, OpenStyles(verb.style));
    SCUMBLE_RETURN_IF_ERROR(ChooseForStylize(verb, std::nullopt, styles, globals));
    verb.scene.more_memory = PaintingOf(styles, verb.picture, false, globals);
    return PrintPlan(verb, styles, globals);
  }
  SCUMBLE_RETURN_IF_ERROR(CheckPictureTarget(verb.picture.output, {verb.picture.bits}));
  SCUMBLE_ASSIGN(const auto sequence, PlanSequence(verb.sequence, verb.picture.frame, verb.picture.output));
  if (!sequence) SCUMBLE_RETURN_IF_ERROR(NameOne(verb.picture));
  SCUMBLE_RETURN_IF_ERROR(CheckNumbers(verb.picture));
  SCUMBLE_RETURN_IF_ERROR(CheckSceneOptions(verb.scene));
  Stopwatch watch;
  verb.style.room = RoomForStyles(globals);
  SCUMBLE_ASSIGN(StyleSet styles, OpenStyles(verb.style));
  const double style_ms = watch.Lap();
  EndStage(globals, "style");
  RunFiles files;
  files.ReadsScene(verb.scene.scene);
  SCUMBLE_RETURN_IF_ERROR(CheckFiles(files, verb.picture, sequence, styles));
  const FilesCheck check_files = CheckOfWishes(files, verb.picture, sequence, styles);
  SCUMBLE_RETURN_IF_ERROR(ChooseForStylize(verb, sequence, styles, globals));
  verb.scene.more_memory = PaintingOf(styles, verb.picture, sequence.has_value(), globals);
  if (sequence) return StylizeSequence(verb, *sequence, styles, check_files, globals);
  ProgressBar bar("stylize", globals.quiet);
  SceneOptions scene = verb.scene;
  scene.seed = verb.picture.seed, scene.fps = verb.picture.fps;
  const LayersFor layers_for = RequiredOfScene(styles, scene.scene, check_files);
  const Progress progress = bar.Part(0.0, 0.5);
  SCUMBLE_ASSIGN(SceneGuides made, verb.picture.frame
                                       ? MakeGuidesAt(*verb.picture.frame, scene, layers_for, false, globals, progress)
                                       : MakeGuidesAtRest(scene, layers_for, false, globals, progress, false));
  SCUMBLE_RETURN_IF_ERROR(made.guides.Validate(verb.scene.scene));
  made.times.insert(made.times.begin(), {"style", style_ms});
  for (const Style& style : styles.styles) NameStyleInPlan(made.plan, style);
  if (!verb.scene.explain) made.plan.clear();
  const GuideSource source{verb.scene.scene, std::move(made.times), std::move(made.plan), made.cost, made.memory};
  return RunTransfer(styles, made.guides, source, verb.picture, globals, bar.Part(0.5, 1.0));
}

}  // namespace

void AddTransferVerb(CLI::App& app, Globals& globals, Action& chosen) {
  auto verb = std::make_shared<TransferVerb>();
  CLI::App* sub = app.add_subcommand("transfer", "guides + style -> picture, from a guide file of guidegen or a Blender render");
  sub->add_option("guides", verb->guides, "guide file: .exr")->type_name("FILE")->required();
  sub->add_option("--view-layer", verb->view_layer, "which view layer of a multilayer file")->type_name("NAME");
  sub->add_option("--camera", verb->camera, "the .camera file of a Blender render; left out: found from its Position pass")
      ->type_name("FILE");
  AddStyleOptions(*sub, verb->style, true);
  AddPictureOptions(*sub, verb->picture, true);
  AddBudgetOptions(*sub, verb->budget, false);
  AddSequenceOptions(*sub, verb->sequence);
  AddTimingOption(*sub, globals);
  AddMemoryOption(*sub, globals);
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, sub, &globals, &chosen] {
    chosen = [verb, sub, &globals]() -> Expected<ExitCode> {
      SCUMBLE_RETURN_IF_ERROR(CheckBudgetOptions(*sub, verb->budget));
      return RunTransferVerb(*verb, globals);
    };
  });
}

void AddStylizeVerb(CLI::App& app, Globals& globals, Action& chosen) {
  auto verb = std::make_shared<StylizeVerb>();
  CLI::App* sub = app.add_subcommand("stylize", "scene + style -> picture: guidegen and transfer in one go");
  AddSceneOptions(*sub, verb->scene);
  AddSampleOptions(*sub, verb->scene);
  AddStyleOptions(*sub, verb->style, true);
  AddPictureOptions(*sub, verb->picture, false);
  AddBudgetOptions(*sub, verb->budget, true);
  AddSequenceOptions(*sub, verb->sequence);
  AddTimingOption(*sub, globals);
  AddMemoryOption(*sub, globals);
  AddGlobalOptions(*sub, globals);
  sub->callback([verb, sub, &globals, &chosen] {
    chosen = [verb, sub, &globals]() -> Expected<ExitCode> {
      SCUMBLE_RETURN_IF_ERROR(CheckBudgetOptions(*sub, verb->budget));
      return RunStylizeVerb(*verb, globals);
    };
  });
}

}  // namespace scumble
