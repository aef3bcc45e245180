// The copies of a node's mesh that EXT_mesh_gpu_instancing lists.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "guidegen/load/gltf/accessor.h"
#include "guidegen/load/loader_util.h"

namespace tinygltf {
class Model;
}

namespace scumble {

// The transform of each copy, in the node's space; the mesh itself is not among them. Empty if the node does not ask
// for any, or, with a warning, lists no places for them. kInput errors name the node. They are lists of other types or
// of different lengths, rotations of zero length and infinite transforms. Lists without bytes in the file are taken
// from the budget.
Expected<std::vector<glm::dmat4>> ReadGpuInstances(const tinygltf::Model& model, const std::string& file, int node,
                                                   ZeroBudget& zeros, WarningCounter& warnings);

}  // namespace scumble
