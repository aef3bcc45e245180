// Groups of options that several commands share, and the requests that their text becomes. Text is read here, once.
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

// For counts: the parser would take -1 for the largest number there is. Returns what is wrong, or nothing.
std::string RefuseNegative(const std::string& text);
// For amounts that may be fractions: what is not a finite number above 0. `example` says what is meant: "milliseconds,
// as 40".
std::function<std::string(const std::string&)> RefuseNoAmount(const std::string& example);
// For names, which a shell's empty variable would leave out unseen.
std::string RefuseEmpty(const std::string& text);

// "1280x720" or "512": width and height in pixels.
Expected<Size> ParseSize(const std::string& text);

// "a,b" or "a,b,c": that many numbers, `least` at the fewest. `what` is for the message.
Expected<std::vector<double>> ParseNumbers(const std::string& text, std::size_t least, std::size_t most,
                                           const std::string& what);

// Stops of --exposure; nothing for auto. A usage error says what was expected.
Expected<std::optional<double>> ParseExposure(const std::string& text);

// The options of a scene: a request, and the text that becomes the rest of it.
struct SceneOptions {
  SceneRequest request;
  std::string size = "1280x720";
  std::string view;
  std::string normal_frame = "camera";
  std::string fps;
  bool explain = false;
};
Expected<SceneRequest> ToRequest(const SceneOptions& options);

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
// With everything else but blender.frame, because commands that make pictures have a frame already.
void AddSceneOptions(CLI::App& verb, SceneOptions& options);

// --style and --set alone, for one style.
void AddOneStyleOptions(CLI::App& verb, StyleRequest& request, bool required);
// One group for commands that paint and for those that make what is painted on, so that the two steps take what the one
// takes.
void AddStyleOptions(CLI::App& verb, StyleRequest& request, bool required);

}  // namespace scumble
