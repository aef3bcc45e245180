// The guides of a scene, frame by frame.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "cli/blender.h"
#include "cli/options.h"

namespace scumble {

class SceneFrames {
 public:
  // `globals` must outlive this.
  SceneFrames(SceneOptions options, const LayerSet& layers, const Globals& globals)
      : options_(std::move(options)), layers_(layers), globals_(globals), silent_(globals) {
    silent_.quiet = true;
  }

  // A scene that does not move is loaded and cast here, once for all frames; of a .blend, one Blender begins to export
  // these frames.
  Status Start(std::span<const int> frames, const Progress& progress);

  // The guides of one of the frames, to be asked for in their order; the same one may be asked for again. What the
  // scene has to say (cameras, lights, warnings) is said once. Plan and times are those of the work that this call did.
  // Valid until the next call.
  Expected<const SceneGuides*> At(int frame, const Progress& progress);

  // The same, for a look at a frame that At will be asked for next; plan and times are kept for it.
  Expected<const SceneGuides*> Ahead(int frame, const Progress& progress);

 private:
  SceneOptions options_;
  LayerSet layers_;
  const Globals& globals_;
  Globals silent_;
  std::unique_ptr<BlenderRange> blender_;  // none: the scene does not move
  std::optional<int> frame_;               // that guides_ are of
  SceneGuides guides_;
  bool used_ = false;    // At has handed out guides_
  bool spoken_ = false;  // the first frame has said what there is to say
  std::set<std::string> warned_;
};

}  // namespace scumble
