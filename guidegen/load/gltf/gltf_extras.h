// What blender_scripts/export_scene.py writes into the `extras` of a glTF file, key "scumble", because glTF has no
// words for it: Cycles' lamps, shifted cameras, Blender's pure shaders, the world's colour, objects' styles. Where
// extras and glTF both speak, the extras win. Files without them are not touched. Values of a wrong type or range are a
// kInput error that names the place.
#pragma once

#include <numbers>
#include <optional>
#include <string>

#include "core/image/status.h"
#include "guidegen/scene/scene.h"

namespace tinygltf {
class Model;
class Node;
}  // namespace tinygltf

namespace scumble {

inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

// Styles are also read from the custom property `scumble_style` itself, as other exporters write it.

// Completes scene.materials, which holds the model's materials in their order.
Status ReadMaterialExtras(const tinygltf::Model& model, const std::string& file, Scene& scene);

// The world's radiance of the model's scene of that index, and what its export could not express, as warnings. An index
// that does not exist is no error.
Status ReadSceneExtras(const tinygltf::Model& model, int scene_index, const std::string& file, Scene& scene);

// The light that a node's extras describe, in watts as Cycles 3.4 means them: point and spot I = P/(4π), sun W/m², area
// L = P/(4A). Name and place are the caller's. Nothing where the node has no such extras. `where` is for the messages.
Expected<std::optional<Light>> ReadLightExtras(const tinygltf::Node& node, const std::string& where);

// Completes an instance by the style and pass index that its node's extras name.
Status ReadObjectExtras(const tinygltf::Node& node, const std::string& where, Instance& instance);

// Completes a camera by what its node's extras say of sensor fit, angle and shift.
Status ReadCameraExtras(const tinygltf::Node& node, const std::string& where, Camera& camera);

}  // namespace scumble
