// The cross-check of one scene: our guides against those that Blender's Cycles renders of the same view.
#pragma once

#include <optional>
#include <string>

#include "core/image/status.h"
#include "measure/crosscheck.h"
#include "pipeline/requests.h"
#include "pipeline/run_context.h"

namespace scumble {

struct CrosscheckRequest {
  Size size{640, 360};
  std::string camera;        // by name; empty: the scene's first
  std::optional<int> frame;  // of a .blend
  int samples = 64;          // of each pixel of light; 0: data layers alone
  int max_bounces = 8;
  std::string blender = "blender";  // a path, or a name looked up in PATH
  std::string blender_scene;        // of a .blend, by name; empty: the one that was open when it was saved
  std::string view_layer;           // of a .blend, by name; empty: the first one that is rendered
  std::string keep;                 // folder for the guides of both sides; empty: they are not kept
  bool fast_io = false;             // of those
  bool heat_maps = false;           // pictures of the differences in the report
  FileListener on_file = nullptr;   // as SceneRequest::on_file
};

// Renders the scene with Cycles and with guidegen, and compares layer by layer, in the whole frame: a render border is
// ignored on both sides. kUnavailable where Blender is missing,
// kInput where the scene cannot be rendered or compared.
Expected<CrosscheckReport> CrosscheckScene(const CrosscheckRequest& request, const std::string& scene,
                                           const RunContext& context);

}  // namespace scumble
