// Scenes of Blender: has Blender export them, then loads what it wrote.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "guidegen/scene.h"
#include "pipeline/requests.h"
#include "pipeline/run_context.h"

namespace scumble {

struct BlenderTask;
class RunningProgram;
class ScratchFolder;

// Whether the name ends in .blend.
bool IsBlenderScene(const std::string& path);

// What is the same in all frames of a .blend.
struct BlenderAnimation {
  std::string fps;                 // frames a second, as ParseFrameRate takes them; empty: unknown
  int first = 0, last = 0;         // of the frames that are rendered
  int saved = 0;                   // the frame that it was saved at
  std::vector<std::string> files;  // that it reads besides itself: linked libraries, pictures, caches
  std::optional<Scene> start;  // the scene at its first frame, where that decides how a frame with a number is seen: it
                               // has no camera, perhaps no lamp, or it was asked for
};

// Adds the request's scene and view layer to the arguments of one of our scripts.
void AddBlenderNames(const BlenderRequest& options, std::vector<std::string>& arguments);

// Runs Blender on blender_scripts/export_scene.py in the background, without the scripts inside the file, and loads the
// temporary .glb that it makes. Notes it, and what the script chose among several scenes and view layers. What the
// export cannot express is among the scene's warnings. `animation` is filled where it is not null. kUnavailable where
// Blender or the script is missing or the version is not supported, kInput where the export fails, with Blender's
// reason. Cancelling ends Blender.
Expected<Scene> LoadBlenderScene(const std::string& path, const BlenderRequest& options, const RunContext& context,
                                 BlenderAnimation* animation = nullptr);

// A range of frames of one .blend, exported by one Blender, which works while earlier frames are drawn. It is a few
// frames ahead at most: the folder for temporary files holds a few of them, however long the range is.
class BlenderRange {
 public:
  // `frames` in the order in which Load will be called. options.frame does not count. Errors as LoadBlenderScene.
  static Expected<std::unique_ptr<BlenderRange>> Start(const std::string& path, const BlenderRequest& options,
                                                       std::span<const int> frames, const RunContext& context);
  ~BlenderRange();  // ends Blender
  BlenderRange(const BlenderRange&) = delete;
  BlenderRange& operator=(const BlenderRange&) = delete;

  // Waits for the next frame of the range, loads it and deletes its file.
  Expected<Scene> Load(int frame);

  // Known when the first frame has been loaded.
  BlenderAnimation& animation() { return animation_; }

 private:
  explicit BlenderRange(const RunContext& context);
  void Waits(bool waits);
  Status LeaveAlone();
  Expected<Scene> Await(int frame);

  RunContext context_;
  std::unique_ptr<BlenderTask> task_;  // for messages
  std::unique_ptr<ScratchFolder> scratch_;
  std::unique_ptr<RunningProgram> program_;
  BlenderAnimation animation_;
  bool has_animation_ = false;
};

}  // namespace scumble
