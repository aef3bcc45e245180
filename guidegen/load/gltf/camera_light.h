// Cameras and lights at the nodes of a glTF scene.
#pragma once

#include <optional>
#include <string>

#include "core/image/status.h"
#include "guidegen/load/gltf/rig.h"
#include "guidegen/load/loader_util.h"
#include "guidegen/scene.h"

namespace tinygltf {
class Model;
}

namespace scumble {

// The camera of a node that has one, by the node's name if there is one. A camera without a picture is a kInput error
// that names the node.
Expected<Camera> ReadCamera(const tinygltf::Model& model, const std::string& file, const RigNode& node);

// The light of a node: the one that its extras describe, or else that of KHR_lights_punctual; nothing where it has
// neither. It takes the node's name if there is one. Errors as ReadCamera's.
Expected<std::optional<Light>> ReadLight(const tinygltf::Model& model, const std::string& file, const RigNode& node,
                                         WarningCounter& warnings);

}  // namespace scumble
