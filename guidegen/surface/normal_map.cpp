#include "guidegen/surface/normal_map.h"

#include <algorithm>
#include <cmath>

#include "core/image/color.h"
#include "guidegen/surface/interpolate.h"
#include "guidegen/surface/texture.h"

namespace scumble {
namespace {

bool IsOfObject(NormalMapRule rule) { return rule == NormalMapRule::kObject || rule == NormalMapRule::kBlenderObject; }

// From the axes of Blender's object space to glTF's.
glm::dvec3 OfBlendersAxes(const glm::dvec3& v) { return {v.x, v.z, -v.y}; }

double HeightAt(const PlacedObject& object, const glm::uvec3& corners, const glm::dvec2& barycentric) {
  const Bump& bump = object.material->bump;
  const TextureUse& use = bump.height_texture;
  glm::vec4 texel = SampleRaw(*FindTexture(object, use), use,
                              Interpolate(object.mesh->uvs[std::size_t(use.uv_set)], corners, barycentric));
  if (bump.srgb) {
    for (int i = 0; i < 3; ++i) texel[i] = SrgbToLinear(texel[i]);
  }
  return glm::dot(glm::dvec3(texel), glm::dvec3(0.2126, 0.7152, 0.0722));
}

// Cycles 4 applies a tangent map's strength to the map's value, Cycles 3 to the normal that results.
bool IsOfCycles4(const Material& material) {
  return material.cycles4 && material.normal_rule == NormalMapRule::kTangent;
}

}  // namespace

bool HasNormalMap(const PlacedObject& object) {
  const Material& material = *object.material;
  if (!FindTexture(object, material.normal_texture)) return false;
  return IsOfObject(material.normal_rule) || !object.mesh->tangents.empty();
}

bool HasBump(const PlacedObject& object) { return FindTexture(object, object.material->bump.height_texture); }

glm::dvec3 MappedNormal(const PlacedObject& object, const glm::uvec3& corners, const glm::dvec2& barycentric) {
  const Mesh& mesh = *object.mesh;
  const Material& material = *object.material;
  const TextureUse& use = material.normal_texture;
  const glm::vec4 texel =
      SampleRaw(*FindTexture(object, use), use, Interpolate(mesh.uvs[std::size_t(use.uv_set)], corners, barycentric));
  glm::dvec3 bend = glm::dvec3(texel) * 2.0 - 1.0;
  const bool stretched = mesh.stretch != glm::dmat3(1.0);
  const auto in_mesh = [&](const glm::dvec3& normal) {
    return stretched ? glm::inverse(glm::transpose(mesh.stretch)) * normal : normal;
  };
  if (material.normal_rule == NormalMapRule::kObject) return in_mesh(OfBlendersAxes(bend));
  if (material.normal_rule == NormalMapRule::kBlenderObject) {
    return in_mesh(OfBlendersAxes({bend.x, -bend.y, -bend.z}));
  }
  const double strength = std::max(material.normal_scale, 0.0f);
  if (material.normal_rule == NormalMapRule::kGltf) bend *= glm::dvec3(material.normal_scale, material.normal_scale, 1);
  if (IsOfCycles4(material)) {
    bend = {bend.x * strength, bend.y * strength, glm::mix(1.0, bend.z, std::min(strength, 1.0))};
  }
  const auto normal_at = [&](std::uint32_t corner) {
    const glm::dvec3 normal(mesh.normals[corner]);
    return stretched ? glm::normalize(glm::transpose(mesh.stretch) * normal) : normal;
  };
  const glm::dvec3 normal = normal_at(corners.x) * (1.0 - barycentric.x - barycentric.y) +
                            normal_at(corners.y) * barycentric.x + normal_at(corners.z) * barycentric.y;
  const glm::dvec4 tangent = Interpolate(mesh.tangents, corners, barycentric);
  const glm::dvec3 across = glm::cross(normal, glm::dvec3(tangent)) * (tangent.w < 0.0 ? -1.0 : 1.0);
  return in_mesh(glm::dvec3(tangent) * bend.x + across * bend.y + normal * bend.z);
}

glm::dvec3 MixedNormal(const PlacedObject& object, const glm::dvec3& mapped, const glm::dvec3& smooth) {
  const double strength = std::max(object.material->normal_scale, 0.0f);
  if (object.material->normal_rule == NormalMapRule::kGltf || IsOfCycles4(*object.material)) return mapped;
  if (strength == 1.0) return mapped;
  glm::dvec3 mixed = smooth + (mapped - smooth) * strength;
  return MakeUnit(mixed) ? mixed : smooth;
}

glm::dvec3 BumpedNormal(const PlacedObject& object, const glm::uvec3& corners, const Triangle& triangle,
                        const BumpPlace& place, const glm::dvec3& normal) {
  glm::dvec3 first = glm::cross(object.bump_axis, place.facing);
  if (!(place.width > 0.0) || !MakeUnit(first)) return normal;
  const glm::dvec3 dx = first * place.width, dy = glm::cross(place.facing, first) * place.width;
  // A step in the plane, in barycentrics: by the edges' dual vectors.
  const glm::dvec3 edge1 = triangle.corner[1] - triangle.corner[0], edge2 = triangle.corner[2] - triangle.corner[0];
  const glm::dvec3 area = glm::cross(edge1, edge2);
  const double squared = glm::dot(area, area);
  if (!(squared > kLeastPlainSquare && squared < kLargestPlainSquare)) return normal;
  const auto height_at = [&](const glm::dvec3& step) {
    const glm::dvec2 move(glm::dot(glm::cross(edge2, area), step), glm::dot(glm::cross(area, edge1), step));
    return HeightAt(object, corners, place.barycentric + move * (place.side / squared));
  };
  const double height = HeightAt(object, corners, place.barycentric);
  const glm::dvec3 across_x = glm::cross(dy, normal), across_y = glm::cross(normal, dx);
  const double det = glm::dot(dx, across_x);
  const glm::dvec3 gradient = across_x * (height_at(dx) - height) + across_y * (height_at(dy) - height);
  const Bump& bump = object.material->bump;
  glm::dvec3 risen = normal * std::abs(det) - gradient * (double(bump.distance) * (det < 0.0 ? -1.0 : 1.0));
  if (!MakeUnit(risen)) return normal;
  const double strength = std::max(bump.strength, 0.0f);
  glm::dvec3 mixed = risen * strength + normal * (1.0 - strength);
  return MakeUnit(mixed) ? mixed : normal;
}

}  // namespace scumble
