// Scenes of Blender: has Blender export them, then loads what it wrote.
#pragma once

#include <optional>
#include <string>

#include "cli/command.h"
#include "guidegen/scene.h"
#include "image/status.h"

namespace scumble {

struct BlenderOptions {
  std::string program;       // a path, or a name looked up in PATH; empty: "blender"
  std::optional<int> frame;  // empty: the one that the file was saved at
};

// Whether the name ends in .blend.
bool IsBlenderScene(const std::string& path);

// Runs Blender on blender_scripts/export_scene.py in the background, without the scripts inside the file, and loads the
// temporary .glb that it makes; says so on stderr. kUnavailable where Blender or the script is missing or the version
// is not supported, kInput where the export fails, with Blender's reason. What the export cannot express is among the
// scene's warnings.
Expected<Scene> LoadBlenderScene(const std::string& path, const BlenderOptions& options, const Globals& globals);

}  // namespace scumble
