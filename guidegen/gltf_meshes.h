// glTF meshes: each primitive becomes a Mesh.
#pragma once

#include <string>
#include <vector>

#include "guidegen/loader_util.h"
#include "guidegen/scene.h"
#include "image/status.h"

namespace tinygltf {
class Model;
}

namespace scumble {

// What the parts of one file's loader share; all of it is the caller's.
struct GltfLoad {
  const tinygltf::Model& model;
  const std::string& file;  // for the messages
  Scene& scene;
  GeometryBudget& budget;
  WarningCounter& warnings;
};

// Loads the primitives of one glTF mesh into scene.meshes and returns their indices. Points, lines and primitives
// without positions are left out with a warning; the list may be empty. scene.materials must hold the file's.
Expected<std::vector<int>> LoadGltfMesh(const GltfLoad& load, int mesh_index);

}  // namespace scumble
