#include "guidegen/load/gltf/mesh_tangents.h"

#include <bit>
#include <map>

#include "guidegen/load/split_vertices.h"
#include "guidegen/load/tangents.h"

namespace scumble {
namespace {

// Cycles' tangents are those of the UV map itself, whatever the texture's own place in it is.
glm::mat3 TransformOf(const Material& material) {
  return material.normal_rule == NormalMapRule::kGltf ? material.normal_texture.uv_transform : glm::mat3(1.0f);
}

}  // namespace

void SplitDeformation(std::span<const std::uint32_t> sources, MeshDeformation& deformation) {
  for (MorphTarget& target : deformation.targets) {
    Split(sources, target.positions);
    Split(sources, target.normals);
    Split(sources, target.tangents);
  }
  Split(sources, deformation.shared_normals);
  Split(sources, deformation.joints, std::size_t(deformation.influences));
  Split(sources, deformation.weights, std::size_t(deformation.influences));
  Split(sources, deformation.normals);
}

Mesh& TangentMaker::MeshOf(const Part& part) const {
  return load_.scene.meshes[std::size_t(loaded_[part.primitive].mesh)];
}

const Material& TangentMaker::MaterialOf(const Part& part) const {
  return load_.scene.materials[std::size_t(MeshOf(part).material)];
}

TangentMaker::Key TangentMaker::KeyOf(const Part& part) const {
  const glm::mat3 transform = TransformOf(MaterialOf(part));
  Key key = {std::uint32_t(MaterialOf(part).normal_texture.uv_set)};
  for (std::size_t i = 0; i < 9; ++i) {
    key[i + 1] = std::bit_cast<std::uint32_t>(transform[int(i / 3)][int(i % 3)] + 0.0f);
  }
  return key;
}

Status TangentMaker::Make(std::span<DeformableMesh> loaded) {
  loaded_ = loaded;
  std::map<Key, std::vector<const Part*>> by_coordinates;
  std::vector<Key> order;
  for (const Part& part : parts_) {
    if (!part.wanted) continue;
    std::vector<const Part*>& list = by_coordinates[KeyOf(part)];
    if (list.empty()) order.push_back(KeyOf(part));
    list.push_back(&part);
  }
  for (const Key& key : order) SCUMBLE_RETURN_IF_ERROR(MakeOf(by_coordinates[key], &key == &order.front()));
  return Ok();
}

Status TangentMaker::MakeOf(const std::vector<const Part*>& own, bool with_others) {
  const Material& material = MaterialOf(*own.front());
  const int uv_set = material.normal_texture.uv_set;
  std::vector<const Part*> chosen = own;
  for (const Part& part : parts_) {
    if (!with_others) break;
    const bool is_own = part.wanted && KeyOf(part) == KeyOf(*own.front());
    if (!is_own && !MeshOf(part).uvs[std::size_t(uv_set)].empty()) chosen.push_back(&part);
  }
  std::vector<TangentPart> parts;
  std::vector<std::size_t> before;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    parts.push_back({&MeshOf(*chosen[i]), i < own.size(), chosen[i]->exact_v});
    before.push_back(MeshOf(*chosen[i]).positions.size());
  }
  const auto sources = FillTangents(parts, uv_set, TransformOf(material));
  for (std::size_t i = 0; i < own.size(); ++i) {
    const Mesh& mesh = MeshOf(*own[i]);
    MeshDeformation& deformation = loaded_[own[i]->primitive].deformation;
    const std::uint64_t more = mesh.positions.size() - before[i];
    SCUMBLE_RETURN_IF_ERROR(load_.budget.Take(load_.file, more * (1 + deformation.targets.size()), 0));
    if (deformation.normals.empty()) continue;
    SplitDeformation(sources[i], deformation);
    deformation.tangents = mesh.tangents;
  }
  return Ok();
}

}  // namespace scumble
