#include "guidegen/load/ply.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>

#include "core/image/color.h"
#include "guidegen/load/loader_util.h"
#include "guidegen/load/mesh_normals.h"

namespace scumble {
namespace {

enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };
enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };

struct TypeName {
  std::string_view name;
  PlyType type;
};
constexpr TypeName kTypeNames[] = {
    {"char", PlyType::kInt8},      {"int8", PlyType::kInt8},       {"uchar", PlyType::kUint8},
    {"uint8", PlyType::kUint8},    {"short", PlyType::kInt16},     {"int16", PlyType::kInt16},
    {"ushort", PlyType::kUint16},  {"uint16", PlyType::kUint16},   {"int", PlyType::kInt32},
    {"int32", PlyType::kInt32},    {"uint", PlyType::kUint32},     {"uint32", PlyType::kUint32},
    {"float", PlyType::kFloat32},  {"float32", PlyType::kFloat32}, {"double", PlyType::kFloat64},
    {"float64", PlyType::kFloat64}};

std::size_t Bytes(PlyType type) {
  constexpr std::size_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<int>(type)];
}

struct Property {
  std::string name;
  PlyType type = PlyType::kFloat32;
  std::optional<PlyType> list_count;  // set for lists: the type of their length
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<Element> elements;
  std::size_t body = 0;  // first byte after the header
};

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

// Steps through the values of the body.
class PlyValues {
 public:
  PlyValues(std::span<const unsigned char> bytes, PlyFormat format) : bytes_(bytes), format_(format) {}

  std::size_t remaining() const { return bytes_.size() - at_; }

  // The smallest size of a value of this type.
  std::size_t LeastBytes(PlyType type) const { return format_ == PlyFormat::kAscii ? 2 : Bytes(type); }

  bool Next(PlyType type, double& value) {
    return format_ == PlyFormat::kAscii ? NextWord(value) : NextBinary(type, value);
  }

 private:
  bool NextWord(double& value) {
    const auto is_space = [](unsigned char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
    while (at_ < bytes_.size() && is_space(bytes_[at_])) ++at_;
    std::size_t end = at_;
    while (end < bytes_.size() && !is_space(bytes_[end])) ++end;
    if (end > at_ && bytes_[at_] == '+') ++at_;
    const char* first = reinterpret_cast<const char*>(bytes_.data()) + at_;
    const char* last = reinterpret_cast<const char*>(bytes_.data()) + end;
    const auto result = std::from_chars(first, last, value);
    at_ = end;
    return result.ec == std::errc() && result.ptr == last;
  }

  template <class T>
  double Convert(const unsigned char* raw) const {
    T value;
    std::memcpy(&value, raw, sizeof(T));
    return static_cast<double>(value);
  }

  bool NextBinary(PlyType type, double& value) {
    const std::size_t size = Bytes(type);
    if (size > remaining()) return false;
    unsigned char raw[8] = {};
    std::memcpy(raw, bytes_.data() + at_, size);
    at_ += size;
    const bool file_is_little = format_ == PlyFormat::kLittleEndian;
    if (file_is_little != (std::endian::native == std::endian::little)) std::reverse(raw, raw + size);
    switch (type) {
      case PlyType::kInt8:
        value = Convert<std::int8_t>(raw);
        break;
      case PlyType::kUint8:
        value = Convert<std::uint8_t>(raw);
        break;
      case PlyType::kInt16:
        value = Convert<std::int16_t>(raw);
        break;
      case PlyType::kUint16:
        value = Convert<std::uint16_t>(raw);
        break;
      case PlyType::kInt32:
        value = Convert<std::int32_t>(raw);
        break;
      case PlyType::kUint32:
        value = Convert<std::uint32_t>(raw);
        break;
      case PlyType::kFloat32:
        value = Convert<float>(raw);
        break;
      case PlyType::kFloat64:
        value = Convert<double>(raw);
        break;
    }
    return true;
  }

  std::span<const unsigned char> bytes_;
  PlyFormat format_;
  std::size_t at_ = 0;
};

class PlyLoader {
 public:
  PlyLoader(const std::filesystem::path& path, MissingNormals missing)
      : path_(path), file_(path.string()), missing_(missing) {}

  Expected<Scene> Load() {
    SCUMBLE_ASSIGN(const std::vector<std::byte> whole, ReadRegularFile(path_));
    const std::span<const unsigned char> bytes = AsChars(whole);
    SCUMBLE_RETURN_IF_ERROR(ParseHeader(bytes));
    PlyValues values(bytes.subspan(header_.body), header_.format);
    for (const Element& element : header_.elements) {
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
    return Finish();
  }

 private:
  Error Bad(const std::string& reason) const { return InputError(file_ + " is not a valid PLY file: " + reason); }

  static std::optional<PlyType> FindType(const std::string& name) {
    for (const TypeName& known : kTypeNames) {
      if (known.name == name) return known.type;
    }
    return std::nullopt;
  }

  Status ParseHeader(std::span<const unsigned char> bytes) {
    std::size_t at = 0;
    bool has_format = false;
    // Rhinoceros ends lines by a carriage return alone; binary values may begin with any byte after it.
    constexpr std::size_t kMagic = 3;
    const bool returns_alone = bytes.size() > kMagic + 1 && bytes[kMagic] == '\r' && bytes[kMagic + 1] != '\n';
    const unsigned char end_of_line = returns_alone ? '\r' : '\n';
    for (int line_number = 1; at < bytes.size(); ++line_number) {
      const auto end = std::find(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.end(), end_of_line);
      std::string line(bytes.begin() + static_cast<std::ptrdiff_t>(at), end);
      at += line.size() + (end == bytes.end() ? 0 : 1);
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (line_number == 1) {
        if (line != "ply") return Bad("it does not begin with the line 'ply'");
        continue;
      }
      if (line == "end_header") {
        header_.body = at;
        return has_format ? Ok() : Status(Bad("its header names no format"));
      }
      std::istringstream words(line);
      std::string keyword;
      words >> keyword;
      if (keyword == "format") has_format = true;
      SCUMBLE_RETURN_IF_ERROR(ParseHeaderLine(keyword, words, line));
    }
    return Bad("its header has no end; the file was cut short");
  }

  Status ParseHeaderLine(const std::string& keyword, std::istringstream& words, const std::string& line) {
    if (keyword == "format") {
      std::string format;
      words >> format;
      if (format == "binary_little_endian") {
        header_.format = PlyFormat::kLittleEndian;
      } else if (format == "binary_big_endian") {
        header_.format = PlyFormat::kBigEndian;
      } else if (format != "ascii") {
        return Bad("its format is '" + Excerpt(format, 40) + "'; expected ascii or binary_little_endian");
      }
    } else if (keyword == "element") {
      Element element;
      if (!(words >> element.name >> element.count)) return Bad("the header line '" + Excerpt(line, 80) + "'");
      // A second list of vertices might have different properties, and faces do not say which list they index.
      const auto is_twin = [&](const Element& other) { return other.name == element.name; };
      if (element.name == "vertex" && std::any_of(header_.elements.begin(), header_.elements.end(), is_twin)) {
        return Bad("its header has a second 'element vertex'; expected one, join them into it");
      }
      header_.elements.push_back(element);
    } else if (keyword == "property") {
      Property property;
      std::string type, count_type;
      words >> type;
      if (type == "list") {
        words >> count_type >> type;
        property.list_count = FindType(count_type);
        if (!property.list_count || *property.list_count >= PlyType::kFloat32) {
          return Bad("the header line '" + Excerpt(line, 80) + "'");
        }
      }
      const std::optional<PlyType> known = FindType(type);
      if (!known || !(words >> property.name) || header_.elements.empty()) {
        return Bad("the header line '" + Excerpt(line, 80) + "'");
      }
      property.type = *known;
      header_.elements.back().properties.push_back(property);
    }
    return Ok();
  }

  // Refuses a count that the remaining file cannot hold, before anything is allocated for it.
  Status CheckRoom(const Element& element, const PlyValues& values) {
    std::size_t least = 0;
    for (const Property& property : element.properties) {
      least += values.LeastBytes(property.list_count ? *property.list_count : property.type);
    }
    // The last word of a text needs no space after it.
    if (element.count > (values.remaining() + 1) / least) {
      return Bad("it promises " + std::to_string(element.count) + " of '" + Excerpt(element.name, 40) +
                 "', more than its " + std::to_string(values.remaining()) + " bytes can hold; the file was cut short");
    }
    if (element.name == "vertex") return budget_.Take(file_, element.count, 0);
    return Ok();
  }

  Error CutShort(const Element& element, std::uint64_t index) const {
    return Bad(element.name + " " + std::to_string(index) + " of " + std::to_string(element.count) +
               " is missing or is no number; the file was cut short");
  }

  Status SkipList(const Property& property, const Element& element, std::uint64_t index, PlyValues& values) {
    double count = 0.0, ignored = 0.0;
    if (!values.Next(*property.list_count, count) || !(count >= 0.0)) return CutShort(element, index);
    for (double i = 0.0; i < count; ++i) {
      if (!values.Next(property.type, ignored)) return CutShort(element, index);
    }
    return Ok();
  }

  Status ReadVertices(const Element& element, PlyValues& values) {
    std::vector<Role> roles;
    bool has[kSkip + 1] = {};
    for (const Property& property : element.properties) {
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
        const Property& property = element.properties[p];
        if (property.list_count) {
          SCUMBLE_RETURN_IF_ERROR(SkipList(property, element, i, values));
          continue;
        }
        double value = 0.0;
        if (!values.Next(property.type, value)) return CutShort(element, i);
        if (roles[p] >= kRed && roles[p] <= kAlpha && property.type == PlyType::kUint8) value /= 255.0;
        if (roles[p] >= kRed && roles[p] <= kAlpha && property.type == PlyType::kUint16) value /= 65535.0;
        v[roles[p]] = static_cast<float>(value);
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

  static bool HasDoublePlaces(const Element& element) {
    return std::any_of(element.properties.begin(), element.properties.end(), [](const Property& property) {
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

  // Reads faces, and skips every other element.
  Status ReadFaces(const Element& element, PlyValues& values) {
    const bool is_face = element.name == "face";
    if (!is_face && element.count > 0)
      warnings_.Add("elements other than vertices and faces are left out", element.name);
    double value = 0.0;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (const Property& property : element.properties) {
        const bool is_corners = is_face && (property.name == "vertex_indices" || property.name == "vertex_index");
        if (!property.list_count) {
          if (!values.Next(property.type, value)) return CutShort(element, i);
        } else if (is_corners) {
          SCUMBLE_RETURN_IF_ERROR(ReadCorners(property, element, i, values));
        } else {
          SCUMBLE_RETURN_IF_ERROR(SkipList(property, element, i, values));
        }
      }
    }
    return Ok();
  }

  // As the header has it: faces may come before vertices.
  std::uint64_t VertexCount() const {
    const auto is_vertex = [](const Element& element) { return element.name == "vertex"; };
    const auto found = std::find_if(header_.elements.begin(), header_.elements.end(), is_vertex);
    return found == header_.elements.end() ? 0 : found->count;
  }

  Status ReadCorners(const Property& property, const Element& element, std::uint64_t face, PlyValues& values) {
    double count = 0.0, value = 0.0;
    if (!values.Next(*property.list_count, count) || !(count >= 0.0)) return CutShort(element, face);
    std::vector<std::uint32_t> corners;
    for (double c = 0.0; c < count; ++c) {
      if (!values.Next(property.type, value)) return CutShort(element, face);
      if (!(value >= 0.0) || value != std::floor(value) || value >= static_cast<double>(VertexCount())) {
        std::ostringstream reason;
        reason << "face " << face << " uses vertex " << value << ", but there are " << VertexCount();
        return Bad(reason.str());
      }
      corners.push_back(static_cast<std::uint32_t>(value));
    }
    if (corners.size() < 3) return Ok();
    const std::size_t cuts = corners.size() - 2;
    SCUMBLE_RETURN_IF_ERROR(budget_.Take(file_, 0, cuts));
    if (cuts > 1) polygons_.push_back({static_cast<std::uint32_t>(mesh_.triangles.size()), std::uint32_t(cuts)});
    for (std::size_t i = 0; i < cuts; ++i) mesh_.triangles.emplace_back(corners[0], corners[i + 1], corners[i + 2]);
    return Ok();
  }

  Status CheckHasTriangles() const {
    if (!mesh_.triangles.empty() || mesh_.positions.empty()) return Ok();
    std::string others;
    for (const Element& element : header_.elements) {
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
    for (const Polygon& polygon : polygons_) {
      const auto fan = std::span(mesh_.triangles).subspan(polygon.first, polygon.triangles);
      std::vector<std::uint32_t> corners = {fan[0].x, fan[0].y};
      for (const glm::uvec3& triangle : fan) corners.push_back(triangle.z);
      std::vector<glm::vec3> positions;
      for (const std::uint32_t corner : corners) positions.push_back(mesh_.positions[corner]);
      cuts.clear();
      TriangulatePolygon(positions, cuts);
      for (std::size_t i = 0; i < cuts.size(); ++i) {
        fan[i] = {corners[cuts[i].x], corners[cuts[i].y], corners[cuts[i].z]};
      }
    }
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
  Header header_;
  Mesh mesh_;
  std::vector<glm::dvec3> places_;  // of the vertices, where the file has doubles
  std::vector<Polygon> polygons_;   // that have more than three corners
  glm::dvec3 origin_{0.0};
  GeometryBudget budget_;
  WarningCounter warnings_;
  MissingNormals missing_;
};

}  // namespace

Expected<Scene> LoadPlyScene(const std::filesystem::path& path, MissingNormals missing) {
  return PlyLoader(path, missing).Load();
}

}  // namespace scumble
