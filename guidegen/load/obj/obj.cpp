#include "guidegen/load/obj/obj.h"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <memory>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "core/image/color.h"
#include "core/image/hash.h"
#include "core/io/picture_file.h"
#include "guidegen/load/auto_smooth.h"
#include "guidegen/load/loader_util.h"
#include "guidegen/load/mesh_normals.h"
#include "guidegen/load/obj/mtl_materials.h"
#include "guidegen/load/obj/obj_normals.h"
#include "guidegen/load/obj/obj_parse.h"
#include "guidegen/load/obj/obj_places.h"
#include "guidegen/load/tangents.h"

namespace scumble {
namespace {

// Corners that are equal share a vertex of their mesh.
struct CornerHash {
  std::size_t operator()(const ObjCorner& c) const { return Hash(c.position, c.uv, c.normal); }
};

class ObjLoader {
 public:
  ObjLoader(const std::filesystem::path& path, MissingNormals missing, const FileListener& on_file)
      : path_(path), file_(path.string()), missing_(missing), on_file_(on_file) {}

  Expected<Scene> Load() {
    SCUMBLE_RETURN_IF_ERROR(ParseObj(path_, on_file_, warnings_, contents_));
    SCUMBLE_RETURN_IF_ERROR(CheckAttributes());
    DropNormalsOfNone();
    for (std::size_t s = 0; s < shapes_.size(); ++s) SCUMBLE_RETURN_IF_ERROR(CheckShape(s));
    places_ = PlaceVertices(contents_);
    normals_.given = attributes_.normals;
    for (std::size_t s = 0; s < shapes_.size(); ++s) AddShape(s);
    SCUMBLE_RETURN_IF_ERROR(CheckHasTriangles());
    if (without_normals_ > 0) MakeNormals();
    LoadMaterials();
    BuildMeshes();
    WarnOfUsedMaterials();
    warnings_.MoveTo(scene_.warnings);
    missing_.Tell(scene_.notes);
    return std::move(scene_);
  }

 private:
  Status CheckAttributes() const {
    for (std::size_t i = 0; i < attributes_.vertices.size(); ++i) {
      if (!std::isfinite(static_cast<float>(attributes_.vertices[i]))) {
        return InputError(file_ + ": vertex " + std::to_string(i / 3 + 1) +
                          " is NaN or infinite; expected finite numbers");
      }
    }
    return Ok();
  }

  // Shapes of subdivision libraries name a normal at each corner, and hold none.
  void DropNormalsOfNone() {
    if (!attributes_.normals.empty()) return;
    for (tinyobj::shape_t& shape : shapes_) {
      bool is_named = false;
      for (tinyobj::index_t& index : shape.mesh.indices) {
        is_named |= index.normal_index >= 0;
        index.normal_index = -1;
      }
      if (!is_named) continue;
      warnings_.Add("faces name normals, but the file has none: they are taken for faces without",
                    "'" + Excerpt(shape.name, 80) + "'");
    }
  }

  // One of the file's lists that faces index.
  struct IndexedList {
    const char* what;
    std::size_t count;
    bool optional;
  };

  // An index of the file, counted from 0 and resolved; -1 means none where the list is optional.
  Status CheckIndex(int index, const IndexedList& list, const std::string& shape) const {
    if (index >= 0 ? std::size_t(index) < list.count : list.optional && index == -1) return Ok();
    return InputError(file_ + ": a face of '" + Excerpt(shape, 80) + "' uses " + list.what + " " +
                      std::to_string(std::int64_t(index) + 1) + ", but there are " + std::to_string(list.count) +
                      "; the file is corrupt or was cut short");
  }

  // The corners of each of a shape's faces. Shapes and their faces are in the file's order.
  std::vector<std::uint32_t> CornerCounts(const tinyobj::mesh_t& mesh) {
    const std::size_t first = counted_faces_, faces = mesh.num_face_vertices.size();
    counted_faces_ += faces;
    if (counted_faces_ > contents_.corner_counts.size()) {
      return {mesh.num_face_vertices.begin(), mesh.num_face_vertices.end()};
    }
    const auto begin = contents_.corner_counts.begin() + static_cast<std::ptrdiff_t>(first);
    return {begin, begin + static_cast<std::ptrdiff_t>(faces)};
  }

  Status CheckShape(std::size_t shape_index) {
    const tinyobj::shape_t& shape = shapes_[shape_index];
    const tinyobj::mesh_t& mesh = shape.mesh;
    const std::vector<std::uint32_t>& counts = corner_counts_.emplace_back(CornerCounts(mesh));
    if (std::accumulate(counts.begin(), counts.end(), std::size_t(0)) != mesh.indices.size()) {
      return InputError(
          file_ + ": '" + Excerpt(shape.name, 80) +
          "' has a face of more than 255 corners that cannot be counted: triangulate it before exporting");
    }
    if (!shape.lines.indices.empty() || !shape.points.indices.empty()) {
      warnings_.Add("points and lines are left out, only faces are seen", "'" + Excerpt(shape.name, 80) + "'");
    }
    const IndexedList positions{"vertex", attributes_.vertices.size() / 3, false};
    const IndexedList uvs{"texture coordinate", attributes_.texcoords.size() / 2, true};
    const IndexedList normals{"normal", attributes_.normals.size() / 3, true};
    for (const tinyobj::index_t& index : mesh.indices) {
      SCUMBLE_RETURN_IF_ERROR(CheckIndex(index.vertex_index, positions, shape.name));
      SCUMBLE_RETURN_IF_ERROR(CheckIndex(index.texcoord_index, uvs, shape.name));
      SCUMBLE_RETURN_IF_ERROR(CheckIndex(index.normal_index, normals, shape.name));
    }
    for (const std::size_t count : counts) {
      if (count >= 3) SCUMBLE_RETURN_IF_ERROR(budget_.Take(file_, count, count - 2));
    }
    return Ok();
  }

  void AddShape(std::size_t shape_index) {
    std::size_t first = 0;
    for (std::size_t f = 0; f < corner_counts_[shape_index].size(); ++f) {
      AddFace(shape_index, f, first, corner_counts_[shape_index][f]);
      first += corner_counts_[shape_index][f];
    }
  }

  void AddFace(std::size_t shape_index, std::size_t face, std::size_t first, std::size_t count) {
    const tinyobj::mesh_t& mesh = shapes_[shape_index].mesh;
    std::vector<glm::vec3> polygon;
    for (std::size_t i = 0; i < count; ++i) {
      polygon.push_back(places_.positions[std::size_t(mesh.indices[first + i].vertex_index)]);
    }
    std::vector<glm::uvec3> cuts;
    TriangulatePolygon(polygon, cuts);
    for (const glm::uvec3& cut : cuts) {
      ObjTriangle triangle;
      bool lacks = false;
      for (int i = 0; i < 3; ++i) {
        const tinyobj::index_t& index = mesh.indices[first + cut[i]];
        triangle.corners[i] = {index.vertex_index, index.texcoord_index, index.normal_index};
        if (index.normal_index >= 0 && !HasDirection(normals_.At(triangle.corners[i]))) {
          warnings_.Add("normals without a direction were computed anew",
                        "'" + Excerpt(shapes_[shape_index].name, 80) + "'");
          triangle.corners[i].normal = -1;
        }
        lacks = lacks || triangle.corners[i].normal < 0;
      }
      triangle.face = faces_;
      triangle.smoothing_group = mesh.smoothing_group_ids[face];
      triangle.shape = static_cast<int>(shape_index);
      triangle.material = mesh.material_ids[face];
      without_normals_ += lacks;
      triangles_.push_back(triangle);
    }
    ++faces_;
  }

  Status CheckHasTriangles() const {
    if (!triangles_.empty() || places_.positions.empty()) return Ok();
    const bool has_lines = std::any_of(shapes_.begin(), shapes_.end(),
                                       [](const tinyobj::shape_t& shape) { return !shape.lines.indices.empty(); });
    return NoTrianglesError(file_, places_.positions.size(), has_lines ? ", lines" : "");
  }

  void MakeNormals() {
    const auto rule = contents_.has_smoothing ? MissingNormals::Rule::kGroups : MissingNormals::Rule::kAngle;
    MakeObjNormals(places_, missing_.Take(rule, without_normals_), triangles_, normals_);
  }

  void LoadMaterials() {
    mtl_ = std::make_shared<MtlLibrary>();
    mtl_->materials = std::move(contents_.materials);
    for (std::size_t i = 0; i < mtl_->materials.size(); ++i) {
      for (const std::string& name : TexturesOf(mtl_->materials[i])) KeepTexture(name, i);
    }
    for (std::size_t i = 0; i < mtl_->materials.size(); ++i) {
      const std::string& name = mtl_->materials[i].name;
      scene_.materials.push_back(MakeMaterial(*mtl_, i, scene_));
      scene_.materials.back().name = material_names_.Take(name.empty() ? "material_" + std::to_string(i) : name);
    }
  }

  // Libraries have materials for several scenes: only those of faces are told of.
  void WarnOfUsedMaterials() {
    const std::vector<bool> used = UsedMaterials(scene_);
    for (std::size_t i = 0; i < mtl_->materials.size(); ++i) {
      if (used[i]) WarnOfLeftOut(mtl_->materials[i], scene_.materials[i], warnings_);
    }
  }

  // Keeps a texture for later decoding. If it is left out, only the materials that use it are made anew: a library may
  // have as many missing textures as materials.
  void KeepTexture(const std::string& name, std::size_t material) {
    const auto [known, is_new] = mtl_->textures.try_emplace(name, static_cast<int>(scene_.textures.size()));
    if (!is_new) {
      users_[std::size_t(known->second)]->push_back(material);
      return;
    }
    const auto users = std::make_shared<std::vector<std::size_t>>(1, material);
    users_.push_back(users);
    auto texture = std::make_shared<EncodedTexture>();
    texture->decode = [file = name] { return ReadPicture(file, {}, Profiles::kIgnore); };
    texture->count_pixels = [file = name] { return CountPixels(file); };
    texture->leave_out = [mtl = mtl_, users](Scene& scene) {
      for (std::size_t i : *users) {
        Material made = MakeMaterial(*mtl, i, scene);
        made.name = scene.materials[i].name;
        scene.materials[i] = std::move(made);
      }
    };
    scene_.textures.emplace_back();
    scene_.encoded_textures.push_back(std::move(texture));
  }

  // The material of faces without one: Blender's, which has no highlight. Vertex colours, where present, are the
  // surface's.
  int PlainMaterial() {
    if (plain_material_ < 0) {
      Material material;
      material.name = material_names_.Take("default");
      material.bsdf = Bsdf::kDiffuse;
      if (!contents_.HasColors()) material.base_color = kPlainColor;
      plain_material_ = static_cast<int>(scene_.materials.size());
      scene_.materials.push_back(std::move(material));
    }
    return plain_material_;
  }

  // The objects' names, for each shape. A group of an object that is named again goes on.
  std::vector<std::string> ShapeNames() const {
    UniqueNames unique;
    std::map<std::pair<int, std::string>, std::string> groups;
    std::vector<std::string> names(shapes_.size());
    const std::vector<ObjSection>& sections = contents_.sections;
    std::size_t face = 0, next = 0;
    for (std::size_t s = 0; s < shapes_.size(); ++s) {
      while (next < sections.size() && sections[next].first_face <= face) ++next;
      face += corner_counts_[s].size();
      if (shapes_[s].mesh.indices.empty()) continue;
      const std::string& name = shapes_[s].name;
      const bool is_group = next > 0 && sections[next - 1].is_group && !name.empty();
      std::string* group = is_group ? &groups[{sections[next - 1].object, name}] : nullptr;
      names[s] = group && !group->empty() ? *group : unique.Take(name.empty() ? "shape_" + std::to_string(s) : name);
      if (group) *group = names[s];
    }
    return names;
  }

  void BuildMeshes() {
    const std::vector<std::string> shape_names = ShapeNames();
    // Triangles are ordered by shape, but a shape may return to a material.
    for (std::size_t begin = 0; begin < triangles_.size();) {
      std::size_t end = begin;
      std::map<int, std::vector<std::size_t>> by_material;
      for (; end < triangles_.size() && triangles_[end].shape == triangles_[begin].shape; ++end) {
        by_material[triangles_[end].material].push_back(end);
      }
      for (const auto& [material, members] : by_material) {
        AddMesh(shape_names[std::size_t(triangles_[begin].shape)], material, members);
      }
      begin = end;
    }
  }

  void AddMesh(const std::string& object, int material, const std::vector<std::size_t>& members) {
    Mesh mesh;
    mesh.material = material >= 0 && std::size_t(material) < mtl_->materials.size() ? material : PlainMaterial();
    const bool has_colors = contents_.HasColors();
    bool has_uvs = false;
    for (std::size_t t : members) {
      for (const ObjCorner& corner : triangles_[t].corners) has_uvs |= corner.uv >= 0;
    }
    std::unordered_map<ObjCorner, std::uint32_t, CornerHash> vertices;
    for (std::size_t t : members) {
      glm::uvec3 indices(0);
      for (int i = 0; i < 3; ++i) {
        const ObjCorner& corner = triangles_[t].corners[i];
        const auto [it, is_new] = vertices.try_emplace(corner, static_cast<std::uint32_t>(mesh.positions.size()));
        indices[i] = it->second;
        if (!is_new) continue;
        mesh.positions.push_back(places_.positions[std::size_t(corner.position)]);
        mesh.normals.push_back(normals_.At(corner));
        if (has_uvs) mesh.uvs[0].push_back(UvAt(corner));
        if (has_colors) mesh.colors.push_back(ColorAt(corner));
      }
      mesh.triangles.push_back(indices);
    }
    FillNormals(mesh);
    const TextureUse& normal_map = scene_.materials[std::size_t(mesh.material)].normal_texture;
    if (normal_map.texture >= 0 && has_uvs) FillTangents(mesh, 0, normal_map.uv_transform);
    scene_.meshes.push_back(std::move(mesh));
    const glm::dvec3& origin = places_.origins[std::size_t(triangles_[members[0]].shape)];
    scene_.instances.push_back(
        {object, static_cast<int>(scene_.meshes.size()) - 1, glm::translate(glm::dmat4(1.0), origin)});
  }

  glm::vec2 UvAt(const ObjCorner& corner) const {
    if (corner.uv < 0) return glm::vec2(0.0f);
    const double* uv = attributes_.texcoords.data() + 2 * std::size_t(corner.uv);
    const glm::vec2 turned(static_cast<float>(uv[0]), 1.0f - static_cast<float>(uv[1]));
    return IsFinite(turned) ? turned : glm::vec2(0.0f);
  }

  glm::vec4 ColorAt(const ObjCorner& corner) const {
    const double* c = attributes_.colors.data() + 3 * std::size_t(corner.position);
    const glm::vec4 color(SrgbToLinear(float(c[0])), SrgbToLinear(float(c[1])), SrgbToLinear(float(c[2])), 1.0f);
    return IsFinite(color) ? glm::max(color, glm::vec4(0.0f)) : glm::vec4(1.0f);
  }

  const std::filesystem::path& path_;
  const std::string file_;
  ObjContents contents_;
  tinyobj::attrib_t& attributes_ = contents_.attributes;
  std::vector<tinyobj::shape_t>& shapes_ = contents_.shapes;
  Scene scene_;
  GeometryBudget budget_;
  WarningCounter warnings_;
  UniqueNames material_names_;
  int plain_material_ = -1;
  ObjPlaces places_;
  std::shared_ptr<MtlLibrary> mtl_;                               // once it is loaded
  std::vector<std::shared_ptr<std::vector<std::size_t>>> users_;  // of each texture: materials
  std::vector<ObjTriangle> triangles_;                            // by shape, in the order of the faces
  ObjNormals normals_;
  MissingNormals missing_;
  const FileListener& on_file_;
  std::size_t without_normals_ = 0;                        // triangles with a corner without a normal
  std::vector<std::vector<std::uint32_t>> corner_counts_;  // of the faces of each shape
  std::size_t counted_faces_ = 0;
  std::size_t faces_ = 0;
};

}  // namespace

Expected<Scene> LoadObjScene(const std::filesystem::path& path, MissingNormals missing, const FileListener& on_file) {
  return ObjLoader(path, missing, on_file).Load();
}

}  // namespace scumble
