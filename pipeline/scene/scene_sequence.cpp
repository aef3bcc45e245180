#include "pipeline/scene/scene_sequence.h"

#include <algorithm>
#include <utility>

#include "core/image/stopwatch.h"
#include "pipeline/memory_estimate.h"
#include "pipeline/scene/needed_textures.h"

namespace scumble {

OwnLights OwnLights::Of(const Scene& scene) { return {scene.lights, scene.world_radiance}; }

void OwnLights::PutBack(Scene& scene) const {
  scene.lights = lights, scene.world_radiance = world, scene.has_own_lights = true;
}

namespace {

// How a frame of a .blend is seen. Where the file has no camera or no light, the scene's first frame decides.
Expected<PreparedView> ViewBlender(Scene& scene, BlenderAnimation& animation, const SceneRequest& options,
                                   const LayerSet& layers) {
  if (!animation.start) return ViewScene(scene, options, layers);
  Scene& start = *animation.start;
  const OwnLights own = OwnLights::Of(start);
  SCUMBLE_ASSIGN(PreparedView view, ViewScene(start, options, layers));
  if (start.lights.size() > own.lights.size()) scene.lights.push_back(start.lights.back());
  own.PutBack(start);
  if (ReplacesLights(options, layers)) ReplaceLights(scene, view.camera, *options.light);
  if (options.view || start.cameras.empty()) return view;
  SceneRequest without_light = options;
  without_light.key_light = false, without_light.light.reset();
  SCUMBLE_ASSIGN(const PreparedView now, ViewScene(scene, without_light, layers));
  view.camera = now.camera;
  return view;
}

// The place of the file's camera that is used; none where a view is.
std::optional<int> OwnCamera(const Scene& scene, const SceneRequest& options, const Camera& seen_by) {
  std::optional<int> found;
  if (options.view) return found;
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    if (scene.cameras[i].name == seen_by.name) found = static_cast<int>(i);
  }
  return found;
}

}  // namespace

void StoreFrameRate(const SceneRequest& options, const BlenderAnimation& animation, GuideSet& guides) {
  const std::string fps = options.fps ? FrameRateToText(*options.fps) : animation.fps;
  if (!fps.empty()) guides.attributes["scumble:fps"] = fps;
}

Status SceneFrames::Start(std::span<const int> frames, const Progress& progress) {
  SCUMBLE_RETURN_IF_ERROR(CheckSceneRequest(options_));
  rate_ = options_.fps.value_or(FrameRate());
  return IsBlenderScene(options_.scene) ? StartBlender(frames, context_) : StartFile(progress);
}

Status SceneFrames::Restart(std::span<const int> frames) {
  if (!blender_) return Ok();
  blender_.reset();
  exported_.clear(), needed_by_.clear(), place_.clear(), scenes_.clear();
  loaded_ = 0;
  return StartBlender(frames, silent_);
}

Status SceneFrames::StartBlender(std::span<const int> frames, const RunContext& context) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    place_[frames[i]] = static_cast<int>(i);
    for (int frame = frames[i]; frame <= frames[i] + motion_; ++frame) {
      if (!needed_by_.count(frame)) exported_.push_back(frame);
      needed_by_[frame] = static_cast<int>(i);
    }
  }
  options_.blender.wants_start = options_.view.has_value();
  SCUMBLE_ASSIGN(blender_, BlenderRange::Start(options_.scene, options_.blender, exported_, context));
  return Ok();
}

Status SceneFrames::StartFile(const Progress& progress) {
  Stopwatch watch;
  SCUMBLE_ASSIGN(animation_, AnimatedScene::Load(options_.scene, {options_.animation, LoadOptionsOf(options_)}));
  SCUMBLE_ASSIGN(now_, animation_->SceneAt(0.0));
  PassOnNotes(now_, options_.scene, context_, false);
  WarnOnce(now_);
  SCUMBLE_ASSIGN(layers_, layers_for_(SceneStyleRequestsOf(animation_->objects(), animation_->rest())));
  SCUMBLE_ASSIGN(const PreparedView view, ViewScene(now_, options_, layers_));
  for (const std::string& note : view.notes) context_.Note(note);
  const double load_ms = watch.Lap();
  camera_ = view.camera;
  if (animation_->moves()) {
    by_file_ = OwnCamera(now_, options_, view.camera);
    if (motion_) next_ = now_, next_.textures.clear(), next_.encoded_textures.clear();
    MemoryNeed need;
    AddProgram(context_.threads, need);
    AddScene(now_, CountNeededPixels(now_, options_, layers_), need);
    SCUMBLE_RETURN_IF_ERROR(CheckMemory(need, context_, "make the scene or its textures smaller"));
    // Here, so that a missing picture ends the sequence, and not each of its frames.
    SCUMBLE_ASSIGN(decoded_, DecodeNeededTextures(now_, options_, layers_, context_));
    load_ms_ = load_ms + watch.Lap();
    return Ok();
  }
  const NextFrame next{now_, camera_};
  SCUMBLE_ASSIGN(*guides_,
                 CastScene({now_, camera_, motion_ ? &next : nullptr}, options_, layers_, context_, progress));
  StoreFrameRate(options_, {}, guides_->guides);
  guides_->times.insert(guides_->times.begin(), {"load", load_ms});
  animation_.reset();
  now_ = {};
  return guides_->guides.Validate(options_.scene);
}

Expected<const SceneGuides*> SceneFrames::At(int frame, const Progress& progress) {
  SCUMBLE_ASSIGN(const SceneGuides* const guides, Peek(frame, progress));
  used_ = planned_ = true;
  return guides;
}

Expected<const SceneGuides*> SceneFrames::Peek(int frame, const Progress& progress) {
  if (used_) guides_->times.clear(), guides_->plan.clear(), guides_->cost = {};
  used_ = false;
  if ((!blender_ && !animation_) || frame_ == frame) return guides_.get();
  frame_.reset();
  guides_ = std::make_shared<SceneGuides>();  // the last one may be being written
  const RunContext& context = ContextFor(frame);
  SCUMBLE_ASSIGN(*guides_, blender_ ? CastBlender(frame, context, progress) : CastFile(frame, context, progress));
  SCUMBLE_RETURN_IF_ERROR(guides_->guides.Validate(options_.scene));
  if (planned_) guides_->plan.clear();
  noted_ = true, frame_ = frame;
  seen_.insert(frame);
  return guides_.get();
}

const RunContext& SceneFrames::ContextFor(int frame) const {
  if (seen_.count(frame)) return mute_;
  return noted_ && blender_ ? silent_ : context_;
}

Expected<SceneGuides> SceneFrames::CastFile(int frame, const RunContext& context, const Progress& progress) {
  Stopwatch watch;
  SCUMBLE_RETURN_IF_ERROR(animation_->MoveTo(SecondsAt(frame, rate_), now_));
  if (motion_) SCUMBLE_RETURN_IF_ERROR(animation_->MoveTo(SecondsAt(frame + 1, rate_), next_));
  const double move_ms = watch.Lap();
  const auto camera_of = [this](const Scene& scene) -> const Camera& {
    return by_file_ ? scene.cameras[static_cast<std::size_t>(*by_file_)] : camera_;
  };
  // Without motion the next scene is empty: it has no camera either.
  const auto next = motion_ ? std::optional(NextFrame{next_, camera_of(next_)}) : std::nullopt;
  SCUMBLE_ASSIGN(SceneGuides guides,
                 CastScene({now_, camera_of(now_), next ? &*next : nullptr}, options_, layers_, context, progress));
  StoreFrameRate(options_, {}, guides.guides);
  guides.times.insert(guides.times.begin(), {"move", move_ms});
  if (load_ms_) guides.times.insert(guides.times.begin(), {"load", *load_ms_});
  load_ms_.reset();
  guides.cost.textures_decoded += decoded_.textures_decoded;
  guides.cost.texture_bytes += decoded_.texture_bytes;
  decoded_ = {};
  return guides;
}

Expected<SceneGuides> SceneFrames::CastBlender(int frame, const RunContext& context, const Progress& progress) {
  Stopwatch watch;
  SCUMBLE_ASSIGN(Scene* const loaded, BlenderFrame(frame));
  const int place = place_.at(frame);
  Scene scene = needed_by_.at(frame) <= place ? std::move(*loaded) : *loaded;
  std::erase_if(scenes_,
                [&](const auto& kept) { return kept.first != frame + 1 && needed_by_.at(kept.first) <= place; });
  const double load_ms = watch.Lap();
  WarnOnce(scene);
  SCUMBLE_ASSIGN(const LayerSet layers, layers_for_(SceneStyleRequestsOf(scene.instances, scene)));
  SCUMBLE_ASSIGN(const PreparedView view, ViewBlender(scene, blender_->animation(), options_, layers));
  for (const std::string& note : view.notes) context.Note(note);
  std::optional<Scene> following;
  PreparedView following_view;
  if (motion_) {
    SCUMBLE_ASSIGN(const Scene* const after, BlenderFrame(frame + 1));
    following = *after, following->textures.clear(), following->encoded_textures.clear();
    SCUMBLE_ASSIGN(following_view, ViewBlender(*following, blender_->animation(), options_, layers));
  }
  std::optional<NextFrame> next;
  if (following) next.emplace(NextFrame{*following, following_view.camera});
  SCUMBLE_ASSIGN(SceneGuides guides,
                 CastScene({scene, view.camera, next ? &*next : nullptr}, options_, layers, context, progress));
  StoreFrameRate(options_, blender_->animation(), guides.guides);
  guides.times.insert(guides.times.begin(), {"load", load_ms});
  return guides;
}

Expected<Scene*> SceneFrames::BlenderFrame(int frame) {
  // In the order of the export: a frame that failed may have left some unread, which would keep the next one waiting.
  while (!scenes_.count(frame) && loaded_ < exported_.size()) {
    const int following = exported_[loaded_++];
    Expected<Scene> scene = blender_->Load(following);
    TellFiles(blender_->animation(), options_);
    if (!scene && following == frame) return scene.error();
    if (scene) scenes_[following] = std::move(*scene);
  }
  const auto found = scenes_.find(frame);
  if (found != scenes_.end()) return &found->second;
  SCUMBLE_ASSIGN(Scene scene, blender_->Load(frame));  // reports again why there is none
  return &(scenes_[frame] = std::move(scene));
}

void SceneFrames::WarnOnce(const Scene& scene) {
  for (const std::string& warning : scene.warnings) {
    if (warned_.insert(warning).second) context_.Warn(options_.scene + ": " + warning);
  }
}

Expected<SceneGuides> MakeGuidesAt(int frame, const SceneRequest& options, const LayersFor& layers_for, bool motion,
                                   const RunContext& context, const Progress& progress) {
  if (IsBlenderScene(options.scene) && !motion) {
    SceneRequest at = options;
    at.blender.frame = frame;
    return MakeStaticGuides(at, layers_for, motion, context, progress);
  }
  SceneFrames scene(options, layers_for, motion, context);
  SCUMBLE_RETURN_IF_ERROR(scene.Start(std::span(&frame, 1), progress));
  SCUMBLE_RETURN_IF_ERROR(scene.At(frame, progress));
  return scene.Take();
}

Status CheckAtRest(const SceneRequest& options, bool motion) {
  const std::string fix = ": give --frame N, or --frames for several where the command has it";
  if (motion) return UsageError("the layer motion is measured from one frame to the next" + fix);
  if (!options.animation.empty()) return UsageError("--animation plays with the frames' numbers" + fix);
  return Ok();
}

Expected<StaticScene> OpenStaticScene(const SceneRequest& options, const LayersFor& layers_for, bool motion,
                                      const RunContext& context, bool plan_only, bool warns) {
  SCUMBLE_RETURN_IF_ERROR(CheckSceneRequest(options));
  SCUMBLE_RETURN_IF_ERROR(CheckAtRest(options, motion));
  Stopwatch watch;
  StaticScene rest;
  SCUMBLE_ASSIGN(rest.scene, OpenScene(options, context, plan_only ? nullptr : &rest.animation, warns));
  SCUMBLE_ASSIGN(rest.layers, layers_for(SceneStyleRequestsOf(rest.scene.instances, rest.scene)));
  rest.load_ms = watch.Lap();
  SCUMBLE_ASSIGN(rest.view, ViewBlender(rest.scene, rest.animation, options, rest.layers));
  for (const std::string& note : rest.view.notes) context.Note(note);
  return rest;
}

Expected<StaticScene> OpenSceneAt(std::optional<int> frame, const SceneRequest& options, const LayersFor& layers_for,
                                  const RunContext& context, bool warns) {
  if (!frame || IsBlenderScene(options.scene)) {
    SceneRequest at = options;
    at.blender.frame = frame;
    return OpenStaticScene(at, layers_for, false, context, false, warns);
  }
  SCUMBLE_RETURN_IF_ERROR(CheckSceneRequest(options));
  Stopwatch watch;
  SCUMBLE_ASSIGN(const AnimatedScene animation,
                 AnimatedScene::Load(options.scene, {options.animation, LoadOptionsOf(options)}));
  PassOnNotes(animation.rest(), options.scene, context, warns);
  SCUMBLE_ASSIGN(StaticScene result, PoseScene(animation, frame, options, layers_for, context));
  result.load_ms = watch.Lap();
  return result;
}

Expected<StaticScene> PoseScene(const AnimatedScene& animation, std::optional<int> frame, const SceneRequest& options,
                                const LayersFor& layers_for, const RunContext& context) {
  StaticScene result;
  result.scene = animation.rest();
  if (frame) {
    SCUMBLE_ASSIGN(result.scene, animation.SceneAt(0.0));
  }
  SCUMBLE_ASSIGN(result.layers, layers_for(SceneStyleRequestsOf(animation.objects(), animation.rest())));
  SCUMBLE_ASSIGN(result.view, ViewScene(result.scene, options, result.layers));
  for (const std::string& note : result.view.notes) context.Note(note);
  if (frame && animation.moves()) {
    const std::optional<int> own = OwnCamera(result.scene, options, result.view.camera);
    SCUMBLE_RETURN_IF_ERROR(animation.MoveTo(SecondsAt(*frame, options.fps.value_or(FrameRate())), result.scene));
    if (own) result.view.camera = result.scene.cameras[static_cast<std::size_t>(*own)];
  }
  return result;
}

Status ViewAgain(StaticScene& rest, const OwnLights& lights, const SceneRequest& options, const LayerSet& layers) {
  lights.PutBack(rest.scene);
  SCUMBLE_ASSIGN(rest.view, ViewBlender(rest.scene, rest.animation, options, layers));
  rest.layers = layers;
  return Ok();
}

Expected<SceneGuides> MakeStaticGuides(const SceneRequest& options, const LayersFor& layers_for, bool motion,
                                       const RunContext& context, const Progress& progress) {
  SCUMBLE_ASSIGN(StaticScene rest, OpenStaticScene(options, layers_for, motion, context, false));
  SCUMBLE_ASSIGN(SceneGuides result,
                 CastScene({rest.scene, rest.view.camera}, options, rest.layers, context, progress));
  StoreFrameRate(options, rest.animation, result.guides);
  result.times.insert(result.times.begin(), {"load", rest.load_ms});
  return result;
}

Expected<SceneGuides> PlanSceneAt(std::optional<int> frame, const SceneRequest& options, const LayersFor& layers_for,
                                  const RunContext& context) {
  SceneRequest at = options;
  at.blender.frame = frame;
  const bool poses = frame && !IsBlenderScene(options.scene);
  SCUMBLE_ASSIGN(const StaticScene scene, poses ? OpenSceneAt(frame, options, layers_for, context)
                                                : OpenStaticScene(at, layers_for, false, context, true));
  SceneGuides result = PlanScene(scene.scene, options, scene.layers, context);
  result.times.emplace_back("load", scene.load_ms);
  return result;
}

}  // namespace scumble
