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

#include "guidegen/load/load_scene.h"
#include "guidegen/scene/framing.h"
#include "pipeline/requests.h"
#include "pipeline/scene/blender_scene.h"
#include "pipeline/scene/scene_guides.h"
#include "pipeline/style/style_set.h"

namespace scumble {

// The layers to make of a scene whose author has these wishes.
using LayersFor = std::function<Expected<LayerSet>(const SceneStyleRequests&)>;

class SceneFrames {
 public:
  // `context` must outlive this. `motion`: whether that layer will be among those of `layers_for`.
  SceneFrames(SceneRequest options, LayersFor layers_for, bool motion, const RunContext& context)
      : options_(std::move(options)),
        layers_for_(std::move(layers_for)),
        motion_(motion),
        context_(context),
        silent_(context.WithoutNotes()) {
    silent_.clock = context.clock;
  }

  // A scene that does not move is loaded and cast here, once for all frames. One that moves is loaded here, and how it
  // is seen is decided as it stands at time 0, whatever the frames: a camera that frames it and a key light stay where
  // they are then, a camera of the file moves as the file says. Of a .blend, one Blender begins to export these frames,
  // for the layer motion the next ones too; time 0 is its own first frame there.
  Status Start(std::span<const int> frames, const Progress& progress);

  // The guides of one of the frames, to be asked for in their order; the same one may be asked for again. What the
  // scene has to say (cameras, lights, warnings) is said once. Plan, times and cost are those of the work that this
  // call did. Valid until the next call.
  Expected<const SceneGuides*> At(int frame, const Progress& progress);

  // The same, for a look at a frame that At will be asked for next; plan, times and cost are kept for it.
  Expected<const SceneGuides*> Ahead(int frame, const Progress& progress);

  // What At has handed out last, to keep beyond the next call: only its guides, the rest may change.
  std::shared_ptr<const SceneGuides> Keep() const { return guides_; }

  // Gives away what At has handed out last.
  SceneGuides Take() { return std::move(*guides_); }

 private:
  Status StartBlender(std::span<const int> frames);
  Status StartFile(const Progress& progress);
  Expected<SceneGuides> CastFile(int frame, const Progress& progress);
  Expected<SceneGuides> CastBlender(int frame, const Progress& progress);
  Expected<Scene*> BlenderFrame(int frame);
  void WarnOnce(const Scene& scene);

  SceneRequest options_;
  LayersFor layers_for_;
  bool motion_;
  const RunContext& context_;
  RunContext silent_;

  // A file that moves.
  std::optional<AnimatedScene> animation_;  // none: the scene stands still, or is Blender's
  LayerSet layers_;
  std::optional<double> load_ms_;  // that no frame has told of
  SceneCost decoded_;              // nor of these textures
  FrameRate rate_;
  Scene now_, next_;            // as they are posed; `next_` for the layer motion, without textures
  Camera camera_;               // where the file's own are not looked through
  std::optional<int> by_file_;  // otherwise, in now_.cameras

  std::unique_ptr<BlenderRange> blender_;  // none: no .blend
  std::vector<int> exported_;              // frames that it exports, in their order
  std::size_t loaded_ = 0;                 // so many of them
  std::map<int, int> needed_by_;           // of an exported frame, the place in the range that needs it last
  std::map<int, int> place_;               // of a frame in the range
  std::map<int, Scene> scenes_;            // that a frame still needs

  std::optional<int> frame_;  // that guides_ are of
  std::shared_ptr<SceneGuides> guides_ = std::make_shared<SceneGuides>();
  bool used_ = false;    // At has handed out guides_
  bool spoken_ = false;  // the first frame has said what there is to say
  std::set<std::string> warned_;
};

// Writes the frames' rate among the attributes, where the command line or the .blend names one.
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

// Says how it is seen, and what the scene warns of unless `warns` is false: it will be opened once more. Errors as
// MakeStaticGuides has them.
Expected<StaticScene> OpenStaticScene(const SceneRequest& options, const LayersFor& layers_for, bool motion,
                                      const RunContext& context, bool plan_only, bool warns = true);

// Poses a scene that is loaded, at a frame or at rest, and decides how it is seen. Passes on its warnings if `warns`.
Expected<StaticScene> PoseScene(const AnimatedScene& animation, std::optional<int> frame, const SceneRequest& options,
                                const LayersFor& layers_for, const RunContext& context, bool warns);

// Decides again how a posed scene of Blender's is seen, for other layers or through another camera.
Status ViewAgain(StaticScene& rest, std::size_t lights, const SceneRequest& options, const LayerSet& layers);

// The same of a frame, seen as SceneFrames sees it; without a number, at rest.
Expected<StaticScene> OpenSceneAt(std::optional<int> frame, const SceneRequest& options, const LayersFor& layers_for,
                                  const RunContext& context, bool warns = true);

// The scene as it stands without a frame's number, as MakeGuidesOf has it. --animation and the layer motion are usage
// errors.
Expected<SceneGuides> MakeStaticGuides(const SceneRequest& options, const LayersFor& layers_for, bool motion,
                                       const RunContext& context, const Progress& progress, bool plan_only);

}  // namespace scumble
