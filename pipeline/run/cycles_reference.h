// The cross-check's reference: one Blender process that renders everything of a scene with Cycles.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "core/image/progress.h"
#include "core/image/status.h"
#include "core/io/cycles_light.h"
#include "pipeline/run_context.h"

namespace scumble {

struct ReferenceOptions {
  std::string blender = "blender";
  std::string scene;
  int width = 0;
  int height = 0;
  std::string camera;
  std::optional<int> frame;
  std::vector<int> samples;  // of the light layers, ascending; empty: data layers alone
  int max_bounces = 8;
  std::string blender_scene = {};  // of a .blend, by name
  std::string view_layer = {};
};

struct Reference {
  GuideSet data;
  std::vector<std::uint8_t> only_shines;  // by pixel: 1 where the surface has no albedo and shines
  std::vector<CyclesLight> light;         // by sample count
  std::string version;                    // "3.4.1"; empty where Blender does not name it
  std::vector<std::string> unsupported;   // what is not rendered as authored, in the script's words
};

// Runs blender_scripts/render_guides.py on the scene; scripts inside a .blend do not run. Principled materials are
// rendered as pure ones. `progress` follows the log of the renders and is called from this thread; false ends Blender.
// kUnavailable where Blender or the script is missing or the version is not supported, kInput where the scene cannot be
// rendered, with Blender's reason.
Expected<Reference> RenderReference(const ReferenceOptions& options, const RunContext& context,
                                    const Progress& progress);

}  // namespace scumble
