// What the header of a Blender render lacks: how it was seen, and which object an index stands for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "image/guides.h"
#include "image/status.h"

namespace scumble {

struct BlenderCamera {
  GuideCamera camera;
  std::map<std::uint32_t, std::string> objects;  // by Blender's pass index
};

// Reads the `.camera` text that blender_scripts/render_guides.py writes beside its picture: lines of `camera NAME`,
// `viewFromWorld` and `clipFromView` with 16 numbers column by column (world space is glTF's), and `object INDEX NAME`.
Expected<BlenderCamera> ReadBlenderCamera(const std::filesystem::path& path);

// Turns passes as Blender writes them into guides: normals from Blender's world space (+Z up) into view space, positions
// into glTF's world space (+Y up), background depth 1e10 into infinity, pass indices into ids of object names. An index
// without a name keeps an id of its own, named "index N". Layers that the set lacks are left out.
void ConvertBlenderPasses(const BlenderCamera& camera, GuideSet& guides);

}  // namespace scumble
