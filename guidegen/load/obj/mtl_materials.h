// Materials of Wavefront's MTL, as guidegen/load/obj/obj.h describes them.
#pragma once

#include <tiny_obj_loader.h>

#include <map>
#include <string>
#include <vector>

#include "guidegen/load/loader_util.h"
#include "guidegen/scene.h"

namespace scumble {

struct MtlLibrary {
  std::vector<tinyobj::material_t> materials;
  std::map<std::string, int> textures;  // indices of the scene's textures, by the library's names
};

// The textures of a material, by name; for MakeMaterial they must be among the library's.
std::vector<std::string> TexturesOf(const tinyobj::material_t& material);

// A material of the library, without a name. Textures that the scene leaves out are ignored.
Material MakeMaterial(const MtlLibrary& library, std::size_t index, const Scene& scene);

// Warns of what MakeMaterial does not read and would show: textures, and transparency, which is cut at one half.
void WarnOfLeftOut(const tinyobj::material_t& from, const Material& material, WarningCounter& warnings);

}  // namespace scumble
