#include "cli/scene_frames.h"

#include <utility>

namespace scumble {

Status SceneFrames::Start(std::span<const int> frames, const Progress& progress) {
  if (IsBlenderScene(options_.scene)) {
    SCUMBLE_ASSIGN(blender_, BlenderRange::Start(options_.scene, options_.blender, frames, globals_));
    return Ok();
  }
  SCUMBLE_ASSIGN(guides_, MakeGuides(options_, layers_, globals_, progress, false));
  return guides_.guides.Validate(options_.scene);
}

Expected<const SceneGuides*> SceneFrames::At(int frame, const Progress& progress) {
  SCUMBLE_ASSIGN(const SceneGuides* const guides, Ahead(frame, progress));
  used_ = true;
  return guides;
}

Expected<const SceneGuides*> SceneFrames::Ahead(int frame, const Progress& progress) {
  if (used_) guides_.times.clear(), guides_.plan.clear();
  used_ = false;
  if (!blender_ || frame_ == frame) return &guides_;
  frame_.reset();
  Stopwatch watch;
  SCUMBLE_ASSIGN(Scene scene, blender_->Load(frame));
  const double load_ms = watch.Lap();
  for (const std::string& warning : scene.warnings) {
    if (warned_.insert(warning).second) Warn(options_.scene + ": " + warning);
  }
  SCUMBLE_ASSIGN(guides_, MakeGuidesOf(scene, options_, layers_, spoken_ ? silent_ : globals_, progress, false));
  SCUMBLE_RETURN_IF_ERROR(guides_.guides.Validate(options_.scene));
  guides_.times.insert(guides_.times.begin(), {"load", load_ms});
  if (spoken_) guides_.plan.clear();
  spoken_ = true, frame_ = frame;
  return &guides_;
}

}  // namespace scumble
