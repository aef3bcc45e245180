// glTF materials and the pictures they use.
#pragma once

#include <filesystem>
#include <string>

#include "core/image/status.h"
#include "guidegen/load/loader_util.h"
#include "guidegen/scene/scene.h"

namespace tinygltf {
class Model;
}

namespace scumble {

// Appends every material of the file to scene.materials, in the file's order, and keeps the pictures that their base
// colours, normal maps, roughness, metalness and emission use (others are never looked at) as encoded textures. That
// one is missing or cannot be decoded is an error which names it, once it is to be decoded. A material that has no
// colour but that of KHR_materials_pbrSpecularGlossiness is not metallic and takes its diffuse colour and texture and
// its glossiness, with a warning of what is lost. Images in one part of a buffer share its bytes; that they lie on each
// other otherwise, more than the buffers hold, is an error now.
Status LoadGltfMaterials(const tinygltf::Model& model, const std::string& file, Scene& scene, WarningCounter& warnings);

}  // namespace scumble
