// Groups of options that several commands share, and their conversion from text to requests, which happens only here.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/cli/app/command.h"
#include "pipeline/requests.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace scumble {

void AddGlobalOptions(CLI::App& verb, Globals& globals);
// --max-memory.
void AddMemoryOption(CLI::App& verb, Globals& globals);
// --timing.
void AddTimingOption(CLI::App& verb, Globals& globals);
// --fps.
void AddFpsOption(CLI::App& verb, std::string& fps, const std::string& help);
// --fast-io, of commands that write EXR.
CLI::Option* AddFastIoOption(CLI::App& verb, bool& fast_io);

// For counts: the parser would turn -1 into the largest number. Returns the error, or an empty text.
std::string RefuseNegative(const std::string& text);
// For amounts that may be fractions: refuses all but finite numbers above 0. `example` gives the meaning:
// "milliseconds, as 40".
std::function<std::string(const std::string&)> RefuseNoAmount(const std::string& example);
// For names, which a shell's empty variable would silently remove.
std::string RefuseEmpty(const std::string& text);

// "1280x720" or "512": width and height in pixels.
Expected<Size> ParseSize(const std::string& text);

// "a,b" or "a,b,c": that many numbers, `least` at the fewest. `what` is for the message.
Expected<std::vector<double>> ParseNumbers(const std::string& text, std::size_t least, std::size_t most,
                                           const std::string& what);

// Stops of --exposure; empty for auto. A usage error gives the expected form.
Expected<std::optional<double>> ParseExposure(const std::string& text);

// The options of a scene: a request, and the texts that complete it.
struct SceneOptions {
  SceneRequest request;
  std::string size = "1280x720";
  std::string view;
  std::string light;
  std::string normal_frame = "camera";
  std::string fps;
  bool explain = false;
};
Expected<SceneRequest> ToRequest(const SceneOptions& options);

// The number of paths for a pixel of light, and their length.
void AddSampleOptions(CLI::App& verb, SceneOptions& options);
// AddSampleOptions and all other options of guides with light paths.
void AddLightPathOptions(CLI::App& verb, SceneOptions& options);
// A scene, the picture's size and its view.
void AddViewOptions(CLI::App& verb, SceneOptions& options);
// --scene and --view-layer, of commands that read .blend files.
void AddSceneNameOptions(CLI::App& verb, std::string& scene, std::string& view_layer);
// Those and --blender.
void AddBlenderOptions(CLI::App& verb, BlenderRequest& request);
// The animation to play.
void AddAnimationOption(CLI::App& verb, SceneOptions& options);
// Options of ray casting.
void AddCastOptions(CLI::App& verb, SceneOptions& options);
// With all other options but blender.frame, because commands that make pictures have a frame already.
void AddSceneOptions(CLI::App& verb, SceneOptions& options);

// --finish and --finish-measures.
void AddFinishOptions(CLI::App& verb, std::vector<std::string>& finishes, std::optional<FinishMeasures>& measures);

// The options of styles: a request, and the texts of --set that complete it.
struct StyleOptions {
  StyleRequest request;
  std::vector<std::string> sets;
};
Expected<StyleRequest> ToRequest(const StyleOptions& options);

// --style and --set alone, for one style.
void AddOneStyleOptions(CLI::App& verb, StyleOptions& options, bool required);
// One group for commands that paint and for those that make their guides, so that two steps have the options of one.
void AddStyleOptions(CLI::App& verb, StyleOptions& options, bool required);

}  // namespace scumble
