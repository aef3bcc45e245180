// The nodes of a glTF scene: their tree, transforms and names.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "guidegen/load/gltf/rig.h"
#include "guidegen/load/loader_util.h"

namespace tinygltf {
class Model;
class Node;
}  // namespace tinygltf

namespace scumble {

// For messages: the node's number, and its name where it has one.
std::string NodeLabel(const tinygltf::Model& model, int node);

// The light that KHR_lights_punctual gives a node.
std::optional<int> LightOf(const tinygltf::Node& node);

// The nodes that the file's own scene reaches, depth first in the file's order, with their transforms without the
// animation. Animated ones are marked. kInput errors name the node: one that does not exist or is reached twice,
// nesting beyond 1024 levels, and an invalid transform.
Expected<std::vector<RigNode>> ReadNodes(const tinygltf::Model& model, const std::string& file,
                                         const GltfAnimation& animation, WarningCounter& warnings);

// The names of the objects at those nodes, all different; empty where a node has no mesh, or is hidden. Names beyond
// the limit in total are a kInput error.
Expected<std::vector<std::string>> NameObjects(const tinygltf::Model& model, const std::string& file,
                                               const std::vector<RigNode>& nodes);

}  // namespace scumble
