#include "guidegen/load/ply.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "core/image/color.h"
#include "core/io/picture_file.h"
#include "guidegen/load/corner_value.h"
#include "guidegen/load/loader_util.h"
#include "guidegen/load/mesh_normals.h"
#include "guidegen/load/ply_parse.h"
#include "guidegen/load/split_vertices.h"

namespace scumble {
namespace {

constexpr std::string_view kCornerUvs = "texcoord";  // MeshLab's list

// The meaning of a vertex property; kSkip for those that are not used.
enum Role { kX, kY, kZ, kNx, kNy, kNz, kRed, kGreen, kBlue, kAlpha, kU, kV, kSkip };

Role RoleOf(const std::string& name) {
  struct Known {
    std::string_view name;
    Role role;
  };
  constexpr Known kKnown[] = {{"x", kX},
                              {"y", kY},
                              {"z", kZ},
                              {"nx", kNx},
                              {"ny", kNy},
                              {"nz", kNz},
                              {"red", kRed},
                              {"green", kGreen},
                              {"blue", kBlue},
                              {"alpha", kAlpha},
                              {"r", kRed},
                              {"g", kGreen},
                              {"b", kBlue},
                              {"diffuse_red", kRed},
                              {"diffuse_green", kGreen},
                              {"diffuse_blue", kBlue},
                              {"s", kU},
                              {"t", kV},
                              {"u", kU},
                              {"v", kV},
                              {"texture_u", kU},
                              {"texture_v", kV}};
  for (const Known& known : kKnown) {
    if (known.name == name) return known.role;
  }
  return kSkip;
}

class PlyLoader {
 public:
  PlyLoader(const std::filesystem::path& path, MissingNormals missing, const FileListener& on_file)
      : path_(path), file_(path.string()), missing_(missing), on_file_(on_file) {}

  Expected<Scene> Load() {
    SCUMBLE_ASSIGN(const std::vector<std::byte> whole, ReadRegularFile(path_));
    const std::span<const unsigned char> bytes = AsChars(whole);
    SCUMBLE_RETURN_IF_ERROR(ParsePlyHeader(file_, bytes, header_));
    ChooseTexture();
    FindValuesOfFaces();
    PlyValues values(bytes.subspan(header_.body), header_.format);
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty() && element.name == "vertex" && element.count > 0)
        return Bad("its vertices have no properties; expected x, y and z");
      if (element.properties.empty()) continue;
      SCUMBLE_RETURN_IF_ERROR(CheckRoom(element, values));
      if (element.name == "vertex") {
        SCUMBLE_RETURN_IF_ERROR(ReadVertices(element, values));
      } else {
        SCUMBLE_RETURN_IF_ERROR(ReadFaces(element, values));
      }
    }
    SCUMBLE_RETURN_IF_ERROR(CheckHasTriangles());
    PlaceVertices();
    CutPolygons();
    SCUMBLE_RETURN_IF_ERROR(GiveCornersTheirValues());
    return Finish();
  }

 private:
  Error Bad(const std::string& reason) const { return PlyError(file_, reason); }

  void ChooseTexture() {
    if (header_.textures.empty() || header_.textures[0].empty()) return;
    std::string name = header_.textures[0];
    std::replace(name.begin(), name.end(), '\\', '/');
    texture_ = path_.parent_path() / name;
    on_file_(texture_);
    if (header_.textures.size() > 1) {
      warnings_.Add("of several textures only the first is read", "'" + Excerpt(name, 80) + "'");
    }
  }

  // Refuses a count that the remaining file cannot hold, before anything is allocated for it.
  Status CheckRoom(const PlyElement& element, const PlyValues& values) {
    std::size_t least = 0;
    for (const PlyProperty& property : element.properties) {
      least += values.LeastBytes(property.list_count ? *property.list_count : property.type);
    }
    // The last word of a text needs no space after it.
    if (element.count > (values.remaining() + 1) / least) {
      return Bad("it declares " + std::to_string(element.count) + " of '" + Excerpt(element.name, 40) +
                 "', more than its " + std::to_string(values.remaining()) + " bytes can hold; the file was cut short");
    }
    if (element.name == "vertex") return budget_.Take(file_, element.count, 0);
    return Ok();
  }

  Error CutShort(const PlyElement& element, std::uint64_t index) const {
    return Bad(element.name + " " + std::to_string(index) + " of " + std::to_string(element.count) +
               " is missing or is no number; the file was cut short");
  }

  Status SkipList(const PlyProperty& property, const PlyElement& element, std::uint64_t index, PlyValues& values) {
    double count = 0.0, ignored = 0.0;
    if (!values.Next(*property.list_count, count) || !(count >= 0.0)) return CutShort(element, index);
    for (double i = 0.0; i < count; ++i) {
      if (!values.Next(property.type, ignored)) return CutShort(element, index);
    }
    return Ok();
  }

  Status ReadVertices(const PlyElement& element, PlyValues& values) {
    std::vector<Role> roles;
    bool has[kSkip + 1] = {};
    for (const PlyProperty& property : element.properties) {
      Role role = property.list_count ? kSkip : RoleOf(property.name);
      if (has[role]) role = kSkip;
      has[role] = true;
      roles.push_back(role);
    }
    if (!has[kX] || !has[kY] || !has[kZ]) return Bad("its vertices have no x, y and z");
    const bool normals = has[kNx] && has[kNy] && has[kNz], colors = has[kRed] && has[kGreen] && has[kBlue];
    const bool uvs = has[kU] && has[kV];
    const bool doubles = HasDoublePlaces(element);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      float v[kSkip + 1] = {};
      glm::dvec3 place(0.0);
      v[kAlpha] = 1.0f;
      for (std::size_t p = 0; p < roles.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (property.list_count) {
          SCUMBLE_RETURN_IF_ERROR(SkipList(property, element, i, values));
          continue;
        }
        double value = 0.0;
        if (!values.Next(property.type, value)) return CutShort(element, i);
        v[roles[p]] = ValueOf(roles[p], property.type, value);
        if (roles[p] <= kZ) place[roles[p]] = value;
      }
      const glm::vec3 position(v[kX], v[kY], v[kZ]);
      if (!IsFinite(position))
        return Bad("vertex " + std::to_string(i) + " is NaN or infinite; expected finite numbers");
      mesh_.positions.push_back(position);
      if (doubles) places_.push_back(place);
      if (normals) mesh_.normals.emplace_back(v[kNx], v[kNy], v[kNz]);
      if (uvs) mesh_.uvs[0].push_back(Uv(v[kU], v[kV]));
      if (colors) mesh_.colors.push_back(Color(v[kRed], v[kGreen], v[kBlue], v[kAlpha]));
    }
    return Ok();
  }

  static float ValueOf(Role role, PlyType type, double value) {
    const bool is_color = role >= kRed && role <= kAlpha;
    if (is_color && type == PlyType::kUint8) value /= 255.0;
    if (is_color && type == PlyType::kUint16) value /= 65535.0;
    return static_cast<float>(value);
  }

  static bool HasDoublePlaces(const PlyElement& element) {
    return std::any_of(element.properties.begin(), element.properties.end(), [](const PlyProperty& property) {
      return !property.list_count && RoleOf(property.name) <= kZ && property.type == PlyType::kFloat64;
    });
  }

  static glm::vec2 Uv(float u, float v) {
    const glm::vec2 turned(u, 1.0f - v);
    return IsFinite(turned) ? turned : glm::vec2(0.0f);
  }

  static glm::vec4 Color(float r, float g, float b, float a) {
    const glm::vec4 color(SrgbToLinear(r), SrgbToLinear(g), SrgbToLinear(b), a);
    return IsFinite(color) ? glm::clamp(color, glm::vec4(0.0f), glm::vec4(1.0f)) : glm::vec4(1.0f);
  }

  static bool HasColors(const PlyElement& element) {
    bool has[kSkip + 1] = {};
    for (const PlyProperty& property : element.properties)
      has[property.list_count ? kSkip : RoleOf(property.name)] = true;
    return has[kRed] && has[kGreen] && has[kBlue];
  }

  // Faces may be in several elements, of which only some have them.
  void FindValuesOfFaces() {
    for (const PlyElement& element : header_.elements) {
      if (element.name != "face") continue;
      has_face_colors_ = has_face_colors_ || HasColors(element);
      for (const PlyProperty& property : element.properties) {
        has_corner_uvs_ = has_corner_uvs_ || (property.list_count && property.name == kCornerUvs);
      }
    }
  }

  // Reads faces, and skips every other element.
  Status ReadFaces(const PlyElement& element, PlyValues& values) {
    const bool is_face = element.name == "face";
    if (!is_face && element.count > 0)
      warnings_.Add("elements other than vertices and faces are left out", element.name);
    const bool has_colors = is_face && HasColors(element);
    std::vector<Role> roles;
    for (const PlyProperty& property : element.properties) {
      roles.push_back(property.list_count ? kSkip : RoleOf(property.name));
    }
    Face face;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      float v[kSkip + 1] = {};
      v[kAlpha] = 1.0f;
      face.corners.clear(), face.uvs.clear();
      for (std::size_t p = 0; p < roles.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        const bool is_corners = is_face && (property.name == "vertex_indices" || property.name == "vertex_index");
        double value = 0.0;
        if (!property.list_count) {
          if (!values.Next(property.type, value)) return CutShort(element, i);
          v[roles[p]] = ValueOf(roles[p], property.type, value);
        } else if (is_corners) {
          SCUMBLE_RETURN_IF_ERROR(ReadCorners(property, element, i, values, face.corners));
        } else if (is_face && property.name == kCornerUvs) {
          SCUMBLE_RETURN_IF_ERROR(ReadCornerUvs(property, element, i, values, face.uvs));
        } else {
          SCUMBLE_RETURN_IF_ERROR(SkipList(property, element, i, values));
        }
      }
      if (has_colors) face.color = Color(v[kRed], v[kGreen], v[kBlue], v[kAlpha]);
      SCUMBLE_RETURN_IF_ERROR(AddFace(face));
    }
    return Ok();
  }

  // As the header has it: faces may come before vertices.
  std::uint64_t VertexCount() const {
    const auto is_vertex = [](const PlyElement& element) { return element.name == "vertex"; };
    const auto found = std::find_if(header_.elements.begin(), header_.elements.end(), is_vertex);
    return found == header_.elements.end() ? 0 : found->count;
  }

  struct Face {
    std::vector<std::uint32_t> corners;
    std::vector<float> uvs;  // u and v of each corner; empty: none
    std::optional<glm::vec4> color;
  };

  Status ReadCornerUvs(const PlyProperty& property, const PlyElement& element, std::uint64_t face, PlyValues& values,
                       std::vector<float>& uvs) {
    double count = 0.0, value = 0.0;
    if (!values.Next(*property.list_count, count) || !(count >= 0.0)) return CutShort(element, face);
    uvs.clear();
    for (double i = 0.0; i < count; ++i) {
      if (!values.Next(property.type, value)) return CutShort(element, face);
      uvs.push_back(static_cast<float>(value));
    }
    return Ok();
  }

  Status ReadCorners(const PlyProperty& property, const PlyElement& element, std::uint64_t face, PlyValues& values,
                     std::vector<std::uint32_t>& corners) {
    double count = 0.0, value = 0.0;
    if (!values.Next(*property.list_count, count) || !(count >= 0.0)) return CutShort(element, face);
    corners.clear();
    for (double c = 0.0; c < count; ++c) {
      if (!values.Next(property.type, value)) return CutShort(element, face);
      if (!(value >= 0.0) || value != std::floor(value) || value >= static_cast<double>(VertexCount())) {
        std::ostringstream reason;
        reason << "face " << face << " uses vertex " << value << ", but there are " << VertexCount();
        return Bad(reason.str());
      }
      corners.push_back(static_cast<std::uint32_t>(value));
    }
    return Ok();
  }

  // The number of a corner's values among all that differ.
  std::uint32_t ValueNumber(const Face& face, std::size_t corner) {
    CornerValue value{{}, face.color};
    if (!face.uvs.empty()) value.uv = Uv(face.uvs[2 * corner], face.uvs[2 * corner + 1]);
    const auto [known, is_new] = value_numbers_.try_emplace(value, static_cast<std::uint32_t>(corner_values_.size()));
    if (is_new) corner_values_.push_back(value);
    return known->second;
  }

  Status AddFace(Face& face) {
    const std::vector<std::uint32_t>& corners = face.corners;
    if (corners.size() < 3) return Ok();
    const std::size_t cuts = corners.size() - 2;
    SCUMBLE_RETURN_IF_ERROR(budget_.Take(file_, 0, cuts));
    if (cuts > 1) polygons_.push_back({static_cast<std::uint32_t>(mesh_.triangles.size()), std::uint32_t(cuts)});
    for (std::size_t i = 0; i < cuts; ++i) mesh_.triangles.emplace_back(corners[0], corners[i + 1], corners[i + 2]);
    if (!has_corner_uvs_ && !has_face_colors_) return Ok();
    if (!face.uvs.empty() && face.uvs.size() != 2 * corners.size()) {
      warnings_.Add("texture coordinates of faces are left out that are not two for each corner", "");
      face.uvs.clear();
    }
    std::vector<std::uint32_t> numbers;
    for (std::size_t i = 0; i < corners.size(); ++i) numbers.push_back(ValueNumber(face, i));
    for (std::size_t i = 0; i < cuts; ++i) of_corners_.emplace_back(numbers[0], numbers[i + 1], numbers[i + 2]);
    return Ok();
  }

  Status CheckHasTriangles() const {
    if (!mesh_.triangles.empty() || mesh_.positions.empty()) return Ok();
    std::string others;
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex" || element.count == 0) continue;
      others += ", " + std::to_string(element.count) + " of '" + Excerpt(element.name, 40) + "'";
    }
    return NoTrianglesError(file_, mesh_.positions.size(), others);
  }

  // Moves the shape to its origin, which is known once all faces are read. A vertex outside all faces may be any
  // distance away, and framing includes all vertices: it moves to a used vertex.
  void PlaceVertices() {
    if (places_.empty()) return;
    PlaceBox box;
    for (const glm::uvec3& triangle : mesh_.triangles) {
      for (int i = 0; i < 3; ++i) box.Add(places_[triangle[i]]);
    }
    origin_ = OriginOf(box);
    if (origin_ == glm::dvec3(0.0)) return;
    mesh_.positions.assign(places_.size(), glm::vec3(places_[mesh_.triangles[0].x] - origin_));
    for (const glm::uvec3& triangle : mesh_.triangles) {
      for (int i = 0; i < 3; ++i) mesh_.positions[triangle[i]] = glm::vec3(places_[triangle[i]] - origin_);
    }
  }

  // Cuts the polygons, until now fans, by the final corners.
  void CutPolygons() {
    std::vector<glm::uvec3> cuts;
    const auto apply = [&](const Polygon& polygon, std::vector<glm::uvec3>& triangles) {
      const auto fan = std::span(triangles).subspan(polygon.first, polygon.triangles);
      const std::vector<std::uint32_t> corners = CornersOfFan(fan);
      for (std::size_t i = 0; i < cuts.size(); ++i) {
        fan[i] = {corners[cuts[i].x], corners[cuts[i].y], corners[cuts[i].z]};
      }
    };
    for (const Polygon& polygon : polygons_) {
      std::vector<glm::vec3> positions;
      for (const std::uint32_t corner :
           CornersOfFan(std::span(mesh_.triangles).subspan(polygon.first, polygon.triangles))) {
        positions.push_back(mesh_.positions[corner]);
      }
      cuts.clear();
      TriangulatePolygon(positions, cuts);
      apply(polygon, mesh_.triangles);
      if (!of_corners_.empty()) apply(polygon, of_corners_);
    }
  }

  static std::vector<std::uint32_t> CornersOfFan(std::span<const glm::uvec3> fan) {
    std::vector<std::uint32_t> corners = {fan[0].x, fan[0].y};
    for (const glm::uvec3& triangle : fan) corners.push_back(triangle.z);
    return corners;
  }

  // Programs that write colours of faces give white to those without one. So if all are white, those of vertices count.
  void ChooseColors() {
    const glm::vec4 white(1.0f);
    const auto is_white = [&](const glm::vec4& color) { return color == white; };
    const auto is_plain = [&](const CornerValue& value) { return !value.color || *value.color == white; };
    if (!has_face_colors_ || std::all_of(mesh_.colors.begin(), mesh_.colors.end(), is_white)) return;
    if (std::all_of(corner_values_.begin(), corner_values_.end(), is_plain)) {
      for (CornerValue& value : corner_values_) value.color.reset();
      return;
    }
    colors_collide_ = true;
  }

  // Values of corners replace those of vertices.
  Status GiveCornersTheirValues() {
    if (of_corners_.empty()) return Ok();
    ChooseColors();
    const std::size_t before = mesh_.positions.size();
    const CornerSplit split = SplitByCorners(of_corners_, mesh_);
    SCUMBLE_RETURN_IF_ERROR(budget_.Take(file_, split.sources.size() - before, 0));
    const std::size_t count = split.values.size();
    if (has_corner_uvs_) mesh_.uvs[0].resize(count, glm::vec2(0.0f));
    if (has_face_colors_) mesh_.colors.resize(count, glm::vec4(1.0f));
    for (std::size_t v = 0; v < count; ++v) {
      if (split.values[v] == kNoValue) continue;
      const CornerValue& value = corner_values_[split.values[v]];
      if (value.uv) mesh_.uvs[0][v] = *value.uv;
      if (value.color) mesh_.colors[v] = *value.color;
    }
    return Ok();
  }

  // The texture stands in place of colours, which scans have beside it for programs that show no textures. They are
  // back if it cannot be decoded. Call it when the vertices are final.
  void KeepTexture(Scene& scene) {
    if (texture_.empty() || mesh_.uvs[0].empty()) return;
    Material& material = scene.materials[0];
    const glm::vec4 plain = material.base_color;
    const auto colors = std::make_shared<std::vector<glm::vec4>>(std::exchange(mesh_.colors, {}));
    material.base_color = glm::vec4(1.0f);
    material.base_color_texture.texture = 0;
    auto texture = std::make_shared<EncodedTexture>();
    texture->decode = [file = texture_] { return ReadPicture(file, {}, Profiles::kIgnore); };
    texture->count_pixels = [file = texture_] { return CountPixels(file); };
    texture->bytes = colors->size() * sizeof(glm::vec4);
    texture->leave_out = [plain, colors](Scene& without) {
      without.meshes[0].colors = *colors;
      without.materials[0].base_color = plain;
      without.materials[0].base_color_texture.texture = -1;
    };
    scene.textures.emplace_back();
    scene.encoded_textures.push_back(std::move(texture));
  }

  // The number of the face that each triangle is a part of.
  std::vector<std::uint32_t> Faces() const {
    std::vector<std::uint32_t> faces;
    std::uint32_t face = 0;
    for (const Polygon& polygon : polygons_) {
      while (faces.size() < polygon.first) faces.push_back(face++);
      faces.insert(faces.end(), polygon.triangles, face++);
    }
    while (faces.size() < mesh_.triangles.size()) faces.push_back(face++);
    return faces;
  }

  Status MakeNormals() {
    if (std::none_of(mesh_.normals.begin(), mesh_.normals.end(), HasDirection)) mesh_.normals.clear();
    if (!mesh_.normals.empty()) {
      if (FillNormals(mesh_) > 0) warnings_.Add("normals without a direction were computed anew", "");
      return Ok();
    }
    const std::optional<double> degrees = missing_.Take(MissingNormals::Rule::kAngle, mesh_.triangles.size());
    const std::vector<std::uint32_t> weld = WeldByPosition(mesh_.positions), faces = Faces();
    const CornerNormals normals = AutoSmoothNormals({mesh_.positions, mesh_.triangles, weld, faces}, *degrees);
    return budget_.Take(file_, SetCornerNormals(normals, mesh_).sources.size() - weld.size(), 0);
  }

  Expected<Scene> Finish() {
    Scene scene;
    Material material;
    material.name = "default";
    material.bsdf = Bsdf::kDiffuse;
    if (mesh_.colors.empty()) material.base_color = kPlainColor;
    scene.materials.push_back(std::move(material));
    if (!mesh_.triangles.empty()) {
      SCUMBLE_RETURN_IF_ERROR(MakeNormals());
      KeepTexture(scene);
      if (colors_collide_ && !mesh_.colors.empty())
        warnings_.Add("where vertices and faces both have colours, those of the faces are taken", "");
      scene.meshes.push_back(std::move(mesh_));
      scene.instances.push_back({path_.stem().string(), 0, glm::translate(glm::dmat4(1.0), origin_)});
    }
    warnings_.MoveTo(scene.warnings);
    missing_.Tell(scene.notes);
    return scene;
  }

  // Consecutive triangles of the mesh.
  struct Polygon {
    std::uint32_t first = 0, triangles = 0;
  };

  const std::filesystem::path& path_;
  const std::string file_;
  PlyHeader header_;
  Mesh mesh_;
  std::vector<glm::dvec3> places_;  // of the vertices, where the file has doubles
  std::vector<Polygon> polygons_;   // that have more than three corners
  std::filesystem::path texture_;   // empty: none
  bool has_corner_uvs_ = false, has_face_colors_ = false;
  bool colors_collide_ = false;  // both faces and vertices have some that are not white
  std::vector<CornerValue> corner_values_;
  std::unordered_map<CornerValue, std::uint32_t, CornerValueHash> value_numbers_;
  std::vector<glm::uvec3> of_corners_;  // of each triangle; empty: its corners are vertices
  glm::dvec3 origin_{0.0};
  GeometryBudget budget_;
  WarningCounter warnings_;
  MissingNormals missing_;
  const FileListener& on_file_;
};

}  // namespace

Expected<Scene> LoadPlyScene(const std::filesystem::path& path, MissingNormals missing, const FileListener& on_file) {
  return PlyLoader(path, missing, on_file).Load();
}

}  // namespace scumble
