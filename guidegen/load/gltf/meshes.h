// glTF meshes: each primitive becomes a Mesh.
#pragma once

#include <string>
#include <vector>

#include "core/image/status.h"
#include "guidegen/load/auto_smooth.h"
#include "guidegen/load/gltf/accessor.h"
#include "guidegen/load/gltf/skin.h"
#include "guidegen/load/loader_util.h"
#include "guidegen/scene.h"

namespace tinygltf {
class Model;
}

namespace scumble {

// State that the parts of one file's loader share; all of it is the caller's.
struct GltfLoad {
  const tinygltf::Model& model;
  const std::string& file;  // for the messages
  Scene& scene;
  GeometryBudget& budget;
  WarningCounter& warnings;
  ElementChoice& choice;  // of vertices; each primitive makes its own
  MissingNormals& missing;
};

// Loads the primitives of one glTF mesh into scene.meshes and returns their indices. Points, lines and primitives
// without positions are left out with a warning; the list may be empty. The attribute _SCUMBLE_REST, which our Blender
// export writes, becomes rest_positions. scene.materials must hold the file's.
Expected<std::vector<int>> LoadGltfMesh(const GltfLoad& load, int mesh_index);

// A mesh to be deformed. Its scene.meshes have rest_positions.
struct DeformationRequest {
  std::size_t joints = 0;   // of its skin; 0: it has none
  std::size_t targets = 0;  // how many weights there are; 0: morph targets are not read
};
struct DeformableMesh {
  int mesh = 0;  // in scene.meshes
  MeshDeformation deformation;
};
// kInput errors, naming mesh and place: counts that differ, joints that do not exist, numbers that are not finite. A
// primitive without JOINTS_0 and WEIGHTS_0 has no influences.
Expected<std::vector<DeformableMesh>> LoadDeformableMesh(const GltfLoad& load, int mesh_index,
                                                         const DeformationRequest& request);

}  // namespace scumble
