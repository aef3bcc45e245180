// Scene and style to picture. A Stylizer keeps what it has loaded, cast and prepared. It makes again only what a
// changed request makes stale: a changed key of the style casts no ray, a changed camera loads no file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scumble/data_folder.h"
#include "scumble/guides.h"
#include "scumble/picture.h"
#include "scumble/progress.h"
#include "scumble/scene.h"
#include "scumble/status.h"
#include "scumble/style.h"

namespace scumble {

// Callbacks may throw: the exception passes through the call, and the Stylizer can be used on.
struct StylizerOptions {
  int threads = 0;               // 0: all; for files, the number of the latest call of any Stylizer counts
  std::uint64_t max_memory = 0;  // bytes; 0: what the machine has. A call that needs more is kUsage, or kMemory for 0
  std::string data_folder = SCUMBLE_DATA_FOLDER;  // share/scumble; empty: no bundled styles
  std::string cache_folder;                       // for look-up tables; empty: they are not kept
  std::function<void(const std::string& line, bool is_warning)> message;  // on the calling thread; null: dropped
  Progress progress;  // of each call, 0 … 1; returning false cancels it
  // For .blend scenes. Blender is looked for in the PATH of this environment, "NAME=VALUE", and gets it; without a PATH
  // it is looked for in /bin and /usr/bin.
  std::vector<std::string> environment;
  std::string temporary_folder = "/tmp";  // holds what Blender exports until it is loaded
};

struct PaintSettings {
  std::uint64_t seed = 0;  // another seed, another pattern; the same seed, the same bytes
  // Stops, -64 … 64, for styles that look at light; empty: fitted to the brightest exemplar.
  std::optional<double> exposure;
  int upsample = 1;      // 1 … 8: guides are so many times smaller than the picture, whose sides are multiples of it
  bool upscale = false;  // with upsample above 1: painted at the guides' size and scaled up, quicker and softer
};

// How often each kind of work was done so far.
struct StylizerCounters {
  std::size_t scenes_loaded = 0;     // from files
  std::size_t structures_built = 0;  // acceleration structures
  std::size_t guides_cast = 0;       // rays were cast
  std::size_t styles_loaded = 0;     // from files
  std::size_t styles_prepared = 0;   // exemplars were resized, tables built
  std::size_t frames_painted = 0;
};

class Stylizer {
 public:
  explicit Stylizer(StylizerOptions options = {});
  ~Stylizer();
  // One that was moved from may be destroyed, cancelled or assigned to; nothing else.
  Stylizer(Stylizer&&) noexcept;
  Stylizer& operator=(Stylizer&&) noexcept;

  // Paints a picture: the bytes that `scumble stylize` would write. One call at a time. Errors: kUsage for settings
  // that make no sense, kInput for files, kUnavailable where Blender is missing, kMemory, kCancelled.
  Expected<Picture> Paint(const SceneSettings& scene, const StyleSettings& style, const PaintSettings& paint = {});

  // The guides of a scene: A, normal, depth, object, material, and the layers asked for. The layer motion needs
  // SceneSettings::frame, from which it is measured to the next frame. Errors as of Paint.
  Expected<GuideLayers> Guides(const SceneSettings& scene, const LayerSet& layers = {});

  // Cancels the call that runs at this moment, which then returns kCancelled. It has no effect on a call that starts
  // later, nor where none runs. From any thread, any number of times. A call that is past its last step still returns
  // its result. The file that is being read, and the exemplar that is being prepared, are finished first.
  void Cancel();

  StylizerCounters counters() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace scumble
