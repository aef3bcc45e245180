#include "pipeline/workspace.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "core/filter/more_workers.h"
#include "core/io/library.h"
#include "pipeline/file_stamp.h"
#include "pipeline/frame/paint_picture.h"
#include "pipeline/frame/provenance.h"
#include "pipeline/frame_range.h"
#include "pipeline/memory_estimate.h"
#include "pipeline/run/picture_sequence.h"
#include "pipeline/run_inputs.h"
#include "pipeline/scene/scene_sequence.h"
#include "pipeline/scene_guides.h"
#include "pipeline/style/kept_pictures.h"
#include "pipeline/style_set.h"

namespace scumble {
namespace {

// Stamps of files, by path.
using FileStamps = std::map<std::string, std::string>;

// Each name once, in their order.
class NameList {
 public:
  void Add(const std::string& name) {
    if (!name.empty() && known_.insert(name).second) names_.push_back(name);
  }
  std::vector<std::string> Take() { return std::move(names_); }

 private:
  std::set<std::string> known_;
  std::vector<std::string> names_;
};

// What the choice of a step depends on, besides the styles. The view and the frame are taken not to matter.
std::string ChoiceText(const BudgetRequest& budget, const SceneRequest& scene, const PictureRequest& picture,
                       const FileStamps& scene_stamps) {
  if (!budget.chooses()) return "";
  std::string text = fmt::format("{} {} {}; {}; {} {}; {} {} {} {}", budget.quality ? int(*budget.quality) : -1,
                                 budget.budget_ms, budget.guides_are_fixed, SizeToText(scene.size), scene.samples,
                                 scene.samples_given, picture.upsample, picture.upscale, !picture.over.empty(),
                                 picture.show                ? int(*picture.show)
                                 : picture.IsOfPaintedSize() ? 100
                                                             : -1);
  if (budget.quality) return text;
  SceneRequest seen = scene;
  seen.camera.clear(), seen.view.reset(), seen.seed = 0;
  if (seen.light) seen.light = LightAngles();  // its direction does not matter, that it is one sun does
  text +=
      fmt::format("; {}; isa {}; half {}; field {}", GuideSettings(seen), scene.isa, scene.half, picture.KeepsField());
  for (const auto& [path, stamp] : scene_stamps) text += "\n" + stamp;
  return text;
}

FileStamps StyleStamps(const StyleSet& styles) {
  RunInputs files;
  files.ReadsStyles(styles);
  std::vector<std::string> paths = files.Inputs();
  for (const std::string& one : styles.options.assigned) {
    if (one.size() > 1 && one.front() == '@') paths.push_back(one.substr(1));
  }
  FileStamps stamps;
  for (const std::string& path : paths) stamps[path] = StampOf(path);
  return stamps;
}

FileStamps StampsNow(const FileStamps& of) {
  FileStamps now;
  for (const auto& [path, stamp] : of) now[path] = StampOf(path);
  return now;
}

// Of styles that were read since `begun`, when their files had the stamps `before`, as far as they were known. A file
// that changed while it was read counts as another one: it is read again.
FileStamps StampsAsRead(const StyleSet& styles, const FileStamps& before, std::chrono::system_clock::time_point begun) {
  FileStamps stamps = StyleStamps(styles);
  for (auto& [path, stamp] : stamps) {
    if (const auto known = before.find(path); known != before.end()) {
      stamp = known->second;
    } else if (HasChangedSince(path, begun)) {
      stamp.clear();
    }
  }
  return stamps;
}

// Whether two requests open the same styles. All fields are named, so that a new one does not compile unnoticed;
// `reading` is the workspace's own.
bool AreSame(const StyleRequest& a, const StyleRequest& b) {
  const auto key = [](const StyleRequest& request) {
    const auto& [style, sets, assigned, scene_styles, finishes, finish_measures, reading] = request;
    return std::tie(style, sets, assigned, scene_styles, finishes, finish_measures);
  };
  return key(a) == key(b);
}

Status CheckArguments(const SceneRequest& scene, std::optional<int> frame, bool motion = false) {
  SCUMBLE_RETURN_IF_ERROR(CheckSceneRequest(scene));
  SCUMBLE_RETURN_IF_ERROR(CheckFrame(frame));
  return frame ? Ok() : CheckAtRest(scene, motion);
}

// Whether exemplars that were prepared for one style serve another: they have the same paint, and their settings differ
// only where a transfer reads them from the style frame by frame.
bool SharesExemplars(const Style& a, const Style& b) {
  TransferSettings of_a = a.transfer;
  const TransferSettings& of_b = b.transfer;
  of_a.threshold = of_b.threshold, of_a.threshold_metric = of_b.threshold_metric;
  of_a.jitter = of_b.jitter, of_a.jitter_fps = of_b.jitter_fps;
  of_a.coherent = of_b.coherent, of_a.variety = of_b.variety;
  of_a.crease = of_b.crease, of_a.depth_tolerance = of_b.depth_tolerance;
  of_a.match_step = of_b.match_step;
  return TextOf(of_a) == TextOf(of_b) && HashOfPaint(a) == HashOfPaint(b);
}

}  // namespace

struct Workspace::State {
  // Cancel takes effect between two steps, and at every progress callback.
  explicit State(RunContext given) : context(std::move(given)), outer_progress(context.on_progress) {
    context.on_progress = [this](const std::string& label) -> Progress {
      return [this, next = outer_progress ? outer_progress(label) : Progress()](double share) {
        return !context.is_cancelled() && (!next || next(share));
      };
    };
    context.is_cancelled = [this, outer = context.is_cancelled] {
      return call == Call::kCancelled || (outer && outer());
    };
  }

  RunContext context;
  std::function<Progress(const std::string&)> outer_progress;
  enum class Call { kNone, kRuns, kCancelled };
  std::atomic<Call> call = Call::kNone;
  struct Running {  // while it lives, a call runs
    explicit Running(State& of) : state(of), workers(of.context.threads) {
      SetIoThreads(state.context.threads);
      state.call = Call::kRuns;
    }
    ~Running() { state.call = Call::kNone; }
    State& state;
    const MoreWorkers workers;
  };
  WorkspaceCounters counters;

  // The scene: loaded, then posed and seen.
  std::string scene_key;
  FileStamps scene_stamps;                    // of all that it consists of, also where it could not be loaded
  std::optional<AnimatedScene> animation;     // none: the scene is Blender's
  std::string pose_key, light_key;            // when and from where it is seen; by which light
  std::vector<std::string> texture_warnings;  // since the scene was loaded
  std::optional<StaticScene> posed;
  std::optional<RayScene> rays;                                // of `posed`, which it borrows
  OwnLights own_lights;                                        // of `posed`, before others were added
  std::optional<SceneSphere> sphere_at_rest, sphere_at_start;  // of `animation`, where they are known
  std::string guides_key, guides_light_key;                    // without what only light depends on; with it
  std::shared_ptr<const SceneGuides> guides;
  MemoryNeed guides_memory;  // of them, without painting

  // The styles, and what was prepared of them.
  KeptPictures pictures;
  std::string choice_text;  // that the step of the ladder was chosen by
  FileStamps style_stamps;
  std::optional<StyleSet> styles, replaced;  // `replaced`: those that picture.prepared is of, where it is not `styles`
  PictureState picture;
  std::string over_stamp;       // of picture.over
  bool exposure_given = false;  // by the last request, not measured

  // The step of the ladder that the styles are at, and what it makes of the requests.
  struct Choice {
    std::optional<BudgetChoice> made;
    int upsample = 1;
    bool upscale = false;
    int samples = 0;
    bool samples_given = false;
  };
  Choice choice;

  using Choose = std::function<Expected<Choice>(StyleSet&)>;
  Status LoadStyles(StyleRequest request, const std::string& choose_by, const Choose& choose);
  Expected<Choice> ChooseStep(const BudgetRequest& budget, SceneRequest scene, PictureRequest asked, StyleSet& set);
  void KeepPrepared();
  void CloseStylesOfScene();
  Status LoadScene(SceneRequest request, std::optional<int> frame);
  Status Pose(const SceneRequest& request, std::optional<int> frame, const LayersFor& layers_for);
  Expected<StaticScene> PoseNext(const SceneRequest& request, int frame) const;
  Status Cast(SceneRequest request, std::optional<int> frame, const LayersFor& layers_for, const Progress& progress);
  Expected<PaintedFrame> Paint(SceneRequest scene, const StyleRequest& style, PictureRequest picture,
                               BudgetRequest budget);
  Expected<SceneDescription> Describe(const SceneRequest& scene, std::optional<int> frame);
  Expected<SceneSphere> SphereSeen(std::optional<int> frame);
};

Status Workspace::State::LoadStyles(StyleRequest request, const std::string& choose_by, const Choose& choose) {
  if (styles && AreSame(request, styles->options) && choose_by == choice_text && style_stamps == StyleStamps(*styles)) {
    return Ok();
  }
  const StyleRoom room = RoomForStyles(context);
  request.reading = {room, [this, room](const std::filesystem::path& file) -> Expected<Picture> {
                       const std::size_t kept = pictures.bytes();
                       SCUMBLE_ASSIGN(Picture decoded, pictures.Read(file));
                       if (pictures.bytes() > kept) SCUMBLE_RETURN_IF_ERROR(room(pictures.bytes() - kept));
                       return decoded;
                     }};
  const auto begun = std::chrono::system_clock::now();
  const FileStamps before = StampsNow(style_stamps);
  SCUMBLE_ASSIGN(StyleSet loaded, OpenStyles(request, context));
  pictures.ForgetUnread();
  ++counters.styles_loaded;
  SCUMBLE_ASSIGN(choice, choose(loaded));
  if (!replaced) replaced = std::move(styles);
  styles = std::move(loaded), choice_text = choose_by, style_stamps = StampsAsRead(*styles, before, begun);
  picture.exposure.reset(), picture.finish_measures.reset(), picture.hashes.clear(), picture.warned = false;
  return Ok();
}

Expected<Workspace::State::Choice> Workspace::State::ChooseStep(const BudgetRequest& budget, SceneRequest scene,
                                                                PictureRequest asked, StyleSet& set) {
  scene.more_memory = [&, before = asked](const Size& guides_size, const LayerSet& layers, MemoryNeed& need) {
    AddPicture(WorkOf(set, before, guides_size, layers, FragmentsExpected(guides_size, scene.aa), false, context),
               before, need);
  };
  Choice chosen;
  SCUMBLE_ASSIGN(chosen.made, ChooseForScene(budget, scene, asked.frame, asked.over, set, asked, context));
  chosen.upsample = asked.upsample, chosen.upscale = asked.upscale;
  chosen.samples = scene.samples, chosen.samples_given = scene.samples_given;
  return chosen;
}

// Of new styles, the scene's included, keeps what is prepared as far as it is of the same paint.
void Workspace::State::KeepPrepared() {
  if (!replaced) return;
  std::vector<PreparedStyle>& prepared = picture.prepared;
  std::size_t kept = 0;
  const std::size_t most = std::min({prepared.size(), replaced->styles.size(), styles->styles.size()});
  while (kept < most && SharesExemplars(replaced->styles[kept], styles->styles[kept])) {
    prepared[kept].settings = styles->styles[kept].transfer;
    prepared[kept].required = scumble::RequiredLayers(styles->styles[kept]);
    ++kept;
  }
  prepared.resize(kept);
  replaced.reset();
}

Status Workspace::State::LoadScene(SceneRequest request, std::optional<int> frame) {
  const bool blender = IsBlenderScene(request.scene);
  std::string text = request.scene + "\n" + request.animation + "\n";
  if (blender) {
    text += fmt::format("{} {} {}\n{}\n{}\n", frame ? std::to_string(*frame) : "", request.blender.program,
                        request.view.has_value(), request.blender.scene, request.blender.view_layer);
  } else if (request.auto_smooth_degrees) {
    text += fmt::format("auto smooth {}\n", *request.auto_smooth_degrees);
  }
  if (text == scene_key && scene_stamps == StampsNow(scene_stamps)) return Ok();
  scene_key.clear(), pose_key.clear(), guides_key.clear();
  rays.reset(), animation.reset(), posed.reset(), sphere_at_rest.reset(), sphere_at_start.reset();
  texture_warnings.clear(), scene_stamps.clear();
  // Before a file is read: one that changes meanwhile is read again. Blender has read what it tells of.
  request.on_file = [this](const std::filesystem::path& file) {
    scene_stamps.try_emplace(file.string(), StampOf(file.string()));
  };
  if (!blender) {
    SCUMBLE_ASSIGN(animation, AnimatedScene::Load(request.scene, {request.animation, LoadOptionsOf(request)}));
    PassOnNotes(animation->rest(), request.scene, context);
  } else {
    // Blender's scene is posed as it is loaded; how it is seen is decided again in Pose.
    const LayersFor none = [](const SceneStyleRequests&) -> Expected<LayerSet> { return LayerSet(); };
    SCUMBLE_ASSIGN(posed, OpenSceneAt(frame, request, none, context));
    own_lights = OwnLights::Of(posed->scene);
  }
  ++counters.scenes_loaded;
  scene_key = text;
  CloseStylesOfScene();
  return Ok();
}

void Workspace::State::CloseStylesOfScene() {
  if (!styles || styles->wanted.empty()) return;
  CloseSceneStyles(*styles);
  styles->options.reading.room = RoomForStyles(context);
  const FileStamps left = StyleStamps(*styles);
  std::erase_if(style_stamps, [&](const auto& one) { return !left.count(one.first); });
  if (!replaced) picture.prepared.resize(std::min(picture.prepared.size(), styles->styles.size()));
  picture.hashes.clear(), picture.warned = false;
}

Status Workspace::State::Pose(const SceneRequest& request, std::optional<int> frame, const LayersFor& layers_for) {
  const Scene& names = animation ? animation->rest() : posed->scene;
  SCUMBLE_ASSIGN(const LayerSet layers,
                 layers_for(SceneStyleRequestsOf(animation ? animation->objects() : names.instances, names)));
  const std::string fps = request.fps ? FrameRateToText(*request.fps) : "";
  const std::string key =
      fmt::format("{} {}; {}; {}; {}", frame ? std::to_string(*frame) : "rest", fps, request.camera,
                  request.view ? ViewToText(*request.view) : "", double(request.size.width) / request.size.height);
  // A light is added where a layer needs light: the other layers are the same with it and without.
  const std::string light = fmt::format("{}; {}", NeedsKeyLight(request, layers),
                                        ReplacesLights(request, layers) ? LightToText(*request.light) : "");
  const bool stands = key == pose_key;
  if (stands && light == light_key) {
    posed->layers = layers;
    return Ok();
  }
  pose_key.clear();
  if (!stands) rays.reset();  // lights may change under it
  if (!animation) {
    SCUMBLE_RETURN_IF_ERROR(ViewAgain(*posed, own_lights, request, layers));
  } else {
    const LayersFor known = [&](const SceneStyleRequests&) -> Expected<LayerSet> { return layers; };
    SCUMBLE_ASSIGN(StaticScene now, PoseScene(*animation, frame, request, known, context));
    if (stands) {
      posed->view = std::move(now.view);
      posed->scene.lights = std::move(now.scene.lights);
      posed->scene.world_radiance = now.scene.world_radiance;
      posed->scene.has_own_lights = now.scene.has_own_lights;
      posed->layers = layers, pose_key = key, light_key = light;
      return Ok();
    }
    if (posed) {  // textures that were decoded stay decoded, and materials do without those that were left out
      now.scene.materials = std::move(posed->scene.materials);
      now.scene.textures = std::move(posed->scene.textures);
      now.scene.encoded_textures = std::move(posed->scene.encoded_textures);
    }
    posed = std::move(now);
  }
  posed->layers = layers, pose_key = key, light_key = light;
  return Ok();
}

// The frame after this one, which the layer motion is measured against: its shapes and its camera alone. Of a .blend
// Blender exports it.
Expected<StaticScene> Workspace::State::PoseNext(const SceneRequest& request, int frame) const {
  const int after = frame < kMaxFrame ? frame + 1 : frame;
  const RunContext silent = context.WithoutNotes();
  const LayersFor known = [&](const SceneStyleRequests&) -> Expected<LayerSet> { return posed->layers; };
  SCUMBLE_ASSIGN(StaticScene next, animation ? PoseScene(*animation, after, request, known, silent)
                                             : OpenSceneAt(after, request, known, silent, false));
  next.scene.textures.clear(), next.scene.encoded_textures.clear();
  return next;
}

Status Workspace::State::Cast(SceneRequest request, std::optional<int> frame, const LayersFor& layers_for,
                              const Progress& progress) {
  request.more_memory = [&, more = request.more_memory](const Size& size, const LayerSet& layers, MemoryNeed& need) {
    guides_memory = need;
    if (more) more(size, layers, need);
  };
  SCUMBLE_RETURN_IF_ERROR(LoadScene(request, frame));
  SCUMBLE_RETURN_IF_ERROR(context.CheckNotCancelled());
  SCUMBLE_RETURN_IF_ERROR(Pose(request, frame, layers_for));
  SceneRequest unlit = request;
  unlit.light.reset(), unlit.seed = 0, unlit.samples = 0, unlit.samples_given = true;
  const std::string key =
      fmt::format("{}; {}; isa {}; half {}; time {}; {}", SizeToText(request.size), GuideSettings(unlit), request.isa,
                  request.half, request.time_budget_seconds, pose_key);
  const std::string lit_key = fmt::format("{}; {}", GuideSettings(request), request.key_light);
  if (guides && key == guides_key && guides->guides.layers().Contains(posed->layers)) {
    if (lit_key == guides_light_key) return Ok();
    if (!DependOnLight(guides->guides.layers())) {
      auto same = std::make_shared<SceneGuides>(*guides);
      StoreSettings(request, same->guides);
      guides = std::move(same), guides_light_key = lit_key;
      return Ok();
    }
  }
  guides_key.clear();
  std::optional<StaticScene> following;
  if (frame && posed->layers.Has(Layer::kMotion)) {
    SCUMBLE_ASSIGN(following, PoseNext(request, *frame));
    SCUMBLE_RETURN_IF_ERROR(context.CheckNotCancelled());
  }
  const auto next = following ? std::optional(NextFrame{following->scene, following->view.camera}) : std::nullopt;
  SCUMBLE_ASSIGN(SceneGuides made, CastScene({posed->scene, posed->view.camera, next ? &*next : nullptr, &rays},
                                             request, posed->layers, context, progress));
  ++counters.guides_cast;
  counters.structures_built += std::size_t(made.builds);
  const std::vector<std::string>& told = made.cost.texture_warnings;
  texture_warnings.insert(texture_warnings.end(), told.begin(), told.end());
  StoreFrameRate(request, posed->animation, made.guides);
  SCUMBLE_RETURN_IF_ERROR(made.guides.Validate(request.scene));
  guides = std::make_shared<const SceneGuides>(std::move(made));
  guides_key = key, guides_light_key = lit_key;
  picture.exposure.reset(), picture.finish_measures.reset();  // they are measured on the guides
  return Ok();
}

Expected<PaintedFrame> Workspace::State::Paint(SceneRequest scene, const StyleRequest& style, PictureRequest request,
                                               BudgetRequest budget) {
  scene.seed = request.seed, scene.fps = request.fps;
  SCUMBLE_RETURN_IF_ERROR(CheckPictureRequest(request));
  SCUMBLE_ASSIGN(scene.size, GuideSizeFor(scene.size, request.upsample));
  const Progress progress = context.StartProgress("stylize");
  SCUMBLE_RETURN_IF_ERROR(CheckArguments(scene, request.frame));
  budget.guides_are_fixed = budget.guides_are_fixed || request.upsample > 1;
  if (budget.chooses() && !budget.quality) SCUMBLE_RETURN_IF_ERROR(LoadScene(scene, request.frame));
  SCUMBLE_RETURN_IF_ERROR(LoadStyles(style, ChoiceText(budget, scene, request, scene_stamps),
                                     [&](StyleSet& set) { return ChooseStep(budget, scene, request, set); }));
  if (choice.made) {
    scene.samples = choice.samples, scene.samples_given = choice.samples_given;
    request.upscale = choice.upscale;
    if (const int before = std::exchange(request.upsample, choice.upsample); before != choice.upsample) {
      SCUMBLE_ASSIGN(scene.size, GuideSizeFor(scene.size, request.upsample));
    }
  }
  scene.more_memory = [&](const Size& size, const LayerSet& layers, MemoryNeed& need) {
    AddPicture(WorkOf(*styles, request, size, layers, FragmentsExpected(size, scene.aa), false, context), request,
               need);
  };
  const LayersFor layers_for = [&](const SceneStyleRequests& of_scene) -> Expected<LayerSet> {
    const std::size_t opened = styles->opened.size();
    const auto begun = std::chrono::system_clock::now();
    const Expected<LayerSet> layers = RequiredLayers(*styles, of_scene, scene.scene);
    if (styles->opened.size() > opened)
      style_stamps.merge(StampsAsRead(*styles, {}, begun));  // which knows the others already
    return layers;
  };
  SCUMBLE_RETURN_IF_ERROR(Cast(scene, request.frame, layers_for, Within(progress, 0.0, 0.5)));
  SCUMBLE_RETURN_IF_ERROR(context.CheckNotCancelled());
  MemoryNeed memory = guides_memory;
  scene.more_memory(scene.size, guides->guides.layers(), memory);
  SCUMBLE_RETURN_IF_ERROR(CheckMemory(memory, context, "take a smaller --size, or smaller exemplars"));
  KeepPrepared();
  if (request.exposure || exposure_given) picture.exposure.reset();
  exposure_given = request.exposure.has_value();
  picture.width = picture.height = 0;  // another size is no mistake here
  if (const std::string stamp = StampOf(request.over); stamp != over_stamp) picture.over.reset(), over_stamp = stamp;
  std::vector<std::shared_ptr<const PreparedExemplar>> before;
  for (const PreparedStyle& one : picture.prepared) before.push_back(one.exemplar);
  const GuideSource source{scene.scene, guides->times, guides->plan, guides->cost, memory};
  picture.palette_colors = {};  // they are measured on the paint
  SCUMBLE_ASSIGN(PaintedPicture painted,
                 PaintInMemory(*styles, guides->guides, source, request, context, Within(progress, 0.5, 1.0), picture));
  for (std::size_t i = 0; i < picture.prepared.size(); ++i) {
    counters.styles_prepared += i >= before.size() || before[i] != picture.prepared[i].exemplar;
  }
  ++counters.frames_painted;
  return PaintedFrame{std::move(painted.picture),
                      std::shared_ptr<const GuideSet>(guides, &guides->guides),
                      std::move(painted.report),
                      std::move(painted.write),
                      std::move(painted.kept.field),
                      std::move(painted.kept.styles),
                      std::move(painted.kept.field_styles),
                      choice.made};
}

// Of the moment at which it is decided how a scene is framed.
Expected<SceneSphere> Workspace::State::SphereSeen(std::optional<int> frame) {
  if (!animation) return SphereAround(posed->animation.start ? *posed->animation.start : posed->scene);
  std::optional<SceneSphere>& sphere = frame ? sphere_at_start : sphere_at_rest;
  if (sphere) return *sphere;
  if (frame && animation->moves()) {
    SCUMBLE_ASSIGN(const Scene start, animation->SceneAt(0.0));
    sphere = SphereAround(start);
  } else {
    sphere = SphereAround(animation->rest());
  }
  return *sphere;
}

Expected<SceneDescription> Workspace::State::Describe(const SceneRequest& scene, std::optional<int> frame) {
  SCUMBLE_RETURN_IF_ERROR(CheckSceneRequest(scene));
  SCUMBLE_RETURN_IF_ERROR(LoadScene(scene, frame));
  // What is posed for the layers of the last picture stays so.
  const LayersFor layers_for = [known = posed ? posed->layers : LayerSet()](const SceneStyleRequests&) {
    return Expected<LayerSet>(known);
  };
  SCUMBLE_RETURN_IF_ERROR(Pose(scene, frame, layers_for));
  SceneDescription description;
  const Scene& names = animation ? animation->rest() : posed->scene;
  NameList cameras, objects, materials;
  for (const Camera& camera : names.cameras) cameras.Add(camera.name);
  for (const Instance& instance : animation ? animation->objects() : names.instances) {
    objects.Add(instance.object);
    materials.Add(names.materials[std::size_t(names.meshes[std::size_t(instance.mesh)].material)].name);
  }
  description.cameras = cameras.Take(), description.objects = objects.Take(), description.materials = materials.Take();
  description.lights = animation ? names.lights.size() : own_lights.lights.size();
  const BlenderAnimation& blender = posed->animation;
  FrameRate rate = scene.fps.value_or(FrameRate());
  if (const auto told = ParseFrameRate(blender.fps); told && !scene.fps) rate = *told;
  const double fps = double(rate.numerator) / double(rate.denominator);
  if (!animation && blender.last > blender.first) {
    description.animation = FrameSpan{blender.first, blender.last, fps, blender.saved};
  }
  if (animation && animation->moves()) {
    const double last = std::ceil(animation->duration_seconds() * fps - 1e-6);
    description.animation = FrameSpan{0, int(std::clamp(last, 0.0, double(kMaxFrame))), fps, std::nullopt};
  }
  SCUMBLE_ASSIGN(const SceneSphere sphere, SphereSeen(frame));
  description.eye = OrbitOf(sphere, posed->view.camera, double(scene.size.width) / scene.size.height);
  description.style_requests = SceneStyleRequestsOf(animation ? animation->objects() : names.instances, names);
  for (const auto& [path, stamp] : style_stamps) description.style_files.push_back(path);
  for (const auto* warnings : {&names.warnings, &std::as_const(texture_warnings)}) {
    for (const std::string& warning : *warnings) description.warnings.push_back(scene.scene + ": " + warning);
  }
  return description;
}

Workspace::Workspace(RunContext context) : state_(std::make_unique<State>(std::move(context))) {}
Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;

Expected<PaintedFrame> Workspace::Paint(const SceneRequest& scene, const StyleRequest& style,
                                        const PictureRequest& picture, const BudgetRequest& budget) {
  const State::Running running(*state_);
  return state_->Paint(scene, style, picture, budget);
}

Expected<SceneDescription> Workspace::Describe(const SceneRequest& scene, std::optional<int> frame) {
  const State::Running running(*state_);
  return state_->Describe(scene, frame);
}

Expected<std::shared_ptr<const GuideSet>> Workspace::Guides(const SceneRequest& scene, std::optional<int> frame,
                                                            const LayerSet& layers) {
  const State::Running running(*state_);
  SCUMBLE_RETURN_IF_ERROR(CheckArguments(scene, frame, layers.Has(Layer::kMotion)));
  const LayersFor layers_for = [&](const SceneStyleRequests&) -> Expected<LayerSet> { return layers; };
  SCUMBLE_RETURN_IF_ERROR(state_->Cast(scene, frame, layers_for, state_->context.StartProgress("guides")));
  return std::shared_ptr<const GuideSet>(state_->guides, &state_->guides->guides);
}

void Workspace::Cancel() {
  State::Call runs = State::Call::kRuns;
  state_->call.compare_exchange_strong(runs, State::Call::kCancelled);
}

std::vector<std::string> Workspace::SceneFiles() const {
  std::vector<std::string> files;
  for (const auto& [path, stamp] : state_->scene_stamps) files.push_back(path);
  return files;
}

WorkspaceCounters Workspace::counters() const {
  WorkspaceCounters counters = state_->counters;
  counters.pictures_decoded = state_->pictures.decoded();
  return counters;
}

}  // namespace scumble
