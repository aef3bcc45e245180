// PLY, ASCII and binary of either byte order: scans and exchange files of one mesh. Use LoadScene
// (guidegen/load_scene.h), which also does the work common to all formats.
//
// Read: positions, normals, colours (sRGB-encoded, as scanners and MeshLab write them), texture coordinates (s t, u v
// or texture_u texture_v; v flipped), faces of any number of corners, with their own colour and MeshLab's `texcoord` of
// their corners, which both go before the vertices'. Where both have colours, faces that are all white are ignored, and
// a warning tells of others. `comment TextureFile` names the texture, beside the file; it stands in place of colours,
// and one that is missing or damaged is a warning. Other elements and properties are skipped. A cloud of points without
// faces is a scene without geometry. The object is named after the file. Its surface is Lambert, in the file's texture
// or colours, or in Blender's grey of 0.8. Positions of type double that lie far from 0, as surveyors' do, keep their
// digits: the object then stands at the middle of its shape instead of at 0, and its rest positions are relative to
// that. The shape is that of the vertices in faces. Without normals, or with none that has a direction, it is smooth up
// to kDefaultAutoSmooth, or as the user says.
#pragma once

#include <filesystem>

#include "core/image/status.h"
#include "guidegen/file_listener.h"
#include "guidegen/load/auto_smooth.h"
#include "guidegen/scene.h"

namespace scumble {

Expected<Scene> LoadPlyScene(const std::filesystem::path& path, MissingNormals missing, const FileListener& on_file);

}  // namespace scumble
