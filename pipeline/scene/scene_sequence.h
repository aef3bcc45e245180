// The guides of a scene, frame by frame.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "guidegen/framing.h"
#include "guidegen/load_scene.h"
#include "pipeline/blender_scene.h"
#include "pipeline/requests.h"
#include "pipeline/scene_guides.h"
#include "pipeline/style_set.h"

namespace scumble {

// The layers to make of a scene that asks for these styles.
using LayersFor = std::function<Expected<LayerSet>(const SceneStyleRequests&)>;

class SceneFrames {
 public:
  // `context` must outlive this. `motion`: whether that layer will be among those of `layers_for`.
  SceneFrames(SceneRequest options, LayersFor layers_for, bool motion, const RunContext& context)
      : options_(std::move(options)),
        layers_for_(std::move(layers_for)),
        motion_(motion),
        context_(context),
        silent_(context.WithoutNotes()),
        mute_(context) {
    silent_.clock = context.clock;
    mute_.on_message = nullptr;
  }

  // A scene that does not move is loaded and cast here, once for all frames. One that moves is loaded here. How it is
  // seen is decided at time 0, whatever the frames: a camera that frames it and a key light stay where they are then; a
  // camera of the file moves as the file says. Of a .blend, one Blender begins to export these frames, for the layer
  // motion the next ones too. Time 0 is then the scene's first frame.
  Status Start(std::span<const int> frames, const Progress& progress);

  // From here on these frames are asked for, in this order, instead of what is left of those of Start: of a .blend,
  // another Blender exports them. Notes nothing again.
  Status Restart(std::span<const int> frames);

  // The guides of one of the frames, in their order; one frame may be asked for again. Cameras, lights and warnings are
  // noted once. Plan, times and cost are those of the work that this call did. Valid until the next call.
  Expected<const SceneGuides*> At(int frame, const Progress& progress);

  // As At, for the frame that At will be asked for next; plan, times and cost are kept for that call.
  Expected<const SceneGuides*> Peek(int frame, const Progress& progress);

  // What At has returned last, to keep beyond the next call: only its guides, the rest may change.
  std::shared_ptr<const SceneGuides> Keep() const { return guides_; }

  // Gives away what At has returned last.
  SceneGuides Take() { return std::move(*guides_); }

 private:
  Status StartBlender(std::span<const int> frames, const RunContext& context);
  Status StartFile(const Progress& progress);
  const RunContext& ContextFor(int frame) const;
  Expected<SceneGuides> CastFile(int frame, const RunContext& context, const Progress& progress);
  Expected<SceneGuides> CastBlender(int frame, const RunContext& context, const Progress& progress);
  Expected<Scene*> BlenderFrame(int frame);
  void WarnOnce(const Scene& scene);

  SceneRequest options_;
  LayersFor layers_for_;
  bool motion_;
  const RunContext& context_;
  RunContext silent_;  // without notes
  RunContext mute_;    // without warnings too

  // A file that moves.
  std::optional<AnimatedScene> animation_;  // none: the scene stands still, or is Blender's
  LayerSet layers_;
  std::optional<double> load_ms_;  // of loading, until a frame reports it
  SceneCost decoded_;              // textures, likewise
  FrameRate rate_;
  Scene now_, next_;            // as they are posed; `next_` for the layer motion, without textures
  Camera camera_;               // where none of the file's own is used
  std::optional<int> by_file_;  // otherwise, in now_.cameras

  std::unique_ptr<BlenderRange> blender_;  // none: no .blend
  std::vector<int> exported_;              // frames that it exports, in their order
  std::size_t loaded_ = 0;                 // so many of them
  std::map<int, int> needed_by_;           // of an exported frame, the place in the range that needs it last
  std::map<int, int> place_;               // of a frame in the range
  std::map<int, Scene> scenes_;            // that a frame still needs

  std::optional<int> frame_;  // that guides_ are of
  std::shared_ptr<SceneGuides> guides_ = std::make_shared<SceneGuides>();
  bool used_ = false;     // At has returned guides_
  bool noted_ = false;    // the first frame is made: cameras and lights are noted
  bool planned_ = false;  // At has returned the plan
  std::set<std::string> warned_;
  std::set<int> seen_;  // frames that were cast: what there is to warn of is said
};

// Stores the frames' rate among the attributes, where the request or the .blend names one.
void StoreFrameRate(const SceneRequest& options, const BlenderAnimation& animation, GuideSet& guides);

// One frame, as a sequence would have it.
Expected<SceneGuides> MakeGuidesAt(int frame, const SceneRequest& options, const LayersFor& layers_for, bool motion,
                                   const RunContext& context, const Progress& progress);

// A scene that stands still, at a frame or without one's number, and how it is seen.
struct StaticScene {
  Scene scene;
  PreparedView view;
  LayerSet layers;
  BlenderAnimation animation;
  double load_ms = 0.0;
};

// The lights that a scene came with.
struct OwnLights {
  std::vector<Light> lights;
  glm::vec3 world{0.0f};

  static OwnLights Of(const Scene& scene);
  void PutBack(Scene& scene) const;
};

// Ok, or a usage error: the layer motion and --animation need a frame's number.
Status CheckAtRest(const SceneRequest& options, bool motion);

// Notes how it is seen. Passes on the scene's warnings if `warns`. Errors as MakeStaticGuides has them.
Expected<StaticScene> OpenStaticScene(const SceneRequest& options, const LayersFor& layers_for, bool motion,
                                      const RunContext& context, bool plan_only, bool warns = true);

// Poses a scene that is loaded, at a frame or at rest, and decides how it is seen, which it notes.
Expected<StaticScene> PoseScene(const AnimatedScene& animation, std::optional<int> frame, const SceneRequest& options,
                                const LayersFor& layers_for, const RunContext& context);

// Decides again how a posed scene of Blender's is seen, for other layers or through another camera.
Status ViewAgain(StaticScene& rest, const OwnLights& lights, const SceneRequest& options, const LayerSet& layers);

// Opens a scene at a frame, seen as SceneFrames sees it; without a number, at rest.
Expected<StaticScene> OpenSceneAt(std::optional<int> frame, const SceneRequest& options, const LayersFor& layers_for,
                                  const RunContext& context, bool warns = true);

// The guides of a scene without a frame's number, at rest. Errors of CheckAtRest.
Expected<SceneGuides> MakeStaticGuides(const SceneRequest& options, const LayersFor& layers_for, bool motion,
                                       const RunContext& context, const Progress& progress);

// PlanScene of a scene at a frame, or at rest: what MakeGuidesAt or MakeStaticGuides would do.
Expected<SceneGuides> PlanSceneAt(std::optional<int> frame, const SceneRequest& options, const LayersFor& layers_for,
                                  const RunContext& context);

}  // namespace scumble
