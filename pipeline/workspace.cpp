#include "pipeline/workspace.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <utility>
#include <vector>

#include "core/image/stopwatch.h"
#include "pipeline/frame/paint_picture.h"
#include "pipeline/frame/provenance.h"
#include "pipeline/scene/run_inputs.h"
#include "pipeline/scene/scene_guides.h"
#include "pipeline/scene/scene_sequence.h"
#include "pipeline/style/style_set.h"

namespace scumble {
namespace {

// Size and time of a file's last change, as text; "gone" where it is not there.
std::string StampOf(const std::string& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return path + " gone";
  return fmt::format("{} {} {} {}.{}", path, file.st_ino, file.st_size, file.st_mtim.tv_sec, file.st_mtim.tv_nsec);
}

std::string StampsOf(const std::vector<std::string>& paths) {
  std::string text;
  for (const std::string& path : paths) text += StampOf(path) + "\n";
  return text;
}

std::string SceneStamps(const std::string& scene) {
  RunInputs files;
  files.ReadsScene(scene);
  return StampsOf(files.Inputs());
}

std::string StyleStamps(const StyleSet& styles) {
  RunInputs files;
  files.ReadsStyles(styles);
  std::vector<std::string> paths = files.Inputs();
  for (const auto& [path, place] : styles.opened) paths.push_back(path);
  for (const std::string& one : styles.options.assigned) {
    if (one.size() > 1 && one.front() == '@') paths.push_back(one.substr(1));
  }
  return StampsOf(paths);
}

std::string TextOf(const StyleRequest& request) {
  return fmt::format("{}\n{}\n{}\n{}", request.style, fmt::join(request.sets, "\n"), fmt::join(request.assigned, "\n"),
                     request.scene_styles);
}

// Whether exemplars that were prepared for one style serve another: they have the same paint, and their settings differ
// only where a transfer reads them from the style frame by frame.
bool SharesExemplars(Style a, const Style& b) {
  if (HashOfPaint(a) != HashOfPaint(b) || a.transfer.edge != b.transfer.edge) return false;
  a.transfer.threshold = b.transfer.threshold, a.transfer.threshold_metric = b.transfer.threshold_metric;
  a.transfer.jitter = b.transfer.jitter, a.transfer.jitter_fps = b.transfer.jitter_fps;
  a.transfer.coherent = b.transfer.coherent, a.transfer.variety = b.transfer.variety;
  a.transfer.crease = b.transfer.crease, a.transfer.depth_tolerance = b.transfer.depth_tolerance;
  a.transfer.match_step = b.transfer.match_step;
  return TextOf(a.transfer) == TextOf(b.transfer);
}

}  // namespace

struct Workspace::State {
  explicit State(RunContext given) : context(std::move(given)), outer_progress(context.on_progress) {
    context.on_progress = [this](const std::string& label) -> Progress {
      return [this, next = outer_progress ? outer_progress(label) : Progress()](double share) {
        return !cancelled && (!next || next(share));
      };
    };
  }

  RunContext context;
  std::function<Progress(const std::string&)> outer_progress;
  std::atomic<bool> working = false, cancelled = false;
  WorkspaceCounters counters;

  // The scene: loaded, then posed and seen.
  std::string scene_key;
  std::optional<AnimatedScene> animation;  // none: the scene is Blender's
  std::string seen_key, pose_key;          // when and from where it is seen; the same with its light
  std::optional<StaticScene> posed;
  std::optional<RayScene> rays;  // of `posed`, which it borrows
  std::size_t own_lights = 0;    // of `posed`, before a key light was added
  std::string guides_key;
  std::shared_ptr<const SceneGuides> guides;

  // The styles, and what was prepared of them.
  std::string style_text, style_stamps;
  std::optional<StyleSet> styles;
  PictureState picture;
  bool exposure_given = false;  // by the last request, not measured

  Status Continue() const { return cancelled ? Status(CancelledError()) : Ok(); }
  Status LoadStyles(const StyleRequest& request);
  Status LoadScene(const SceneRequest& request, std::optional<int> frame);
  Status Pose(const SceneRequest& request, std::optional<int> frame, const LayersFor& layers_for);
  Status Cast(const SceneRequest& request, std::optional<int> frame, const LayersFor& layers_for,
              const Progress& progress);
  Expected<PaintedFrame> Paint(SceneRequest scene, const StyleRequest& style, const PictureRequest& picture);
};

Status Workspace::State::LoadStyles(const StyleRequest& request) {
  const std::string text = TextOf(request);
  if (styles && text == style_text && style_stamps == StyleStamps(*styles)) return Ok();
  SCUMBLE_ASSIGN(StyleSet loaded, OpenStyles(request, context));
  ++counters.styles_loaded;
  if (styles && picture.prepared.size() >= styles->styles.size() && loaded.styles.size() == styles->styles.size()) {
    std::vector<PreparedStyle> kept;
    for (std::size_t i = 0; i < loaded.styles.size(); ++i) {
      if (!SharesExemplars(styles->styles[i], loaded.styles[i])) break;
      kept.push_back(picture.prepared[i]);
      kept.back().settings = loaded.styles[i].transfer;
      kept.back().required = scumble::RequiredLayers(loaded.styles[i]);
    }
    picture.prepared = std::move(kept);
  } else {
    picture.prepared.clear();
  }
  picture.exposure.reset(), picture.hashes.clear(), picture.warned = false;
  styles = std::move(loaded), style_text = text, style_stamps = StyleStamps(*styles);
  return Ok();
}

Status Workspace::State::LoadScene(const SceneRequest& request, std::optional<int> frame) {
  SCUMBLE_RETURN_IF_ERROR(CheckSceneRequest(request));
  std::string key = request.scene + "\n" + request.animation + "\n" + SceneStamps(request.scene);
  const bool blender = IsBlenderScene(request.scene);
  if (blender) {
    key +=
        fmt::format("{} {} {}", frame ? std::to_string(*frame) : "", request.blender.program, request.view.has_value());
  }
  if (key == scene_key) return Ok();
  scene_key.clear(), pose_key.clear(), guides_key.clear();
  rays.reset(), animation.reset(), posed.reset();
  if (!blender) {
    SCUMBLE_ASSIGN(animation, AnimatedScene::Load(request.scene, {request.animation, TextureLoading::kWhenNeeded}));
    for (const std::string& warning : animation->rest().warnings) context.Warn(request.scene + ": " + warning);
  } else {
    // Blender's scene is posed as it is loaded; how it is seen is decided again in Pose.
    const LayersFor none = [](const SceneStyleRequests&) -> Expected<LayerSet> { return LayerSet(); };
    SCUMBLE_ASSIGN(posed, OpenSceneAt(frame, request, none, context));
    own_lights = posed->scene.lights.size();
  }
  ++counters.scenes_loaded;
  scene_key = key;
  return Ok();
}

Status Workspace::State::Pose(const SceneRequest& request, std::optional<int> frame, const LayersFor& layers_for) {
  const Scene& names = animation ? animation->rest() : posed->scene;
  SCUMBLE_ASSIGN(const LayerSet layers,
                 layers_for(SceneStyleRequestsOf(animation ? animation->objects() : names.instances, names)));
  const std::string fps = request.fps ? FrameRateToText(*request.fps) : "";
  seen_key = fmt::format("{} {}; {}; {}; {}; {}", frame ? std::to_string(*frame) : "rest", fps, request.camera,
                         request.view ? ViewToText(*request.view) : "",
                         double(request.size.width) / request.size.height, request.key_light);
  // A key light is added where a layer needs light: the other layers are the same with it and without.
  const std::string key = fmt::format("{}; {}", seen_key, NeedsKeyLight(request, layers));
  if (key == pose_key) {
    posed->layers = layers;
    return Ok();
  }
  pose_key.clear(), rays.reset();
  if (!animation) {
    SCUMBLE_RETURN_IF_ERROR(ViewAgain(*posed, own_lights, request, layers));
  } else {
    const LayersFor known = [&](const SceneStyleRequests&) -> Expected<LayerSet> { return layers; };
    SCUMBLE_ASSIGN(StaticScene now, PoseScene(*animation, frame, request, known, context, false));
    if (posed) {  // textures that were decoded stay decoded
      now.scene.textures = std::move(posed->scene.textures);
      now.scene.encoded_textures = std::move(posed->scene.encoded_textures);
    }
    posed = std::move(now);
  }
  posed->layers = layers;
  pose_key = key;
  return Ok();
}

Status Workspace::State::Cast(const SceneRequest& request, std::optional<int> frame, const LayersFor& layers_for,
                              const Progress& progress) {
  if (!frame && !request.animation.empty()) {
    return UsageError(
        "--animation plays with the frames' numbers: give --frame N, or --frames for several where the "
        "verb has it");
  }
  SCUMBLE_RETURN_IF_ERROR(LoadScene(request, frame));
  SCUMBLE_RETURN_IF_ERROR(Continue());
  SCUMBLE_RETURN_IF_ERROR(Pose(request, frame, layers_for));
  const std::string key =
      fmt::format("{}; {}; isa {}; half {}; time {}; {}", SizeToText(request.size), GuideSettings(request), request.isa,
                  request.half, request.time_budget_seconds, seen_key);
  if (guides && key == guides_key && guides->guides.layers().Contains(posed->layers)) return Ok();
  guides_key.clear();
  if (!rays) {
    SCUMBLE_ASSIGN(rays, RayScene::Make(posed->scene, posed->view.camera));
  }
  SCUMBLE_ASSIGN(SceneGuides made, CastScene(posed->scene, posed->view.camera, nullptr, request, posed->layers, context,
                                             progress, false, &*rays));
  ++counters.guides_cast;
  counters.structures_built += std::size_t(made.builds);
  StoreFrameRate(request, posed->animation, made.guides);
  SCUMBLE_RETURN_IF_ERROR(made.guides.Validate(request.scene));
  guides = std::make_shared<const SceneGuides>(std::move(made));
  guides_key = key;
  picture.exposure.reset();  // it is measured on the guides
  return Ok();
}

Expected<PaintedFrame> Workspace::State::Paint(SceneRequest scene, const StyleRequest& style,
                                               const PictureRequest& request) {
  scene.seed = request.seed, scene.fps = request.fps;
  SCUMBLE_ASSIGN(scene.size, GuideSizeFor(scene.size, request.upsample));
  const Progress progress = context.StartProgress("stylize");
  SCUMBLE_RETURN_IF_ERROR(LoadStyles(style));
  SCUMBLE_RETURN_IF_ERROR(Continue());
  const LayersFor layers_for = [&](const SceneStyleRequests& wishes) {
    return RequiredLayers(*styles, wishes, scene.scene);
  };
  SCUMBLE_RETURN_IF_ERROR(Cast(scene, request.frame, layers_for, Within(progress, 0.0, 0.5)));
  SCUMBLE_RETURN_IF_ERROR(Continue());
  if (request.exposure || exposure_given) picture.exposure.reset();
  exposure_given = request.exposure.has_value();
  picture.width = picture.height = 0;  // another size is no mistake here
  std::vector<std::shared_ptr<const PreparedExemplar>> before;
  for (const PreparedStyle& one : picture.prepared) before.push_back(one.exemplar);
  const GuideSource source{scene.scene, guides->times, guides->plan, guides->cost, guides->memory};
  SCUMBLE_ASSIGN(PaintedPicture painted,
                 PaintInMemory(*styles, guides->guides, source, request, context, Within(progress, 0.5, 1.0), picture));
  for (std::size_t i = 0; i < picture.prepared.size(); ++i) {
    counters.styles_prepared += i >= before.size() || before[i] != picture.prepared[i].exemplar;
  }
  ++counters.frames_painted;
  return PaintedFrame{std::move(painted.picture), std::shared_ptr<const GuideSet>(guides, &guides->guides),
                      std::move(painted.report)};
}

Workspace::Workspace(RunContext context) : state_(std::make_unique<State>(std::move(context))) {}
Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;

namespace {

// Accepts calls to Cancel while it lives.
class Working {
 public:
  Working(std::atomic<bool>& working, std::atomic<bool>& cancelled) : working_(working) {
    cancelled = false;
    working_ = true;
  }
  ~Working() { working_ = false; }
  Working(const Working&) = delete;
  Working& operator=(const Working&) = delete;

 private:
  std::atomic<bool>& working_;
};

}  // namespace

Expected<PaintedFrame> Workspace::Paint(const SceneRequest& scene, const StyleRequest& style,
                                        const PictureRequest& picture) {
  const Working working(state_->working, state_->cancelled);
  return state_->Paint(scene, style, picture);
}

Expected<std::shared_ptr<const GuideSet>> Workspace::Guides(const SceneRequest& scene, std::optional<int> frame,
                                                            const LayerSet& layers) {
  const Working working(state_->working, state_->cancelled);
  const LayersFor layers_for = [&](const SceneStyleRequests&) -> Expected<LayerSet> { return layers; };
  SCUMBLE_RETURN_IF_ERROR(state_->Cast(scene, frame, layers_for, state_->context.StartProgress("guides")));
  return std::shared_ptr<const GuideSet>(state_->guides, &state_->guides->guides);
}

void Workspace::Cancel() {
  if (state_->working) state_->cancelled = true;
}

WorkspaceCounters Workspace::counters() const { return state_->counters; }

}  // namespace scumble
