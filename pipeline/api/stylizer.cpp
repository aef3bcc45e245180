// The library's Stylizer, over a Workspace.
#include "scumble/stylizer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>
#include <utility>

#include "pipeline/api/guide_layers.h"
#include "pipeline/workspace.h"

namespace scumble {
namespace {

// What the pipeline calls by the command line's options, and the members that set it.
constexpr std::pair<std::string_view, std::string_view> kMembers[] = {
    {"--size", "width and height"},
    {"--camera", "camera"},
    {"--view", "view"},
    {"--light", "light"},
    {"--frame", "frame"},
    {"--fps", "frames_per_second"},
    {"--animation", "animation"},
    {"--scene", "blender_scene"},
    {"--view-layer", "view_layer"},
    {"--auto-smooth", "auto_smooth"},
    {"--aa", "coverage_samples"},
    {"--samples", "light_samples"},
    {"--raw-normals", "raw_normals"},
    {"--isa", "instruction_set"},
    {"--style", "style"},
    {"--set", "overrides"},
    {"--assign", "assignments"},
    {"--finish", "finishes"},
    {"--no-scene-styles", "follow_scene = false"},
    {"--seed", "seed"},
    {"--exposure", "exposure"},
    {"--upsample", "upsample"},
    {"--upscale", "upscale"},
    {"--threads", "threads"},
    {"--blender", "PATH in environment"},
    {"--max-memory", "max_memory"},
};

// A message with members in place of options.
std::string WithMembers(std::string text) {
  if (text.starts_with("isa \"")) text.replace(0, 3, "instruction_set");
  for (std::size_t at = text.find("--"); at != std::string::npos; at = text.find("--", at + 1)) {
    const std::size_t end = std::min(text.find_first_not_of("abcdefghijklmnopqrstuvwxyz-", at), text.size());
    const std::string_view option(text.data() + at, end - at);
    const auto is_it = [&](const auto& one) { return one.first == option; };
    const auto found = std::find_if(std::begin(kMembers), std::end(kMembers), is_it);
    const bool begins = at == 0 || std::string_view(" '(`").find(text[at - 1]) != std::string_view::npos;
    if (begins && found != std::end(kMembers)) text.replace(at, option.size(), found->second);
  }
  return text;
}

template <class T>
Expected<T> WithMembers(Expected<T> result) {
  if (result) return result;
  return Error{result.error().kind, WithMembers(result.error().message)};
}

RunContext ContextOf(const StylizerOptions& options) {
  RunContext context;
  context.threads = options.threads;
  context.max_memory = options.max_memory;
  context.cache_folder = options.cache_folder;
  context.environment = options.environment;
  context.temporary_folder = options.temporary_folder;
  if (!options.data_folder.empty()) {
    context.data_roots.emplace_back(options.data_folder);
    internal::UseDataFolder(options.data_folder.c_str());
  }
  if (options.message) {
    context.on_message = [tell = options.message](const Message& message) {
      tell(WithMembers(message.text), message.kind == Message::Kind::kWarning);
    };
  }
  if (options.progress) {
    context.on_progress = [progress = options.progress](const std::string&) { return progress; };
  }
  return context;
}

// The error of a member of settings, by its whole name.
Status CheckedMember(const char* settings, const Status& checked) {
  if (checked.ok()) return checked;
  return Error{checked.error().kind, std::string(settings) + "." + checked.error().message};
}

Status CheckWithin(const char* member, int value, int least, int most) {
  if (value >= least && value <= most) return Ok();
  return UsageError(fmt::format("{} {} is out of range; expected {} to {}", member, value, least, most));
}

Expected<SceneRequest> RequestOf(const SceneSettings& settings) {
  SceneRequest request;
  request.scene = settings.file;
  request.size = {settings.width, settings.height};
  SCUMBLE_RETURN_IF_ERROR(CheckWithin("width", settings.width, 1, kMaxImageSide));
  SCUMBLE_RETURN_IF_ERROR(CheckWithin("height", settings.height, 1, kMaxImageSide));
  SCUMBLE_RETURN_IF_ERROR(CheckSize(request.size, SizeToText(request.size)));
  request.camera = settings.camera;
  if (const auto& view = settings.view) {
    request.view = ViewAngles{view->azimuth, view->elevation, view->distance, view->right, view->up, view->fov};
    SCUMBLE_RETURN_IF_ERROR(CheckedMember("view", CheckView(*request.view)));
  }
  if (const auto& light = settings.light) {
    request.light = LightAngles{light->azimuth, light->elevation};
    SCUMBLE_RETURN_IF_ERROR(CheckedMember("light", CheckLight(*request.light)));
  }
  request.animation = settings.animation;
  if (const std::optional<double>& degrees = settings.auto_smooth; degrees && !(*degrees >= 0.0 && *degrees <= 180.0)) {
    return UsageError(fmt::format("auto_smooth {} is out of range; expected 0 to 180 degrees", *degrees));
  }
  request.auto_smooth_degrees = settings.auto_smooth;
  request.blender.frame = settings.frame;
  request.blender.scene = settings.blender_scene, request.blender.view_layer = settings.view_layer;
  if (settings.frames_per_second != 0.0) {
    const double fps = settings.frames_per_second;
    if (!(fps >= 0.001 && fps <= 1e5)) {
      return UsageError(fmt::format("frames_per_second {} is out of range; expected 0.001 to 100000, or 0", fps));
    }
    request.fps = NearestFrameRate(fps);
  }
  SCUMBLE_RETURN_IF_ERROR(CheckWithin("coverage_samples", settings.coverage_samples, 1, 16));
  request.aa = settings.coverage_samples;
  SCUMBLE_RETURN_IF_ERROR(CheckWithin("light_samples", settings.light_samples, 0, kMaxSamples));
  if (settings.light_samples != 0) request.samples = settings.light_samples, request.samples_given = true;
  request.isa = settings.instruction_set;
  request.raw_normals = settings.raw_normals;
  return request;
}

}  // namespace

struct Stylizer::State {
  explicit State(const StylizerOptions& options) : workspace(ContextOf(options)) {}
  Expected<Picture> Paint(const SceneSettings& scene, const StyleSettings& style, const PaintSettings& paint);
  Expected<GuideLayers> Guides(const SceneSettings& scene, const LayerSet& layers);
  Workspace workspace;
};

Expected<Picture> Stylizer::State::Paint(const SceneSettings& scene, const StyleSettings& style,
                                         const PaintSettings& paint) {
  SCUMBLE_ASSIGN(const SceneRequest request, RequestOf(scene));
  if (paint.exposure && !(std::fabs(*paint.exposure) <= 64.0)) {
    return UsageError(fmt::format("exposure {} is out of range; expected -64 to 64 stops", *paint.exposure));
  }
  StyleRequest style_request;
  style_request.style = style.style;
  SCUMBLE_ASSIGN(style_request.sets, ParseStyleOverrides(style.overrides));
  style_request.assigned = style.assignments, style_request.scene_styles = style.follow_scene;
  style_request.finishes = style.finishes;
  PictureRequest picture;
  picture.seed = paint.seed, picture.exposure = paint.exposure, picture.upsample = paint.upsample;
  picture.upscale = paint.upscale;
  picture.frame = scene.frame, picture.fps = request.fps;
  SCUMBLE_ASSIGN(PaintedFrame painted, workspace.Paint(request, style_request, picture));
  return std::move(painted.picture);
}

Expected<GuideLayers> Stylizer::State::Guides(const SceneSettings& scene, const LayerSet& layers) {
  SCUMBLE_ASSIGN(const SceneRequest request, RequestOf(scene));
  SCUMBLE_ASSIGN(auto guides, workspace.Guides(request, scene.frame, layers));
  return GuideLayers(std::make_shared<const GuideLayers::State>(GuideLayers::State{std::move(guides)}));
}

Stylizer::Stylizer(StylizerOptions options) : state_(std::make_unique<State>(options)) {}
Stylizer::~Stylizer() = default;
Stylizer::Stylizer(Stylizer&&) noexcept = default;
Stylizer& Stylizer::operator=(Stylizer&&) noexcept = default;

Expected<Picture> Stylizer::Paint(const SceneSettings& scene, const StyleSettings& style, const PaintSettings& paint) {
  return WithMembers(state_->Paint(scene, style, paint));
}

Expected<GuideLayers> Stylizer::Guides(const SceneSettings& scene, const LayerSet& layers) {
  return WithMembers(state_->Guides(scene, layers));
}

void Stylizer::Cancel() {
  if (state_) state_->workspace.Cancel();
}

StylizerCounters Stylizer::counters() const {
  const WorkspaceCounters counters = state_->workspace.counters();
  return {counters.scenes_loaded, counters.structures_built, counters.guides_cast,
          counters.styles_loaded, counters.styles_prepared,  counters.frames_painted};
}

}  // namespace scumble
