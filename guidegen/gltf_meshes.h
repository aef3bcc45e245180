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

// Loads the primitives of one glTF mesh into scene.meshes and returns their indices. Points, lines and primitives
// without positions are left out with a warning; the list may be empty. scene.materials must hold the file's.
Expected<std::vector<int>> LoadGltfMesh(const tinygltf::Model& model, const std::string& file, int mesh_index,
                                        Scene& scene, GeometryBudget& budget, WarningCounter& warnings);

}  // namespace scumble
