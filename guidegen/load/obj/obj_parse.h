// The text of a Wavefront OBJ file and of its material libraries, by tinyobjloader. Nothing is interpreted.
#pragma once

#include <tiny_obj_loader.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "guidegen/file_listener.h"
#include "guidegen/load/loader_util.h"

namespace scumble {

// What follows a line `o` or `g`, which names an object or a group.
struct ObjSection {
  std::size_t first_face = 0;  // counted through the whole file
  int object = 0;              // how many lines `o` came before
  bool is_group = false;
};

struct ObjContents {
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;        // faces are polygons; indices are not checked
  std::vector<tinyobj::material_t> materials;  // whose textures that are read are paths
  // Corners of each face of the file, in order, where a face has more than 255: tinyobjloader of Debian 12 counts them
  // in a byte. Empty: its own counts are right.
  std::vector<std::uint32_t> corner_counts;
  std::vector<ObjSection> sections;  // in order
  bool has_smoothing = false;        // there are lines `s`; faces before the first one are in no smoothing group

  // Whether each vertex has a colour.
  bool HasColors() const {
    return !attributes.colors.empty() && attributes.colors.size() == attributes.vertices.size();
  }
};

// Fills `contents` from a file. A missing library becomes a warning; tinyobjloader's refusals and exceptions become
// kInput errors that name the file. Only regular files are read. Textures are beside their library, or else beside the
// scene. `on_file` is told of all that the libraries name.
Status ParseObj(const std::filesystem::path& path, const FileListener& on_file, WarningCounter& warnings,
                ObjContents& contents);

}  // namespace scumble
