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

// For messages: its number, and its name where it has one.
std::string NodeLabel(const tinygltf::Model& model, int node);

// The light that KHR_lights_punctual gives a node.
std::optional<int> LightOf(const tinygltf::Node& node);

// The nodes that the file's own scene reaches, depth first in the file's order, as they stand without the animation;
// what the animation moves is marked. A node that does not exist or is reached twice, nesting beyond 1024 levels, and a
// transform that is none are kInput errors that name the node.
Expected<std::vector<RigNode>> ReadNodes(const tinygltf::Model& model, const std::string& file,
                                         const GltfAnimation& animation, WarningCounter& warnings);

// The names of the objects at those nodes, each another one; empty where a node has no mesh. Names that come to more
// than any scene has are a kInput error.
Expected<std::vector<std::string>> NameObjects(const tinygltf::Model& model, const std::string& file,
                                               const std::vector<RigNode>& nodes);

}  // namespace scumble
