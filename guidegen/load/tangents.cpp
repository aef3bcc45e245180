#include "guidegen/load/tangents.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cfloat>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/image/check.h"
#include "guidegen/load/split_vertices.h"

namespace scumble {
namespace {

constexpr std::uint32_t kUnset = ~0u;

glm::dvec3 DirectionOrZero(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > FLT_MIN && std::isfinite(length) ? v / length : glm::dvec3(0.0);
}

glm::dvec3 LaidInto(const glm::dvec3& normal, const glm::dvec3& v) {
  return DirectionOrZero(v - normal * glm::dot(normal, v));
}

// −0 and 0 are one value; every other pattern of bits is one of its own, NaN too.
std::uint32_t Bits(float value) { return std::bit_cast<std::uint32_t>(value + 0.0f); }

// All parts' vertices in a row, before any stretch. v grows upwards, as MikkTSpace has it.
struct Surface {
  using Key = std::array<std::uint32_t, 8>;  // of place, normal and coordinates

  std::vector<glm::dvec3> positions;
  std::vector<glm::dvec3> normals;
  std::vector<glm::dvec2> uvs;
  std::vector<glm::uvec3> triangles;
  std::vector<std::uint32_t> weld;  // the first of equal vertices

  Surface(std::span<const TangentPart> parts, int uv_set, const glm::mat3& uv_transform) {
    std::vector<Key> keys;
    const bool exact = std::all_of(parts.begin(), parts.end(), [&](const auto& part) { return Fits(part, uv_set); });
    for (const TangentPart& part : parts) {
      const auto first = std::uint32_t(positions.size());
      const std::span<const float> exact_v = exact ? part.exact_v : std::span<const float>();
      Add(*part.mesh, exact_v, part.mesh->uvs[std::size_t(uv_set)], uv_transform, keys);
      for (const glm::uvec3& triangle : part.mesh->triangles) triangles.push_back(triangle + first);
    }
    std::vector<std::uint32_t> order(keys.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t i, std::uint32_t j) { return keys[i] != keys[j] ? keys[i] < keys[j] : i < j; });
    weld.resize(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      weld[order[i]] = i > 0 && keys[order[i]] == keys[order[i - 1]] ? weld[order[i - 1]] : order[i];
    }
  }

 private:
  static bool Fits(const TangentPart& part, int uv_set) {
    const std::vector<glm::vec2>& uvs = part.mesh->uvs[std::size_t(uv_set)];
    return std::equal(uvs.begin(), uvs.end(), part.exact_v.begin(), part.exact_v.end(),
                      [](const glm::vec2& uv, float v) { return uv.y == 1.0f - v; });
  }

  void Add(const Mesh& mesh, std::span<const float> exact_v, const std::vector<glm::vec2>& given,
           const glm::mat3& uv_transform, std::vector<Key>& keys) {
    SCUMBLE_CHECK_EQ(mesh.normals.size(), mesh.positions.size());
    SCUMBLE_CHECK_EQ(given.size(), mesh.positions.size());
    const glm::dmat3 unstretch = glm::inverse(mesh.stretch), normal_before = glm::transpose(mesh.stretch);
    const bool plain = uv_transform == glm::mat3(1.0f) && !exact_v.empty();
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const glm::vec3 &p = mesh.positions[v], &n = mesh.normals[v];
      const float height = exact_v.empty() ? given[v].y : exact_v[v];
      positions.push_back(unstretch * glm::dvec3(p));
      normals.push_back(DirectionOrZero(normal_before * glm::dvec3(n)));
      const glm::dvec3 moved = glm::dmat3(uv_transform) * glm::dvec3(given[v], 1.0);
      uvs.push_back(plain ? glm::dvec2(given[v].x, height) : glm::dvec2(moved.x, -moved.y));
      keys.push_back(
          {Bits(p.x), Bits(p.y), Bits(p.z), Bits(n.x), Bits(n.y), Bits(n.z), Bits(given[v].x), Bits(height)});
    }
  }
};

// MikkTSpace's groups and tangents.
class TangentGroups {
 public:
  explicit TangentGroups(const Surface& surface) : surface_(surface) {
    for (const glm::uvec3& triangle : surface.triangles) faces_.push_back(MakeFace(triangle));
    FindNeighbors();
    for (std::uint32_t face = 0; face < faces_.size(); ++face) {
      for (int i = 0; i < 3; ++i) {
        if (!faces_[face].shapeless && faces_[face].group[i] == kUnset) Gather(face, i);
      }
    }
  }

  // One tangent for each group, and one more for corners without a group.
  std::vector<glm::vec4> Tangents() const {
    std::vector<glm::vec4> tangents;
    for (const Group& group : groups_) {
      const glm::dvec3 tangent = DirectionOrZero(group.sum);
      tangents.emplace_back(tangent == glm::dvec3(0.0) ? glm::vec3(1, 0, 0) : glm::vec3(tangent),
                            group.upright ? 1.0f : -1.0f);
    }
    tangents.emplace_back(1, 0, 0, -1);
    return tangents;
  }

  // A triangle without an area takes any group of its vertices.
  std::vector<glm::uvec3> OfCorners() const {
    std::vector<std::uint32_t> first(surface_.positions.size(), std::uint32_t(groups_.size()));
    for (std::size_t group = groups_.size(); group-- > 0;) first[groups_[group].vertex] = std::uint32_t(group);
    std::vector<glm::uvec3> of_corners;
    for (std::uint32_t face = 0; face < faces_.size(); ++face) {
      glm::uvec3 groups(0);
      for (int i = 0; i < 3; ++i) {
        groups[i] = faces_[face].is_line ? first[VertexOf(face, i)]
                                         : std::min(faces_[face].group[i], std::uint32_t(groups_.size()));
      }
      of_corners.push_back(groups);
    }
    return of_corners;
  }

 private:
  struct Face {
    glm::dvec3 along_u{0.0};  // unit, the direction in which u grows
    bool upright = false;     // the texture is not mirrored
    bool shapeless = false;   // it has no area in the texture
    bool is_line = false;     // two corners are at one place: it has no neighbours
    std::array<std::uint32_t, 3> neighbor = {kUnset, kUnset, kUnset};  // across the edge from a corner to the next one
    std::array<std::uint32_t, 3> group = {kUnset, kUnset, kUnset};     // of each corner
  };
  struct Group {
    std::uint32_t vertex;
    bool upright;
    glm::dvec3 sum{0.0};
  };

  Face MakeFace(const glm::uvec3& triangle) const {
    const glm::dvec3& place = surface_.positions[triangle.x];
    const glm::dvec3 p1 = surface_.positions[triangle.y] - place, p2 = surface_.positions[triangle.z] - place;
    const glm::dvec2& uv = surface_.uvs[triangle.x];
    const glm::dvec2 uv1 = surface_.uvs[triangle.y] - uv, uv2 = surface_.uvs[triangle.z] - uv;
    const double area = uv1.x * uv2.y - uv1.y * uv2.x;
    const glm::dvec3 along_u = p1 * uv2.y - p2 * uv1.y;
    const glm::dvec3 along_v = p2 * uv1.x - p1 * uv2.x;
    Face face;
    face.upright = area > 0.0;
    const glm::dvec3 zero(0.0);
    face.is_line = p1 == zero || p2 == zero || p1 == p2;
    face.shapeless =
        face.is_line || !(std::abs(area) > FLT_MIN && glm::length(along_u) > FLT_MIN && glm::length(along_v) > FLT_MIN);
    if (!face.shapeless) face.along_u = DirectionOrZero(along_u) * (face.upright ? 1.0 : -1.0);
    return face;
  }

  std::uint32_t VertexOf(std::uint32_t face, int corner) const {
    return surface_.weld[surface_.triangles[face][corner]];
  }

  // Pairs each edge with the first one in the opposite direction that is free.
  void FindNeighbors() {
    struct Edge {
      std::uint32_t low, high, face;
      int corner;
    };
    std::vector<Edge> edges;
    for (std::uint32_t face = 0; face < faces_.size(); ++face) {
      for (int i = 0; i < 3 && !faces_[face].is_line; ++i) {
        const auto [low, high] = std::minmax({VertexOf(face, i), VertexOf(face, (i + 1) % 3)});
        edges.push_back({low, high, face, i});
      }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
      return std::tie(a.low, a.high, a.face, a.corner) < std::tie(b.low, b.high, b.face, b.corner);
    });
    const auto is_free = [&](const Edge& edge) { return faces_[edge.face].neighbor[edge.corner] == kUnset; };
    const auto rises = [&](const Edge& edge) { return VertexOf(edge.face, edge.corner) == edge.low; };
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (!is_free(edges[i])) continue;
      // Edges on which many triangles meet are compared with few of them: the time stays linear.
      const std::size_t end = std::min(edges.size(), i + kMostOnEdge);
      for (std::size_t j = i + 1; j < end && edges[j].low == edges[i].low && edges[j].high == edges[i].high; ++j) {
        if (rises(edges[i]) == rises(edges[j]) || !is_free(edges[j])) continue;
        faces_[edges[i].face].neighbor[edges[i].corner] = edges[j].face;
        faces_[edges[j].face].neighbor[edges[j].corner] = edges[i].face;
        break;
      }
    }
  }

  // A new group, from one corner over all common edges.
  void Gather(std::uint32_t first, int corner) {
    const auto number = std::uint32_t(groups_.size());
    groups_.push_back({VertexOf(first, corner), faces_[first].upright, {}});
    Group& group = groups_.back();
    pending_.assign(1, first);
    while (!pending_.empty()) {
      const std::uint32_t index = pending_.back();
      pending_.pop_back();
      Face& face = faces_[index];
      int i = 0;
      while (i < 2 && VertexOf(index, i) != group.vertex) ++i;
      if (face.group[i] != kUnset) continue;
      const bool is_new = face.group == std::array{kUnset, kUnset, kUnset};
      if (face.shapeless && is_new) face.upright = group.upright;
      if (face.upright != group.upright) continue;
      face.group[i] = number;
      if (!face.shapeless) group.sum += Share(index, i);
      for (const int edge : {i == 0 ? 2 : i - 1, i}) {  // the last one is the first to be visited
        if (face.neighbor[edge] != kUnset) pending_.push_back(face.neighbor[edge]);
      }
    }
  }

  // A triangle's tangent at a corner, weighted by its angle.
  glm::dvec3 Share(std::uint32_t face, int corner) const {
    const glm::uvec3& triangle = surface_.triangles[face];
    const glm::dvec3 &normal = surface_.normals[triangle[corner]], &place = surface_.positions[triangle[corner]];
    const glm::dvec3 last = LaidInto(normal, surface_.positions[triangle[(corner + 2) % 3]] - place);
    const glm::dvec3 next = LaidInto(normal, surface_.positions[triangle[(corner + 1) % 3]] - place);
    return LaidInto(normal, faces_[face].along_u) * std::acos(std::clamp(glm::dot(last, next), -1.0, 1.0));
  }

  static constexpr std::size_t kMostOnEdge = 64;

  const Surface& surface_;
  std::vector<Face> faces_;
  std::vector<Group> groups_;
  std::vector<std::uint32_t> pending_;
};

}  // namespace

std::vector<std::vector<std::uint32_t>> FillTangents(std::span<const TangentPart> parts, int uv_set,
                                                     const glm::mat3& uv_transform) {
  std::vector<glm::vec4> tangents;
  std::vector<glm::uvec3> of_corners;
  {
    const Surface surface(parts, uv_set, uv_transform);
    const TangentGroups groups(surface);
    tangents = groups.Tangents();
    of_corners = groups.OfCorners();
  }
  std::vector<std::vector<std::uint32_t>> sources(parts.size());
  std::span<const glm::uvec3> remaining = of_corners;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Mesh& mesh = *parts[i].mesh;
    const std::span<const glm::uvec3> own = remaining.first(mesh.triangles.size());
    remaining = remaining.subspan(mesh.triangles.size());
    if (!parts[i].wanted) continue;
    mesh.tangents.clear();
    CornerSplit split = SplitByCorners(own, mesh);
    for (const std::uint32_t tangent : split.values) {
      mesh.tangents.push_back(tangent == kNoValue ? glm::vec4(1, 0, 0, 1) : tangents[tangent]);
    }
    sources[i] = std::move(split.sources);
  }
  return sources;
}

std::vector<std::uint32_t> FillTangents(Mesh& mesh, int uv_set, const glm::mat3& uv_transform) {
  return std::move(FillTangents(std::array{TangentPart{&mesh, true, {}}}, uv_set, uv_transform)[0]);
}

}  // namespace scumble
