// Data that blender_scripts/export_scene.py writes into the `extras` of a glTF file, key "scumble", because glTF lacks
// it: Cycles' lights, shifted cameras, Blender's pure shaders, the world's colour, objects' styles. Extras override
// glTF's own values. Files without extras are not changed. Values of a wrong type or range are a kInput error that
// names the place.
#pragma once

#include <numbers>
#include <optional>
#include <string>

#include "core/image/status.h"
#include "guidegen/scene.h"

namespace tinygltf {
class Model;
class Node;
class Value;
struct Mesh;
struct Primitive;
}  // namespace tinygltf

namespace scumble {

inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

// Styles are also read from the custom property `scumble_style` itself, as other exporters write it.

// The texture of a material's "bump", or of its "normal" map where that is none of glTF's, as glTF describes textures;
// null where there is none.
const tinygltf::Value* FindExtrasTexture(const tinygltf::Value& material_extras, const std::string& key);

// Completes scene.materials, which holds the model's materials in their order.
Status ReadMaterialExtras(const tinygltf::Model& model, const std::string& file, Scene& scene);

// The stretch that our exporter has put into a mesh (Mesh::stretch); 1 where it names none.
Expected<glm::dmat3> ReadMeshStretch(const tinygltf::Mesh& mesh, const std::string& where);

// The world's radiance of the model's scene of that index, and warnings for losses in its export. An index that does
// not exist is no error.
Status ReadSceneExtras(const tinygltf::Model& model, int scene_index, const std::string& file, Scene& scene);

// The light that a node's extras describe, in watts as in Cycles 3.4: point and spot I = P/(4π), sun W/m², area L =
// P/(4A). The caller sets name and place. Empty if the node has no such extras. `where` is for the messages.
Expected<std::optional<Light>> ReadLightExtras(const tinygltf::Node& node, const std::string& where);

// Completes an instance by the style and pass index in its node's extras.
Status ReadObjectExtras(const tinygltf::Node& node, const std::string& where, Instance& instance);

// Whether a primitive's extras say that it is hair, and how it is drawn: curves.ribbons and curves.pieces.
Expected<std::optional<Curves>> ReadCurvesExtras(const tinygltf::Primitive& primitive, const std::string& where);

// Completes a camera by the sensor fit, angle and shift in its node's extras.
Status ReadCameraExtras(const tinygltf::Node& node, const std::string& where, Camera& camera);

}  // namespace scumble
