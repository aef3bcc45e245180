#include "guidegen/pure_materials.h"

#include <cstddef>

namespace scumble {

std::vector<std::string> UsePureMaterials(Scene& scene) {
  std::vector<bool> worn(scene.materials.size(), false);
  for (const Instance& instance : scene.instances) {
    worn[static_cast<std::size_t>(scene.meshes[static_cast<std::size_t>(instance.mesh)].material)] = true;
  }
  std::vector<std::string> replaced;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    Material& material = scene.materials[i];
    if (material.bsdf != Bsdf::kMetallicRoughness) continue;
    const bool textured = material.metallic_roughness_texture.texture >= 0;
    material.bsdf = textured || material.metallic < 0.5f ? Bsdf::kDiffuse : Bsdf::kGlossy;
    if (worn[i]) replaced.push_back(material.name);
  }
  return replaced;
}

}  // namespace scumble
