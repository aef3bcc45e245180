// The text file with the camera of a Blender render, which the render's header lacks.
#pragma once

#include <filesystem>

#include "core/image/guides.h"
#include "core/image/status.h"

namespace scumble {

// Reads the `.camera` text that blender_scripts/render_guides.py writes beside its picture: lines of `camera NAME`,
// `viewFromWorld` and `clipFromView` with 16 numbers column by column (world space is glTF's).
Expected<GuideCamera> ReadBlenderCamera(const std::filesystem::path& path);

}  // namespace scumble
