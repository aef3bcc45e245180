// From a scene request to guides: open the scene, decide how it is seen, cast.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/image/guides.h"
#include "core/image/progress.h"
#include "core/image/style.h"
#include "guidegen/guidegen.h"
#include "guidegen/load_scene.h"
#include "pipeline/blender_scene.h"
#include "pipeline/memory_limit.h"
#include "pipeline/requests.h"
#include "pipeline/run_context.h"
#include "pipeline/style_set.h"

namespace scumble {

// Milliseconds by step, in the order they happened.
using StepTimes = std::vector<std::pair<std::string, double>>;

// The work that guides took, counted.
struct SceneCost {
  RayCounts rays;
  WorkCounts work;
  int textures_decoded = 0;
  std::size_t texture_bytes = 0;                   // of those
  int textures_left_out = 0;                       // that cannot be read
  std::vector<std::string> texture_warnings = {};  // why
};

struct SceneGuides {
  GuideSet guides;
  std::vector<PlanItem> plan;
  MemoryNeed memory;  // of the whole run
  StepTimes times;
  SceneCost cost;
  int samples = 0;     // of each pixel, in light-path layers
  int builds = 0;      // of acceleration structures
  double noise = 0.0;  // estimated, where noise or a time budget was asked for
};

// Whether the name has a scene's ending, in letters of either case.
bool IsScene(const std::string& path);

// "AZIMUTH,ELEVATION[,DISTANCE[,RIGHT,UP[,FOV]]]" in degrees and metres, as --view takes it.
std::string ViewToText(const ViewAngles& view);

// "AZIMUTH,ELEVATION" in degrees, as --light takes it.
std::string LightToText(const LightAngles& light);

// How the request's scene is loaded; textures are decoded when they are needed.
LoadOptions LoadOptionsOf(const SceneRequest& request);

// Tells the request's listener of the files that a .blend names, once.
void TellFiles(BlenderAnimation& animation, const SceneRequest& request);

// Passes on a loaded scene's notes, and its warnings if `warns`.
void PassOnNotes(const Scene& scene, const std::string& file, const RunContext& context, bool warns = true);

// Finds mistakes in the request before a large scene is loaded: kUsage or kInput.
Status CheckSceneRequest(const SceneRequest& request);

// Ok, or a kUsage error where options for Blender are given for a file that is read without it.
Status CheckWithoutBlender(const std::string& path, const BlenderRequest& blender);

// Loads the scene, a .blend through Blender; passes on its warnings if `warns`. CastScene decodes its textures, as
// far as they are needed.
Expected<Scene> OpenScene(const SceneRequest& options, const RunContext& context, BlenderAnimation* animation = nullptr,
                          bool warns = true);

// Whether one of the layers is different in another light: lights, random seed and samples concern no other layer.
bool DependOnLight(const LayerSet& layers);

// Whether a layer needs light, so that a scene without any gets a key light.
bool NeedsKeyLight(const SceneRequest& options, const LayerSet& layers);

// Whether a layer needs light, and the request has a sun in place of the scene's lights.
bool ReplacesLights(const SceneRequest& options, const LayerSet& layers);

// How an open scene is seen; the key light, where a layer needs one, is added to it. The request's own light takes the
// place of the scene's.
Expected<PreparedView> ViewScene(Scene& scene, const SceneRequest& options, const LayerSet& layers);

// The attribute that holds the samples which guides were asked to be cast with, and its value: "64", or "4-64" where
// each pixel chose. Where noise or the clock decides, it is the most there may be.
inline constexpr const char* kSamplesKey = "scumble:samples_asked";
std::string SamplesText(const SceneRequest& options);

// The attribute scumble:settings of the guides: how they are seen, for --resume to compare.
std::string GuideSettings(const SceneRequest& options);

// Stores in guides what they were asked for: GuideSettings, SamplesText and the seed.
void StoreSettings(const SceneRequest& options, GuideSet& guides);

// What casting would do, and the memory that it would take; the guides stay empty.
SceneGuides PlanScene(const Scene& scene, const SceneRequest& options, const LayerSet& layers,
                      const RunContext& context);

// What rays are cast into, and where from.
struct SceneToCast {
  Scene& scene;  // ready; textures that the guides need are decoded and stay in it
  const Camera& camera;
  const NextFrame* next = nullptr;  // for the layer motion; null: that layer is not among those asked for
  // For casting this scene and camera again without building: it is made where it is empty, and made again where a
  // texture has been left out, which changes materials. Null: the acceleration structure is built for this cast alone.
  std::optional<RayScene>* rays = nullptr;
};

// Casts the guides of a scene.
Expected<SceneGuides> CastScene(const SceneToCast& cast, const SceneRequest& options, const LayerSet& layers,
                                const RunContext& context, const Progress& progress);

// Casts the guides of an open scene; the key light, where one is needed, stays in it. Notes which camera and light were
// chosen, and warns of a picture that shows nothing.
Expected<SceneGuides> MakeGuidesOf(Scene& scene, const SceneRequest& options, const LayerSet& layers,
                                   const RunContext& context, const Progress& progress);

// Adds to the plan which layers the styles and the finishing effects read.
void NameStylesInPlan(std::vector<PlanItem>& plan, const StyleSet& styles);

}  // namespace scumble
