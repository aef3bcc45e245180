// A workspace keeps the scene, its view, the guides, the styles and the prepared exemplars from call to call. Each
// request is compared with what is there, and only what is stale is made again:
//
//   changed                          made again
//   a key of the style, the painting style; exemplars where the key concerns them; the picture. No ray is cast, unless
//                                    the style now reads a layer that the guides lack. Pictures stay decoded.
//   size, layers, anti-aliasing …    guides and picture. The acceleration structure stays, but is built once more if a
//                                    layer first needs light: views without light do not pay for what that takes.
//   light, samples, seed             likewise if a layer depends on light; else the picture alone
//   camera, view                     guides, picture and the acceleration structure, which is relative to the camera.
//                                    No file is loaded.
//   the frame of an animation        pose, guides, picture. No file is loaded (a .blend is exported again).
//   a file on disk                   what was read from it, and all that was made of that
//   quality, budget                  the styles, and what the chosen step changes of guides and exemplars
//
// Pictures are those of `scumble stylize` with the same request, byte for byte.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "core/image/status.h"
#include "core/io/picture_file.h"
#include "pipeline/budget_choice.h"
#include "pipeline/frame/paint_picture.h"
#include "pipeline/frame_report.h"
#include "pipeline/requests.h"
#include "pipeline/run_context.h"
#include "pipeline/style_set.h"
#include "scumble/picture.h"

namespace scumble {

// How often each kind of work was done so far.
struct WorkspaceCounters {
  std::size_t scenes_loaded = 0;     // from files
  std::size_t structures_built = 0;  // acceleration structures
  std::size_t guides_cast = 0;       // rays were cast
  std::size_t styles_loaded = 0;     // from files
  std::size_t pictures_decoded = 0;  // of styles, from files
  std::size_t styles_prepared = 0;   // exemplars resized, tables and trees built
  std::size_t frames_painted = 0;
};

// A picture in memory, and its report.
struct PaintedFrame {
  Picture picture;
  std::shared_ptr<const GuideSet> guides;
  FrameReport report;         // without the step of writing
  PictureWriteOptions write;  // that make a file of the picture the one of `scumble stylize`
  // Only with PictureRequest::keep_field, as KeptField has them.
  std::shared_ptr<const SourceField> field;
  std::shared_ptr<const StyleMap> styles;
  std::vector<FieldStyle> field_styles;
  std::optional<BudgetChoice> choice;  // where a quality or a budget was asked for
};

// Frames in which a scene moves.
struct FrameSpan {
  int first = 0;
  int last = 0;
  double fps = 24.0;
  std::optional<int> saved;  // of a .blend: the frame that it was saved at, which a request without a frame shows
};

struct SceneDescription {
  std::vector<std::string> cameras, objects, materials;  // by name, each once, in the order of the file
  std::optional<FrameSpan> animation;                    // none: nothing moves
  std::size_t lights = 0;                                // of the file's own
  ViewAngles eye;                                        // OrbitOf the camera that the request is seen by
  std::vector<std::string> style_files;                  // that the styles of the last Paint were read from
  SceneStyleRequests style_requests;                     // of the file
  std::vector<std::string>
      warnings;  // of the file, and of its textures that were decoded so far, as they were passed on
};

class Workspace {
 public:
  explicit Workspace(RunContext context);
  ~Workspace();
  Workspace(Workspace&&) noexcept;
  Workspace& operator=(Workspace&&) noexcept;

  // Paints one frame; no file is written. picture.seed, picture.fps and picture.frame replace the scene's. After an
  // error, kCancelled included, the next request starts from what is still valid. One call at a time.
  //
  // With a quality or a budget the step of the ladder is chosen as by `scumble stylize`. It is chosen again if the
  // styles, the size or other settings change; for a budget also if the scene's files change. It stays as the view and
  // the frame change.
  Expected<PaintedFrame> Paint(const SceneRequest& scene, const StyleRequest& style, const PictureRequest& picture,
                               const BudgetRequest& budget = {});

  // Loads and poses the scene if it is stale; casts no ray.
  Expected<SceneDescription> Describe(const SceneRequest& scene, std::optional<int> frame);

  // The files of the scene that was loaded last, or that could not be: all that FileListener is told of.
  std::vector<std::string> SceneFiles() const;

  // The guides of a scene: the layers that every guide set holds, and these; motion needs a frame's number.
  Expected<std::shared_ptr<const GuideSet>> Guides(const SceneRequest& scene, std::optional<int> frame,
                                                   const LayerSet& layers);

  // Cancels the call that runs at this moment, which then returns kCancelled. It has no effect on a call that starts
  // later, nor where none runs. From any thread, any number of times. A call that is past its last step still returns
  // its result. The scene file that is being read, and the exemplar that is being prepared, are finished first.
  void Cancel();

  WorkspaceCounters counters() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace scumble
