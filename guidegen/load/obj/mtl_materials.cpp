#include "guidegen/load/obj/mtl_materials.h"

#include <algorithm>
#include <cmath>

namespace scumble {
namespace {

// MTL's illumination model of metals.
constexpr int kMetalIllumination = 3;

// tinyobjloader's numbers are floats or doubles, as it was built.
glm::vec3 Color(const tinyobj::real_t* from) {
  glm::vec3 color;
  for (int c = 0; c < 3; ++c) {
    const auto value = static_cast<float>(from[c]);
    color[c] = std::isfinite(value) ? std::max(value, 0.0f) : 0.0f;
  }
  return color;
}

// From 0 to `most`; 0 for NaN.
float UpTo(tinyobj::real_t from, float most) {
  const auto value = static_cast<float>(from);
  return std::isfinite(value) ? std::clamp(value, 0.0f, most) : 0.0f;
}

TextureUse UseTexture(const MtlLibrary& library, const Scene& scene, const std::string& name,
                      const tinyobj::texture_option_t& options) {
  TextureUse use;
  if (name.empty()) return use;
  use.texture = library.textures.at(name);
  const auto index = std::size_t(use.texture);
  const bool encoded = index < scene.encoded_textures.size() && scene.encoded_textures[index];
  if (!encoded && scene.textures[index].empty()) use.texture = -1;
  if (options.clamp) use.wrap_u = use.wrap_v = TextureWrap::kClamp;
  // MTL scales and shifts coordinates whose v points up; ours points down.
  const auto su = static_cast<float>(options.scale[0]), sv = static_cast<float>(options.scale[1]);
  const auto right = static_cast<float>(options.origin_offset[0]), up = static_cast<float>(options.origin_offset[1]);
  use.uv_transform[0][0] = su;
  use.uv_transform[1][1] = sv;
  use.uv_transform[2] = glm::vec3(right, 1.0f - sv - up, 1.0f);
  return use;
}

// MTL has a colour, a highlight and its exponent. They are read as Blender 3.4 reads and writes them. A highlight only
// means that there is a coat: its strength is glTF's.
void SetLighting(const tinyobj::material_t& from, Material& material) {
  const glm::vec3 highlight = Color(from.specular);
  material.roughness = 1.0f - std::sqrt(UpTo(from.shininess, 1000.0f) / 1000.0f);
  if (from.illum == kMetalIllumination) {
    const glm::vec3 metallic = Color(from.ambient);
    material.metallic = UpTo((metallic.r + metallic.g + metallic.b) / 3.0f, 1.0f);
  }
  // Pr and Pm of the format's later extension; their absence reads as 0.
  if (from.roughness > 0.0f) material.roughness = UpTo(from.roughness, 1.0f);
  if (from.metallic > 0.0f) material.metallic = UpTo(from.metallic, 1.0f);
  const bool says_pbr = from.roughness > 0.0f || material.metallic > 0.0f;
  if (highlight == glm::vec3(0.0f) && !says_pbr) {
    material.bsdf = Bsdf::kDiffuse;
    material.roughness = 1.0f;
  } else if (glm::vec3(material.base_color) == glm::vec3(0.0f)) {
    material.bsdf = Bsdf::kGlossy;  // all its colour is in the highlight, as metals were written before Pm
    material.base_color = glm::vec4(glm::min(highlight, 1.0f), material.base_color.a);
  }
}

}  // namespace

std::vector<std::string> TexturesOf(const tinyobj::material_t& material) {
  std::vector<std::string> names = {material.diffuse_texname, material.normal_texname, material.emissive_texname};
  std::erase(names, "");
  return names;
}

Material MakeMaterial(const MtlLibrary& library, std::size_t index, const Scene& scene) {
  const tinyobj::material_t& from = library.materials[index];
  Material material;
  material.base_color_texture = UseTexture(library, scene, from.diffuse_texname, from.diffuse_texopt);
  material.normal_texture = UseTexture(library, scene, from.normal_texname, from.normal_texopt);
  for (int c = 0; c < 3; ++c) {
    const float kd = material.base_color_texture.texture >= 0 ? 1.0f : static_cast<float>(from.diffuse[c]);
    material.base_color[c] = std::isfinite(kd) ? std::max(kd, 0.0f) : 1.0f;
  }
  material.base_color.a = std::isfinite(static_cast<float>(from.dissolve)) ? UpTo(from.dissolve, 1.0f) : 1.0f;
  const bool has_cutout = !from.alpha_texname.empty() && from.alpha_texname == from.diffuse_texname;
  if (material.base_color.a < 1.0f || has_cutout) material.alpha_mode = AlphaMode::kBlend;
  SetLighting(from, material);
  material.emission_texture = UseTexture(library, scene, from.emissive_texname, from.emissive_texopt);
  material.emission = material.emission_texture.texture >= 0 ? glm::vec3(1.0f) : Color(from.emission);
  return material;
}

void WarnOfLeftOut(const tinyobj::material_t& from, const Material& material, WarningCounter& warnings) {
  const std::string name = "'" + Excerpt(from.name, 80) + "'";
  if (!from.alpha_texname.empty() && from.alpha_texname != from.diffuse_texname)
    warnings.Add("a map_d other than map_Kd is left out, its surface is opaque: put it into map_Kd's alpha", name);
  if (!from.bump_texname.empty() && from.normal_texname.empty())
    warnings.Add("map_Bump is left out: a normal map is read under the keyword norm", name);
  WarnOfCutAlpha(material, "material " + name, warnings);
}

}  // namespace scumble
