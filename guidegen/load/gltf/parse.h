// The outer shell of a glTF file: container, JSON, buffers and encoded pictures, by tinygltf. Nothing is interpreted.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "guidegen/load/loader_util.h"

namespace tinygltf {
class Model;
}

namespace scumble {

// Fills `model` from a file. Pictures stay encoded in Image::image (those in buffer views stay in their buffer); those
// in files beside the scene are not read, and stay empty: only the materials know whether anybody wants them. Checks
// the container before tinygltf sees it, refuses JSON nested too deeply for its recursion, lists of more elements and
// extras of more values than any scene has, each of which it makes hundreds of times as large, and buffers that are one
// chunk or one large file many times, of which it would keep as many copies, and turns whatever it throws into an error
// that names the file; what it only complains about becomes a warning. Files beside the scene are read only if they are
// regular files.
Status ParseGltf(const std::filesystem::path& path, tinygltf::Model& model, WarningCounter& warnings);

// The file that Image::uri of such a picture of the scene names.
std::filesystem::path PictureFile(const std::filesystem::path& scene, const std::string& uri);

}  // namespace scumble
