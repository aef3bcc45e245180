// The container of a glTF file: JSON, buffers and encoded pictures, by tinygltf. Nothing is interpreted.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "guidegen/file_listener.h"
#include "guidegen/load/loader_util.h"

namespace tinygltf {
class Model;
}

namespace scumble {

// Fills `model` from a file. Pictures stay encoded in Image::image; those in buffer views stay in their buffer.
// Pictures in files beside the scene are not read and stay empty: only the materials show which are needed.
//
// Checks the container before tinygltf reads it. Refuses JSON nested too deeply for its recursion, lists of more
// elements and extras of more values than any scene has, each of which it makes hundreds of times as large. Refuses
// buffers that repeat one chunk or one large file, of which it would keep as many copies. Its exceptions become errors
// that name the file, its messages about accepted files become warnings. Only regular files beside the scene are read.
Status ParseGltf(const std::filesystem::path& path, const FileListener& on_file, tinygltf::Model& model,
                 WarningCounter& warnings);

// Ok, or an error that names the extensions among `required` that are not read here, and how to export without them.
// ParseGltf asks this before anything else.
Status CheckRequiredExtensions(const std::string& file, std::span<const std::string> required);

// The file of a picture of the scene, by its Image::uri.
std::filesystem::path PictureFile(const std::filesystem::path& scene, const std::string& uri);

}  // namespace scumble
