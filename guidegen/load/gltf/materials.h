// glTF materials and the pictures they use.
#pragma once

#include <filesystem>
#include <string>

#include "core/image/status.h"
#include "guidegen/load/loader_util.h"
#include "guidegen/scene.h"

namespace tinygltf {
class Model;
}

namespace scumble {

// Appends every material of the file to scene.materials, in the file's order. Keeps the pictures of their base colours,
// normal maps, roughness, metalness and emission as encoded textures; other pictures are ignored. A picture that is
// missing or damaged is an error that names it, when it is decoded. A material whose only colour is that of
// KHR_materials_pbrSpecularGlossiness becomes non-metallic, with its diffuse colour and texture and its glossiness; a
// warning names the loss. Images in one part of a buffer share its bytes. Other overlaps, that exceed the buffers'
// size, are an error at once.
Status LoadGltfMaterials(const tinygltf::Model& model, const std::string& file, Scene& scene, WarningCounter& warnings);

// Warns of transparency that is cut, and of extensions that are not read, where a mesh of the scene has the material.
// scene.materials begins with the model's.
void WarnOfUsedMaterials(const tinygltf::Model& model, const Scene& scene, WarningCounter& warnings);

}  // namespace scumble
