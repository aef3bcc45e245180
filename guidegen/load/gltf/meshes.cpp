#include "guidegen/load/gltf/meshes.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "guidegen/load/auto_smooth.h"
#include "guidegen/load/gltf/accessor.h"
#include "guidegen/load/gltf/curves.h"
#include "guidegen/load/gltf/gltf_extras.h"
#include "guidegen/load/gltf/mesh_tangents.h"
#include "guidegen/load/mesh_normals.h"

namespace scumble {
namespace {

std::uint64_t TriangleCount(int mode, std::uint64_t corners) {
  if (mode == TINYGLTF_MODE_TRIANGLES) return corners / 3;
  return corners < 3 ? 0 : corners - 2;
}

// Corner numbers of triangle i of a list, strip or fan; odd triangles of a strip are reversed.
glm::uvec3 TriangleCorners(int mode, std::uint32_t i) {
  if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) return {i, i + 1 + i % 2, i + 2 - i % 2};
  if (mode == TINYGLTF_MODE_TRIANGLE_FAN) return {i + 1, i + 2, 0};
  return {3 * i, 3 * i + 1, 3 * i + 2};
}

// Loads one primitive; the members are shared arguments.
class PrimitiveLoader {
 public:
  PrimitiveLoader(const GltfLoad& load, const tinygltf::Primitive& primitive, std::string name,
                  const DeformationRequest* request)
      : load_(load),
        model_(load.model),
        file_(load.file),
        scene_(load.scene),
        budget_(load.budget),
        warnings_(load.warnings),
        primitive_(primitive),
        name_(std::move(name)),
        request_(request),
        shared_choice_(load.choice),
        missing_(load.missing) {}

  // After Load: whether the mesh is to get tangents, which are common to the primitives of a mesh.
  bool wants_tangents() const { return wants_tangents_; }
  std::vector<float> TakeExactV() { return std::move(exact_v_); }

  void SetStretch(const glm::dmat3& stretch) { mesh_.stretch = stretch; }

  // After Load, where one was requested.
  MeshDeformation TakeDeformation() { return std::move(deformation_); }

  // Empty for primitives that are left out.
  Expected<std::optional<Mesh>> Load() {
    SCUMBLE_ASSIGN(std::optional<Curves> curves, ReadCurvesExtras(primitive_, file_ + ": " + name_));
    if (curves) {
      if (request_) return InputError(file_ + ": " + name_ + " is hair, which cannot be deformed; export each frame");
      SCUMBLE_ASSIGN(mesh_, LoadCurves(load_, primitive_, name_, *std::move(curves)));
      SCUMBLE_RETURN_IF_ERROR(ChooseMaterial());
      return mesh_.IsCurves() ? std::optional<Mesh>(std::move(mesh_)) : std::nullopt;
    }
    if (primitive_.mode < TINYGLTF_MODE_TRIANGLES || primitive_.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
      warnings_.Add("points and lines are left out, only triangles are seen", name_);
      return std::optional<Mesh>();
    }
    const int position = Accessor("POSITION");
    if (position < 0) {
      warnings_.Add("primitives without positions are left out", name_);
      return std::optional<Mesh>();
    }
    SCUMBLE_ASSIGN(vertices_, AccessorCount(model_, file_, position, name_ + ", POSITION"));
    std::size_t corners = vertices_;
    if (primitive_.indices >= 0) {
      SCUMBLE_ASSIGN(corners, AccessorCount(model_, file_, primitive_.indices, name_ + ", indices"));
    }
    SCUMBLE_RETURN_IF_ERROR(budget_.Take(file_, 0, TriangleCount(primitive_.mode, corners)));
    SCUMBLE_RETURN_IF_ERROR(ReadTriangles());
    if (mesh_.triangles.size() < vertices_ / 4) ChooseVertices();
    SCUMBLE_RETURN_IF_ERROR(budget_.Take(file_, choice_ ? choice_->elements().size() + SparseValues() : vertices_, 0));
    SCUMBLE_RETURN_IF_ERROR(ReadPlaces(position, "POSITION", mesh_.positions));
    SCUMBLE_RETURN_IF_ERROR(ReadAttributes());
    if (request_) {
      SCUMBLE_RETURN_IF_ERROR(ReadTargets());
      SCUMBLE_RETURN_IF_ERROR(ReadInfluences());
    } else if (const int rest = Accessor("_SCUMBLE_REST"); rest >= 0) {
      SCUMBLE_RETURN_IF_ERROR(ReadPlaces(rest, "_SCUMBLE_REST", mesh_.rest_positions));
    }
    SCUMBLE_RETURN_IF_ERROR(ChooseMaterial());
    if (mesh_.triangles.empty()) {
      warnings_.Add("primitives without a triangle are left out", name_);
      return std::optional<Mesh>();
    }
    SCUMBLE_RETURN_IF_ERROR(MakeNormals());
    PrepareTangents(scene_.materials[std::size_t(mesh_.material)]);
    if (request_) {
      mesh_.rest_positions = mesh_.positions;
      deformation_.normals = mesh_.normals;
      deformation_.tangents = mesh_.tangents;
    }
    return std::optional<Mesh>(std::move(mesh_));
  }

 private:
  int Accessor(const std::string& attribute) const {
    const auto it = primitive_.attributes.find(attribute);
    return it == primitive_.attributes.end() ? -1 : it->second;
  }

  // Exporters share one long vertex list between many primitives. Only the vertices that the triangles use are read, in
  // the order of first use, and the triangles are renumbered. Reading the whole list for each primitive would take
  // quadratic time.
  void ChooseVertices() {
    shared_choice_.Clear();
    for (glm::uvec3& triangle : mesh_.triangles) {
      for (int i = 0; i < 3; ++i) triangle[i] = shared_choice_.Add(triangle[i]);
    }
    choice_ = &shared_choice_;
  }

  // A vertex's number in the file.
  std::size_t NumberInFile(std::size_t vertex) const { return choice_ ? choice_->elements()[vertex] : vertex; }

  // Values of all accessors that may be read. Where vertices are chosen, these are still visited, and count as
  // vertices.
  std::uint64_t SparseValues() const {
    std::uint64_t values = 0;
    const auto add = [&](const std::map<std::string, int>& attributes) {
      for (const auto& [attribute, accessor] : attributes) {
        if (accessor < 0 || std::size_t(accessor) >= model_.accessors.size()) continue;
        const auto& sparse = model_.accessors[std::size_t(accessor)].sparse;
        if (sparse.isSparse) values += std::uint64_t(std::max(sparse.count, 0));
      }
    };
    add(primitive_.attributes);
    if (request_ && request_->targets > 0) {
      for (const auto& target : primitive_.targets) add(target);
    }
    return values;
  }

  // The mesh's vertices of an accessor, which must have an element for each vertex of the file.
  Expected<FloatTable> ReadVertices(int accessor, const std::string& attribute) {
    const std::string what = name_ + ", " + attribute;
    SCUMBLE_ASSIGN(const std::size_t count, AccessorCount(model_, file_, accessor, what));
    if (count != vertices_) {
      return InputError(file_ + ": " + what + ": accessor " + std::to_string(accessor) + " has " +
                        std::to_string(count) + " elements for " + std::to_string(vertices_) +
                        " positions; expected as many");
    }
    return ReadFloats(model_, file_, accessor, what, choice_);
  }

  Status ReadPlaces(int accessor, const std::string& attribute, std::vector<glm::vec3>& places) {
    const std::string where = file_ + ": " + name_ + ", " + attribute;
    SCUMBLE_ASSIGN(const FloatTable table, ReadVertices(accessor, attribute));
    if (table.components != 3) return InputError(where + ": expected three components");
    places.resize(table.count);
    for (std::size_t i = 0; i < table.count; ++i) {
      const glm::vec3 place(table.values[3 * i], table.values[3 * i + 1], table.values[3 * i + 2]);
      if (!IsFinite(place)) {
        return InputError(where + ": accessor " + std::to_string(accessor) + " has NaN or infinity at vertex " +
                          std::to_string(NumberInFile(i)) + "; expected finite numbers");
      }
      places[i] = place;
    }
    return Ok();
  }

  Status ReadTriangles() {
    std::vector<std::uint32_t> indices;
    const bool indexed = primitive_.indices >= 0;
    if (indexed) {
      SCUMBLE_ASSIGN(indices, ReadIndices(model_, file_, primitive_.indices, vertices_, name_ + ", indices"));
    }
    const std::uint64_t corners = indexed ? indices.size() : vertices_;
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

  // Reads an attribute, if the primitive has it, and passes each row to put(vertex, values).
  template <class Put>
  Status ReadAttribute(const std::string& attribute, int min_components, int max_components, Put put) {
    const int accessor = Accessor(attribute);
    return accessor < 0 ? Ok() : ReadRows(accessor, attribute, min_components, max_components, put);
  }

  template <class Put>
  Status ReadRows(int accessor, const std::string& attribute, int min_components, int max_components, Put put) {
    SCUMBLE_ASSIGN(const FloatTable table, ReadVertices(accessor, attribute));
    if (table.components < min_components || table.components > max_components) {
      return InputError(file_ + ": " + name_ + ", " + attribute + ": accessor " + std::to_string(accessor) + " has " +
                        std::to_string(table.components) + " components; expected " + std::to_string(min_components));
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
    if (Accessor("_SCUMBLE_V") >= 0) exact_v_.resize(n);
    SCUMBLE_RETURN_IF_ERROR(ReadAttribute(
        "_SCUMBLE_V", 1, 1, [&](std::size_t i, const float* v, const FloatTable&) { exact_v_[i] = v[0]; }));
    if (Accessor("COLOR_0") >= 0) mesh_.colors.resize(n);
    return ReadAttribute("COLOR_0", 3, 4, [&](std::size_t i, const float* v, const FloatTable& table) {
      mesh_.colors[i] = glm::vec4(v[0], v[1], v[2], table.components == 4 ? v[3] : 1.0f);
      if (IsFinite(mesh_.colors[i])) return;
      mesh_.colors[i] = glm::vec4(1.0f);
      warnings_.Add("vertex colours that are NaN or infinite count as white", name_);
    });
  }

  Status ReadTargets() {
    if (request_->targets == 0) return Ok();
    const std::size_t vertices = mesh_.positions.size();
    if (primitive_.targets.size() != request_->targets) {
      return InputError(file_ + ": " + name_ + " has " + std::to_string(primitive_.targets.size()) +
                        " morph targets for " + std::to_string(request_->targets) + " weights; expected as many");
    }
    deformation_.targets.resize(request_->targets);
    for (std::size_t i = 0; i < request_->targets; ++i) {
      MorphTarget& target = deformation_.targets[i];
      const auto read = [&](const std::string& attribute, std::vector<glm::vec3>& deltas) -> Status {
        const auto it = primitive_.targets[i].find(attribute);
        if (it == primitive_.targets[i].end()) return Ok();
        // Values of targets count as geometry: a sparse accessor declares any number of them with a few bytes.
        SCUMBLE_RETURN_IF_ERROR(budget_.Take(file_, vertices, 0));
        deltas.resize(vertices);
        std::size_t broken = vertices;
        const std::string what = "morph target " + std::to_string(i) + ", " + attribute;
        SCUMBLE_RETURN_IF_ERROR(ReadRows(it->second, what, 3, 3, [&](std::size_t v, const float* d, const FloatTable&) {
          deltas[v] = glm::vec3(d[0], d[1], d[2]);
          if (!IsFinite(deltas[v])) broken = std::min(broken, v);
        }));
        if (broken == vertices) return Ok();
        return InputError(file_ + ": " + name_ + ", " + what + ": accessor " + std::to_string(it->second) +
                          " has NaN or infinity at vertex " + std::to_string(NumberInFile(broken)) +
                          "; expected finite numbers");
      };
      SCUMBLE_RETURN_IF_ERROR(read("POSITION", target.positions));
      SCUMBLE_RETURN_IF_ERROR(read("NORMAL", target.normals));
      if (!mesh_.tangents.empty()) SCUMBLE_RETURN_IF_ERROR(read("TANGENT", target.tangents));
    }
    return Ok();
  }

  // Joints and weights, four of each in a set: JOINTS_0 and WEIGHTS_0, then further sets.
  Status ReadInfluences() {
    if (request_->joints == 0) return Ok();
    int sets = 0;
    while (Accessor("JOINTS_" + std::to_string(sets)) >= 0 && Accessor("WEIGHTS_" + std::to_string(sets)) >= 0) ++sets;
    if (sets == 0) {
      warnings_.Add("skinned meshes without JOINTS_0 and WEIGHTS_0 stand where their node does", name_);
      return Ok();
    }
    const std::size_t vertices = mesh_.positions.size();
    const std::size_t influences = 4 * std::size_t(sets);
    SCUMBLE_RETURN_IF_ERROR(budget_.Take(file_, vertices * std::uint64_t(sets), 0));
    deformation_.influences = static_cast<int>(influences);
    deformation_.joints.resize(vertices * influences);
    deformation_.weights.resize(vertices * influences);
    for (int set = 0; set < sets; ++set) SCUMBLE_RETURN_IF_ERROR(ReadInfluenceSet(set));
    return CheckInfluences();
  }

  Status ReadInfluenceSet(int set) {
    const std::size_t influences = std::size_t(deformation_.influences);
    const std::string joints = "JOINTS_" + std::to_string(set), weights = "WEIGHTS_" + std::to_string(set);
    std::string fault;
    const auto complain = [&](const std::string& attribute, std::size_t vertex, const std::string& what) {
      if (!fault.empty()) return;
      fault = attribute + ": accessor " + std::to_string(Accessor(attribute)) + " has " + what + " at vertex " +
              std::to_string(NumberInFile(vertex));
    };
    SCUMBLE_RETURN_IF_ERROR(ReadAttribute(weights, 4, 4, [&](std::size_t v, const float* w, const FloatTable&) {
      for (std::size_t i = 0; i < 4; ++i) {
        deformation_.weights[v * influences + 4 * std::size_t(set) + i] = w[i];
        if (!(w[i] >= 0.0f) || !std::isfinite(w[i])) complain(weights, v, "the weight " + std::to_string(w[i]));
      }
    }));
    SCUMBLE_RETURN_IF_ERROR(ReadAttribute(joints, 4, 4, [&](std::size_t v, const float* j, const FloatTable&) {
      for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t at = v * influences + 4 * std::size_t(set) + i;
        const bool exists = j[i] >= 0.0f && j[i] < float(std::min<std::size_t>(request_->joints, 65536));
        deformation_.joints[at] = exists ? static_cast<std::uint16_t>(j[i]) : std::uint16_t(0);
        // A joint of weight 0 may be invalid: some exporters leave it undefined.
        if (!exists && deformation_.weights[at] > 0.0f) {
          complain(joints, v, "joint " + std::to_string(j[i]) + " of " + std::to_string(request_->joints));
        }
      }
    }));
    const tinygltf::Accessor& accessor = model_.accessors[std::size_t(Accessor(joints))];
    const bool whole = accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                       accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    if (!whole || accessor.normalized) {
      fault = joints + ": accessor " + std::to_string(Accessor(joints)) + " does not hold unsigned bytes or shorts";
    }
    if (fault.empty()) return Ok();
    return InputError(file_ + ": " + name_ + ", " + fault + "; the file is corrupt, export it again");
  }

  Status CheckInfluences() {
    const std::size_t influences = std::size_t(deformation_.influences);
    for (std::size_t first = 0; first < deformation_.weights.size(); first += influences) {
      double sum = 0.0;
      for (std::size_t i = 0; i < influences; ++i) sum += double(deformation_.weights[first + i]);
      if (!(sum > 0.0)) warnings_.Add("vertices without a weight follow the first joint that they name", name_);
    }
    return Ok();
  }

  // Without normals of its own a mesh is flat, and its tangents mean nothing (glTF 2.0, section 3.7.2.1).
  Status MakeNormals() {
    if (std::none_of(mesh_.normals.begin(), mesh_.normals.end(), HasDirection)) {
      if (!mesh_.normals.empty()) warnings_.Add("normals without a direction were computed anew", name_);
      mesh_.normals.clear();
    }
    if (!mesh_.normals.empty()) {
      if (FillNormals(mesh_) > 0) warnings_.Add("normals without a direction were computed anew", name_);
      return Ok();
    }
    mesh_.tangents.clear();
    const double degrees = *missing_.Take(MissingNormals::Rule::kFlat, mesh_.triangles.size());
    const std::vector<std::uint32_t> weld = WeldByPosition(mesh_.positions);
    const CornerNormals normals = AutoSmoothNormals({mesh_.positions, mesh_.triangles, weld, {}, !request_}, degrees);
    const std::size_t before = mesh_.positions.size();
    SplitVertices split = SetCornerNormals(normals, mesh_);
    const std::uint64_t more = mesh_.positions.size() - before;
    SCUMBLE_RETURN_IF_ERROR(budget_.Take(file_, more * (1 + deformation_.targets.size()), 0));
    if (!request_) return Ok();
    for (MorphTarget& target : deformation_.targets) {
      target.normals.clear();
      target.tangents.clear();
    }
    SplitDeformation(split.sources, deformation_);
    deformation_.shared_normals = degrees == 180.0 ? weld : std::move(split.shared);
    return Ok();
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

  // Keeps tangents only where a normal map needs them; computes them where the file gives none that are usable.
  void PrepareTangents(const Material& material) {
    const TextureUse& use = material.normal_texture;
    const bool of_object =
        material.normal_rule == NormalMapRule::kObject || material.normal_rule == NormalMapRule::kBlenderObject;
    if (use.texture < 0 || of_object) {
      mesh_.tangents.clear();
    } else if (TangentsAreUsable()) {
      for (glm::vec4& tangent : mesh_.tangents) {
        tangent = glm::vec4(glm::normalize(glm::vec3(tangent)), tangent.w);
      }
    } else if (!mesh_.uvs[std::size_t(use.uv_set)].empty()) {
      wants_tangents_ = true;
    } else {
      mesh_.tangents.clear();
      warnings_.Add("normal maps on meshes without texture coordinates are left out", name_);
    }
    const TextureUse& color = material.base_color_texture;
    if (color.texture >= 0 && mesh_.uvs[std::size_t(color.uv_set)].empty()) {
      warnings_.Add("textures on meshes without texture coordinates are left out", name_);
    }
  }

  const GltfLoad& load_;
  const tinygltf::Model& model_;
  const std::string& file_;
  Scene& scene_;
  GeometryBudget& budget_;
  WarningCounter& warnings_;
  const tinygltf::Primitive& primitive_;
  const std::string name_;
  const DeformationRequest* request_;
  ElementChoice& shared_choice_;
  MissingNormals& missing_;
  const ElementChoice* choice_ = nullptr;  // the chosen vertices of the file; null: all
  std::size_t vertices_ = 0;               // in the file
  Mesh mesh_;
  MeshDeformation deformation_;
  std::vector<float> exact_v_;  // TangentPart's
  bool wants_tangents_ = false;
};

// `request` may be null.
Expected<std::vector<DeformableMesh>> LoadPrimitives(const GltfLoad& load, int mesh_index,
                                                     const DeformationRequest* request) {
  const tinygltf::Mesh& mesh = load.model.meshes[std::size_t(mesh_index)];
  std::vector<DeformableMesh> loaded;
  TangentMaker maker(load);
  SCUMBLE_ASSIGN(const glm::dmat3 stretch, ReadMeshStretch(mesh, load.file + ": mesh " + std::to_string(mesh_index)));
  for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
    std::string name = "mesh " + std::to_string(mesh_index);
    if (!mesh.name.empty()) name += " '" + Excerpt(mesh.name, 80) + "'";
    if (mesh.primitives.size() > 1) name += ", primitive " + std::to_string(i);
    PrimitiveLoader loader(load, mesh.primitives[i], name, request);
    loader.SetStretch(stretch);
    SCUMBLE_ASSIGN(std::optional<Mesh> primitive, loader.Load());
    if (!primitive) continue;
    load.scene.meshes.push_back(std::move(*primitive));
    loaded.push_back({static_cast<int>(load.scene.meshes.size()) - 1, loader.TakeDeformation()});
    maker.Add(loader.wants_tangents(), loader.TakeExactV());
  }
  SCUMBLE_RETURN_IF_ERROR(maker.Make(loaded));
  return loaded;
}

}  // namespace

Expected<std::vector<int>> LoadGltfMesh(const GltfLoad& load, int mesh_index) {
  SCUMBLE_ASSIGN(const std::vector<DeformableMesh> loaded, LoadPrimitives(load, mesh_index, nullptr));
  std::vector<int> indices;
  for (const DeformableMesh& mesh : loaded) indices.push_back(mesh.mesh);
  return indices;
}

Expected<std::vector<DeformableMesh>> LoadDeformableMesh(const GltfLoad& load, int mesh_index,
                                                         const DeformationRequest& request) {
  return LoadPrimitives(load, mesh_index, &request);
}

}  // namespace scumble
