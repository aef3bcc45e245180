#include "guidegen/gltf_meshes.h"

#include <tiny_gltf.h>

#include <cmath>
#include <optional>

#include "guidegen/gltf_accessor.h"
#include "guidegen/mesh_normals.h"

namespace scumble {
namespace {

std::uint64_t TriangleCount(int mode, std::uint64_t corners) {
  if (mode == TINYGLTF_MODE_TRIANGLES) return corners / 3;
  return corners < 3 ? 0 : corners - 2;
}

// Corner numbers of triangle i of a list, strip or fan; odd triangles of a strip are turned round.
glm::uvec3 TriangleCorners(int mode, std::uint32_t i) {
  if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) return {i, i + 1 + i % 2, i + 2 - i % 2};
  if (mode == TINYGLTF_MODE_TRIANGLE_FAN) return {i + 1, i + 2, 0};
  return {3 * i, 3 * i + 1, 3 * i + 2};
}

// Drops the vertices that no triangle uses: exporters share one long vertex list between many primitives.
void DropUnusedVertices(Mesh& mesh) {
  constexpr std::uint32_t kUnused = ~0u;
  std::vector<std::uint32_t> renamed(mesh.positions.size(), kUnused);
  std::vector<std::uint32_t> kept;
  for (glm::uvec3& triangle : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      std::uint32_t& name = renamed[triangle[i]];
      if (name == kUnused) {
        name = static_cast<std::uint32_t>(kept.size());
        kept.push_back(triangle[i]);
      }
      triangle[i] = name;
    }
  }
  const auto gather = [&](auto& values) {
    if (values.empty()) return;
    std::remove_reference_t<decltype(values)> chosen;
    chosen.reserve(kept.size());
    for (std::uint32_t vertex : kept) chosen.push_back(values[vertex]);
    values = std::move(chosen);
  };
  gather(mesh.positions);
  gather(mesh.normals);
  gather(mesh.uvs[0]);
  gather(mesh.uvs[1]);
  gather(mesh.tangents);
  gather(mesh.colors);
}

// Loads one primitive; the members only save passing them on.
class PrimitiveLoader {
 public:
  PrimitiveLoader(const GltfLoad& load, const tinygltf::Primitive& primitive, std::string name)
      : model_(load.model),
        file_(load.file),
        scene_(load.scene),
        budget_(load.budget),
        warnings_(load.warnings),
        primitive_(primitive),
        name_(std::move(name)) {}

  // Nothing for primitives that are left out.
  Expected<std::optional<Mesh>> Load() {
    if (primitive_.mode < TINYGLTF_MODE_TRIANGLES || primitive_.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
      warnings_.Add("points and lines are left out, only triangles are seen", name_);
      return std::optional<Mesh>();
    }
    const int position = Accessor("POSITION");
    if (position < 0) {
      warnings_.Add("primitives without positions are left out", name_);
      return std::optional<Mesh>();
    }
    SCUMBLE_ASSIGN(const std::size_t vertices, AccessorCount(model_, file_, position, name_ + ", POSITION"));
    std::size_t corners = vertices;
    if (primitive_.indices >= 0) {
      SCUMBLE_ASSIGN(corners, AccessorCount(model_, file_, primitive_.indices, name_ + ", indices"));
    }
    SCUMBLE_RETURN_IF_ERROR(budget_.Take(file_, vertices, TriangleCount(primitive_.mode, corners)));
    SCUMBLE_RETURN_IF_ERROR(ReadPositions(position));
    SCUMBLE_RETURN_IF_ERROR(ReadTriangles());
    SCUMBLE_RETURN_IF_ERROR(ReadAttributes());
    SCUMBLE_RETURN_IF_ERROR(ChooseMaterial());
    if (mesh_.triangles.size() < mesh_.positions.size() / 4) {
      const std::size_t before = mesh_.positions.size();
      DropUnusedVertices(mesh_);
      budget_.GiveBackVertices(before - mesh_.positions.size());
    }
    if (mesh_.triangles.empty()) {
      warnings_.Add("primitives without a triangle are left out", name_);
      return std::optional<Mesh>();
    }
    if (FillNormals(mesh_) > 0) warnings_.Add("normals without a direction were computed anew", name_);
    PrepareTangents(scene_.materials[std::size_t(mesh_.material)]);
    return std::optional<Mesh>(std::move(mesh_));
  }

 private:
  int Accessor(const std::string& attribute) const {
    const auto it = primitive_.attributes.find(attribute);
    return it == primitive_.attributes.end() ? -1 : it->second;
  }

  Status ReadPositions(int accessor) {
    SCUMBLE_ASSIGN(const FloatTable table, ReadFloats(model_, file_, accessor, name_ + ", POSITION"));
    if (table.components != 3) return InputError(file_ + ": " + name_ + ", POSITION: expected three components");
    mesh_.positions.resize(table.count);
    for (std::size_t i = 0; i < table.count; ++i) {
      const glm::vec3 position(table.values[3 * i], table.values[3 * i + 1], table.values[3 * i + 2]);
      if (!IsFinite(position)) {
        return InputError(file_ + ": " + name_ + ", POSITION: accessor " + std::to_string(accessor) +
                          " has NaN or infinity at vertex " + std::to_string(i) + "; expected finite numbers");
      }
      mesh_.positions[i] = position;
    }
    return Ok();
  }

  Status ReadTriangles() {
    const std::size_t vertices = mesh_.positions.size();
    std::vector<std::uint32_t> indices;
    const bool indexed = primitive_.indices >= 0;
    if (indexed) {
      SCUMBLE_ASSIGN(indices, ReadIndices(model_, file_, primitive_.indices, vertices, name_ + ", indices"));
    }
    const std::uint64_t corners = indexed ? indices.size() : vertices;
    const std::uint64_t count = TriangleCount(primitive_.mode, corners);
    if (primitive_.mode == TINYGLTF_MODE_TRIANGLES && corners % 3 != 0) {
      warnings_.Add("incomplete triangles at the end of a list are left out", name_);
    }
    mesh_.triangles.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      glm::uvec3 triangle = TriangleCorners(primitive_.mode, i);
      if (indexed) triangle = {indices[triangle.x], indices[triangle.y], indices[triangle.z]};
      mesh_.triangles[i] = triangle;
    }
    return Ok();
  }

  // Reads an attribute, if the primitive has it, and hands put(vertex, values) each row.
  template <class Put>
  Status ReadAttribute(const std::string& attribute, int min_components, int max_components, Put put) {
    const int accessor = Accessor(attribute);
    if (accessor < 0) return Ok();
    SCUMBLE_ASSIGN(const FloatTable table, ReadFloats(model_, file_, accessor, name_ + ", " + attribute));
    if (table.components < min_components || table.components > max_components) {
      return InputError(file_ + ": " + name_ + ", " + attribute + ": accessor " + std::to_string(accessor) + " has " +
                        std::to_string(table.components) + " components; expected " + std::to_string(min_components));
    }
    if (table.count != mesh_.positions.size()) {
      return InputError(file_ + ": " + name_ + ", " + attribute + ": accessor " + std::to_string(accessor) + " has " +
                        std::to_string(table.count) + " elements for " + std::to_string(mesh_.positions.size()) +
                        " positions; expected as many");
    }
    for (std::size_t i = 0; i < table.count; ++i)
      put(i, table.values.data() + i * std::size_t(table.components), table);
    return Ok();
  }

  Status ReadAttributes() {
    const std::size_t n = mesh_.positions.size();
    if (Accessor("NORMAL") >= 0) mesh_.normals.resize(n);
    SCUMBLE_RETURN_IF_ERROR(ReadAttribute("NORMAL", 3, 3, [&](std::size_t i, const float* v, const FloatTable&) {
      mesh_.normals[i] = glm::vec3(v[0], v[1], v[2]);
    }));
    if (Accessor("TANGENT") >= 0) mesh_.tangents.resize(n);
    SCUMBLE_RETURN_IF_ERROR(ReadAttribute("TANGENT", 4, 4, [&](std::size_t i, const float* v, const FloatTable&) {
      mesh_.tangents[i] = glm::vec4(v[0], v[1], v[2], v[3] < 0.0f ? -1.0f : 1.0f);
    }));
    for (int set = 0; set < 2; ++set) {
      const std::string attribute = "TEXCOORD_" + std::to_string(set);
      std::vector<glm::vec2>& uvs = mesh_.uvs[std::size_t(set)];
      if (Accessor(attribute) >= 0) uvs.resize(n);
      SCUMBLE_RETURN_IF_ERROR(ReadAttribute(attribute, 2, 2, [&](std::size_t i, const float* v, const FloatTable&) {
        uvs[i] = glm::vec2(v[0], v[1]);
        if (IsFinite(uvs[i])) return;
        uvs[i] = glm::vec2(0.0f);
        warnings_.Add("texture coordinates that are NaN or infinite count as 0", name_);
      }));
    }
    if (Accessor("COLOR_0") >= 0) mesh_.colors.resize(n);
    return ReadAttribute("COLOR_0", 3, 4, [&](std::size_t i, const float* v, const FloatTable& table) {
      mesh_.colors[i] = glm::vec4(v[0], v[1], v[2], table.components == 4 ? v[3] : 1.0f);
      if (IsFinite(mesh_.colors[i])) return;
      mesh_.colors[i] = glm::vec4(1.0f);
      warnings_.Add("vertex colours that are NaN or infinite count as white", name_);
    });
  }

  Status ChooseMaterial() {
    if (primitive_.material < 0) {
      mesh_.material = DefaultMaterial(scene_);
      return Ok();
    }
    if (std::size_t(primitive_.material) >= model_.materials.size()) {
      return InputError(file_ + ": " + name_ + " uses material " + std::to_string(primitive_.material) +
                        ", the file has " + std::to_string(model_.materials.size()) + ": export it again");
    }
    mesh_.material = primitive_.material;
    return Ok();
  }

  bool TangentsAreUsable() const {
    if (mesh_.tangents.empty()) return false;
    for (const glm::vec4& tangent : mesh_.tangents) {
      const float length = glm::length(glm::vec3(tangent));
      if (!(length > 0.0f) || !std::isfinite(length)) return false;
    }
    return true;
  }

  // Keeps tangents only where a normal map needs them; computes them where the file gives none that can be used.
  void PrepareTangents(const Material& material) {
    const TextureUse& use = material.normal_texture;
    if (use.texture < 0) {
      mesh_.tangents.clear();
    } else if (TangentsAreUsable()) {
      for (glm::vec4& tangent : mesh_.tangents) {
        tangent = glm::vec4(glm::normalize(glm::vec3(tangent)), tangent.w);
      }
    } else if (!mesh_.uvs[std::size_t(use.uv_set)].empty()) {
      FillTangents(mesh_, use.uv_set, use.uv_transform);
    } else {
      mesh_.tangents.clear();
      warnings_.Add("normal maps on meshes without texture coordinates are left out", name_);
    }
    const TextureUse& color = material.base_color_texture;
    if (color.texture >= 0 && mesh_.uvs[std::size_t(color.uv_set)].empty()) {
      warnings_.Add("textures on meshes without texture coordinates are left out", name_);
    }
  }

  const tinygltf::Model& model_;
  const std::string& file_;
  Scene& scene_;
  GeometryBudget& budget_;
  WarningCounter& warnings_;
  const tinygltf::Primitive& primitive_;
  const std::string name_;
  Mesh mesh_;
};

}  // namespace

Expected<std::vector<int>> LoadGltfMesh(const GltfLoad& load, int mesh_index) {
  const tinygltf::Mesh& mesh = load.model.meshes[std::size_t(mesh_index)];
  std::vector<int> loaded;
  for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
    std::string name = "mesh " + std::to_string(mesh_index);
    if (!mesh.name.empty()) name += " '" + Excerpt(mesh.name, 80) + "'";
    if (mesh.primitives.size() > 1) name += ", primitive " + std::to_string(i);
    if (!mesh.primitives[i].targets.empty())
      load.warnings.Add("shape keys are ignored, meshes keep their rest shape", name);
    PrimitiveLoader loader(load, mesh.primitives[i], name);
    SCUMBLE_ASSIGN(std::optional<Mesh> primitive, loader.Load());
    if (!primitive) continue;
    load.scene.meshes.push_back(std::move(*primitive));
    loaded.push_back(static_cast<int>(load.scene.meshes.size()) - 1);
  }
  return loaded;
}

}  // namespace scumble
