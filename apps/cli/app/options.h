// Groups of options that several verbs share, and what they turn into.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/scene/blender_scene.h"
#include "apps/cli/app/command.h"
#include "pipeline/memory/memory_limit.h"
#include "guidegen/guidegen.h"
#include "guidegen/load/load_scene.h"
#include "guidegen/scene/framing.h"
#include "core/image/stopwatch.h"
#include "core/image/style.h"
#include "core/io/picture_file.h"

namespace scumble {

void AddGlobalOptions(CLI::App& verb, Globals& globals);

// --fast-io, of verbs that write EXR.
CLI::Option* AddFastIoOption(CLI::App& verb, bool& fast_io);
// Whether a name ends in .exr, in letters of either case.
bool IsExr(const std::string& path);

// For counts: the parser would take -1 for the largest number there is. Returns what is wrong, or nothing.
std::string RefuseNegative(const std::string& text);
// For amounts that may be fractions: what is not a finite number above 0. `example` says what is meant: "milliseconds, as 40".
std::function<std::string(const std::string&)> RefuseNoAmount(const std::string& example);
// For names, which a shell's empty variable would leave out unseen.
std::string RefuseEmpty(const std::string& text);

// "1280x720" or "512": width and height in pixels.
struct Size {
  int width = 0;
  int height = 0;
};
Expected<Size> ParseSize(const std::string& text);

// "a,b" or "a,b,c": that many numbers, `least` at the fewest. `what` is for the message.
Expected<std::vector<double>> ParseNumbers(const std::string& text, std::size_t least, std::size_t most,
                                           const std::string& what);

// Everything that turns a scene into guides.
struct SceneOptions {
  std::string scene;
  std::string size = "1280x720";
  std::string camera;
  std::string view;
  int aa = 1;
  std::string normal_frame = "camera";
  std::string isa;
  bool robust = true;
  bool half = false;
  bool explain = false;
  BlenderOptions blender;  // for .blend scenes
  std::string animation;   // of a glTF file with several, as AnimationOptions has it
  std::string fps;  // empty: a .blend's own, otherwise kUsualFps
  // Light-path layers, as in GuidegenOptions.
  int samples = GuidegenOptions().samples;
  bool samples_given = false;  // then they are the most that noise or a time budget may take
  int max_bounces = GuidegenOptions().max_bounces;
  double noise = 0.0;
  double time_budget_seconds = 0.0;
  std::uint64_t seed = 0;
  // What the verb takes besides the guides, told before any of it is taken; null: nothing.
  std::function<void(const Size& size, const LayerSet& layers, MemoryNeed& need)> more_memory;
  bool key_light = true;  // let one shine where the file has no light and a layer needs some
};
// How many paths a pixel of light takes, and how long they are.
void AddSampleOptions(CLI::App& verb, SceneOptions& options);
// The same with all else that guides with light paths need.
void AddLightPathOptions(CLI::App& verb, SceneOptions& options);
// A scene, the picture's size and whence it is seen.
void AddViewOptions(CLI::App& verb, SceneOptions& options);
// Which of its animations plays.
void AddAnimationOption(CLI::App& verb, SceneOptions& options);
// How its rays are cast.
void AddCastOptions(CLI::App& verb, SceneOptions& options);
// With everything else but blender.frame, because verbs that make pictures have a frame already.
void AddSceneOptions(CLI::App& verb, SceneOptions& options);

// Milliseconds by step, in the order they happened.
using StepTimes = std::vector<std::pair<std::string, double>>;

// What guides took, counted.
struct SceneCost {
  RayCounts rays;
  WorkCounts work;
  int textures_decoded = 0;
  std::size_t texture_bytes = 0;  // of those
};

struct SceneGuides {
  GuideSet guides;
  std::vector<PlanItem> plan;
  MemoryNeed memory;  // of the whole run
  StepTimes times;
  SceneCost cost;
  int samples = 0;     // of each pixel, in light-path layers
  double noise = 0.0;  // estimated, where noise or a time budget was asked for
};

// Whether the name has a scene's ending.
bool IsScene(const std::string& path);

// Loads the scene, a .blend by way of Blender; warns of what the scene asks for in vain. Its textures are decoded by
// CastScene, if at all.
Expected<Scene> OpenScene(const SceneOptions& options, const Globals& globals, BlenderFilm* film = nullptr,
                          bool warns = true);

// Mistakes in the options come to light before a large scene is loaded.
Status CheckSceneOptions(const SceneOptions& options);

// How an open scene is seen; the key light, where a layer needs one, is added to it.
Expected<PreparedView> ViewScene(Scene& scene, const SceneOptions& options, const LayerSet& layers);

// What the guides' attribute scumble:settings says of how they are seen, for --resume to compare.
std::string GuideSettings(const SceneOptions& options);

// Casts the guides of a scene that is ready; what they need of its textures is decoded and stays in it. The layer motion
// wants `next`, which may be null otherwise.
Expected<SceneGuides> CastScene(Scene& scene, const Camera& camera, const NextFrame* next,
                                const SceneOptions& options, const LayerSet& layers, const Globals& globals,
                                const Progress& progress, bool plan_only);

// Casts the guides of an open scene; the key light, where one is needed, stays in it. Says camera and
// light decisions on stderr, and warns of a picture that shows nothing. With `plan_only` the guides stay empty.
Expected<SceneGuides> MakeGuidesOf(Scene& scene, const SceneOptions& options, const LayerSet& layers,
                                   const Globals& globals, const Progress& progress, bool plan_only);

// Says in the plan which layers the style reads.
void NameStyleInPlan(std::vector<PlanItem>& plan, const Style& style);
std::string PlanToText(const std::vector<PlanItem>& plan);
nlohmann::ordered_json PlanToJson(const std::vector<PlanItem>& plan);

struct StyleOptions {
  std::string style;
  std::vector<std::string> sets;
  std::vector<std::string> assigned;  // "NAME=STYLE", or "@FILE" of such lines
  bool scene_styles = true;           // heed what the scene says
  std::function<Status(std::uint64_t bytes)> room = {};  // as LoadStyle takes it
};
// --style and --set alone, for one style.
void AddOneStyleOptions(CLI::App& verb, StyleOptions& options, bool required);
// One group for verbs that paint and for those that make what is painted on, so that the two steps take what the one takes.
void AddStyleOptions(CLI::App& verb, StyleOptions& options, bool required);

// Where a style is: a path, relative to the folder `base`, or the name of a bundled one.
Expected<std::filesystem::path> FindStyle(const std::string& name, const std::filesystem::path& base = {});

// A path, or the name of a bundled style.
Expected<Style> OpenStyle(const StyleOptions& options);

// Folders of that name in which the program's own files may be: beside the build, or where `install` put them.
std::vector<std::filesystem::path> DataRoots(const std::string& name);

// Folders that may hold bundled styles.
std::vector<std::filesystem::path> StyleRoots();

}  // namespace scumble
