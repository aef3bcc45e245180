// Wavefront OBJ with MTL, by tinyobjloader. Use LoadScene (guidegen/load_scene.h), which also sees to what all formats
// have in common.
//
// Each shape (o or g) becomes an object, one instance for each of its materials. Read: polygons, normals, texture
// coordinates (v turned over), vertex colours (sRGB-encoded), smoothing groups where there are no normals; from the MTL
// Kd (linear), d, map_Kd (in place of Kd, as Blender takes it) with -s, -o and -clamp, and norm. A material library or
// texture that is missing is a warning, not an error: OBJ files are often passed on without them.
#pragma once

#include <filesystem>

#include "guidegen/scene.h"
#include "image/status.h"

namespace scumble {

Expected<Scene> LoadObjScene(const std::filesystem::path& path);

}  // namespace scumble
