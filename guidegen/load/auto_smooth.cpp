#include "guidegen/load/auto_smooth.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <sstream>

#include "core/image/check.h"
#include "core/image/exact_math.h"
#include "guidegen/load/mesh_normals.h"

namespace scumble {
namespace {

// Above the rounding of corners in text or floats, and below what anybody means to model.
constexpr double kAngleRounding = 0.01;  // degrees
// A face lower than this share of its length or its distance from the origin has a normal of rounding noise: corners
// are rounded by 2⁻²⁴ of their distance.
constexpr double kSliver = 0x1.0p-21;
// Faces on one edge that are compared each with each; beyond, each with the next. Real edges have two, sheets that are
// modelled with both sides four.
constexpr std::size_t kMostOnEdge = 16;

struct Face {
  glm::dvec3 normal{0.0};  // unit; 0 where the area is 0
  bool is_reliable = false;
};

std::vector<Face> FacesOf(const SmoothingInput& input) {
  std::vector<Face> faces(input.faces.empty()
                              ? input.triangles.size()
                              : std::size_t(*std::max_element(input.faces.begin(), input.faces.end())) + 1);
  std::vector<double> extents(faces.size(), 0.0);  // the longest edge, or distance from the origin
  std::vector<double> lengths(faces.size(), 0.0);
  for (std::size_t t = 0; t < input.triangles.size(); ++t) {
    const std::size_t f = input.faces.empty() ? t : input.faces[t];
    const glm::uvec3& triangle = input.triangles[t];
    glm::dvec3 p[3];
    for (int i = 0; i < 3; ++i) p[i] = glm::dvec3(input.positions[triangle[i]]);
    faces[f].normal += glm::cross(p[1] - p[0], p[2] - p[0]);
    for (int i = 0; i < 3; ++i) {
      const double edge = glm::length(p[(i + 1) % 3] - p[i]);
      lengths[f] = std::max(lengths[f], edge);
      extents[f] = std::max({extents[f], edge, std::abs(p[i].x), std::abs(p[i].y), std::abs(p[i].z)});
    }
  }
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const double area = glm::length(faces[f].normal);
    if (!(area > 0.0) || !std::isfinite(area)) {
      faces[f].normal = glm::dvec3(0.0);
      continue;
    }
    faces[f].normal /= area;
    faces[f].is_reliable = area > kSliver * extents[f] * lengths[f];
  }
  return faces;
}

// The corners at each place: corner 3 t + i is that of triangle t at its vertex i.
struct CornersByPlace {
  std::vector<std::uint32_t> begin;  // of each place in `corners`, and the end
  std::vector<std::uint32_t> corners;

  explicit CornersByPlace(const SmoothingInput& input) : begin(input.positions.size() + 1), corners() {
    for (const glm::uvec3& triangle : input.triangles) {
      for (int i = 0; i < 3; ++i) ++begin[input.weld[triangle[i]] + 1];
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    corners.resize(begin.back());
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (std::uint32_t t = 0; t < input.triangles.size(); ++t) {
      for (std::uint32_t i = 0; i < 3; ++i) corners[next[input.weld[input.triangles[t][int(i)]]]++] = 3 * t + i;
    }
  }
};

// Sets that are joined, each named after its least member.
class JoinedSets {
 public:
  void Reset(std::size_t count) {
    parents_.resize(count);
    std::iota(parents_.begin(), parents_.end(), 0u);
  }
  std::uint32_t Find(std::uint32_t member) {
    while (parents_[member] != member) member = parents_[member] = parents_[parents_[member]];
    return member;
  }
  void Join(std::uint32_t a, std::uint32_t b) {
    a = Find(a), b = Find(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parents_;
};

// Finds the groups of faces about one place after another. One a thread.
class PlaceSmoother {
 public:
  PlaceSmoother(const SmoothingInput& input, std::span<const Face> faces, double cosine)
      : input_(input), faces_(faces), cosine_(cosine) {}

  // `corners` are those of one place. Of each, writes the first corner of its group, and at that one the normal.
  void Smooth(std::span<const std::uint32_t> corners, std::span<std::uint32_t> leaders, std::span<glm::vec3> normals) {
    corners_ = corners;
    CollectEdges();
    ChooseUsable();
    groups_.Reset(corners.size());
    edges_of_place_.Reset(ends_.size());
    JoinAcrossSlivers();
    JoinAlongEdges();
    GiveSliversNeighbours();
    StoreNormals(leaders, normals);
  }

 private:
  // One end of an edge at the place; the other end is at place `other`.
  struct EdgeEnd {
    std::uint32_t other = 0;
    std::uint32_t corner = 0;  // in corners_
    bool operator<(const EdgeEnd& b) const { return other != b.other ? other < b.other : corner < b.corner; }
  };

  const Face& FaceOf(std::uint32_t corner) const {
    const std::size_t t = corners_[corner] / 3;
    return faces_[input_.faces.empty() ? t : input_.faces[t]];
  }

  glm::dvec3 PositionOf(std::uint32_t corner, std::uint32_t turn) const {
    const std::uint32_t number = corners_[corner];
    return glm::dvec3(input_.positions[input_.triangles[number / 3][int((number % 3 + turn) % 3)]]);
  }

  // Corners about the place with their edges, ordered by the edges' other ends. Edge numbers: index of the first end.
  void CollectEdges() {
    ends_.clear();
    for (std::uint32_t c = 0; c < corners_.size(); ++c) {
      const glm::uvec3& triangle = input_.triangles[corners_[c] / 3];
      const std::uint32_t i = corners_[c] % 3, place = input_.weld[triangle[int(i)]];
      for (std::uint32_t turn = 1; turn < 3; ++turn) {
        const std::uint32_t other = input_.weld[triangle[int((i + turn) % 3)]];
        if (other != place) ends_.push_back({other, c});
      }
    }
    std::sort(ends_.begin(), ends_.end());
  }

  // Slivers have no say, unless there is nothing else here.
  void ChooseUsable() {
    usable_.assign(corners_.size(), 0);
    bool any = false;
    for (std::uint32_t c = 0; c < corners_.size(); ++c) {
      usable_[c] = FaceOf(c).is_reliable;
      any = any || FaceOf(c).is_reliable;
    }
    if (any) return;
    for (std::uint32_t c = 0; c < corners_.size(); ++c) usable_[c] = FaceOf(c).normal != glm::dvec3(0.0);
  }

  std::uint32_t EndOf(std::uint32_t first) const {
    std::uint32_t end = first + 1;
    while (end < ends_.size() && ends_[end].other == ends_[first].other) ++end;
    return end;
  }

  // The two edges of a sliver are one, and so are all edges of a single triangle.
  void JoinAcrossSlivers() {
    edges_of_corner_.assign(corners_.size(), {kNone, kNone});
    std::uint32_t open = kNone;
    for (std::uint32_t first = 0, end; first < ends_.size(); first = end) {
      end = EndOf(first);
      for (std::uint32_t e = first; e < end; ++e) {
        auto& edges = edges_of_corner_[ends_[e].corner];
        edges[edges[0] != kNone] = first;
        edges_of_place_.Join(first, e);
      }
      if (end - first > 1) continue;
      if (open == kNone) open = first;
      edges_of_place_.Join(open, first);
    }
    for (std::uint32_t c = 0; c < corners_.size(); ++c) {
      const auto& edges = edges_of_corner_[c];
      if (!usable_[c] && edges[1] != kNone) edges_of_place_.Join(edges[0], edges[1]);
    }
  }

  void JoinAlongEdges() {
    by_edge_.clear();
    for (std::uint32_t e = 0; e < ends_.size(); ++e) {
      if (usable_[ends_[e].corner]) by_edge_.push_back({edges_of_place_.Find(e), ends_[e].corner});
    }
    std::sort(by_edge_.begin(), by_edge_.end());
    for (std::size_t first = 0, end; first < by_edge_.size(); first = end) {
      end = first + 1;
      while (end < by_edge_.size() && by_edge_[end].other == by_edge_[first].other) ++end;
      const std::size_t reach = end - first > kMostOnEdge ? 1 : kMostOnEdge;
      for (std::size_t a = first; a < end; ++a) {
        for (std::size_t b = a + 1; b < std::min(end, a + 1 + reach); ++b) {
          const Face &face_a = FaceOf(by_edge_[a].corner), &face_b = FaceOf(by_edge_[b].corner);
          const bool joins = &face_a == &face_b || glm::dot(face_a.normal, face_b.normal) >= cosine_;
          if (joins) groups_.Join(by_edge_[a].corner, by_edge_[b].corner);
        }
      }
    }
  }

  // The first usable corner at one of its edges, otherwise the first one here.
  void GiveSliversNeighbours() {
    const auto at_edge = [this](std::uint32_t edge) {
      const EdgeEnd wanted{edges_of_place_.Find(edge), 0};
      const auto found = std::lower_bound(by_edge_.begin(), by_edge_.end(), wanted);
      return found != by_edge_.end() && found->other == wanted.other ? found->corner : kNone;
    };
    const auto first = static_cast<std::uint32_t>(std::find(usable_.begin(), usable_.end(), 1) - usable_.begin());
    for (std::uint32_t c = 0; c < corners_.size(); ++c) {
      if (usable_[c]) continue;
      std::uint32_t neighbour = first < corners_.size() ? first : 0;
      for (const std::uint32_t edge : edges_of_corner_[c]) {
        const std::uint32_t found = edge == kNone ? kNone : at_edge(edge);
        if (found == kNone) continue;
        neighbour = found;
        break;
      }
      groups_.Join(neighbour, c);
    }
  }

  double AngleAt(std::uint32_t corner) const {
    const glm::dvec3 p = PositionOf(corner, 0);
    const glm::dvec3 a = PositionOf(corner, 1) - p, b = PositionOf(corner, 2) - p;
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
  }

  void StoreNormals(std::span<std::uint32_t> leaders, std::span<glm::vec3> normals) {
    sums_.assign(corners_.size(), glm::dvec3(0.0));
    weights_.assign(corners_.size(), 0.0);
    for (std::uint32_t c = 0; c < corners_.size(); ++c) {
      const std::uint32_t group = groups_.Find(c);
      leaders[corners_[c]] = corners_[group];
      if (!usable_[c]) continue;
      const double angle = AngleAt(c);
      sums_[group] += angle * FaceOf(c).normal;
      weights_[group] += angle;
    }
    for (std::uint32_t c = 0; c < corners_.size(); ++c) {
      const std::uint32_t group = groups_.Find(c);
      const double length = glm::length(sums_[group]);
      if (length > 1e-6 * weights_[group] && weights_[group] > 0.0) {
        normals[corners_[c]] = glm::vec3(sums_[group] / length);
        continue;
      }
      // Faces that cancel each other keep their own normals.
      const glm::dvec3& own = FaceOf(c).normal;
      leaders[corners_[c]] = corners_[c];
      normals[corners_[c]] = own != glm::dvec3(0.0) ? glm::vec3(own) : glm::vec3(0.0f, 0.0f, 1.0f);
    }
  }

  static constexpr std::uint32_t kNone = ~0u;

  const SmoothingInput& input_;
  const std::span<const Face> faces_;
  const double cosine_;
  std::span<const std::uint32_t> corners_;
  std::vector<EdgeEnd> ends_;
  std::vector<char> usable_;
  std::vector<std::array<std::uint32_t, 2>> edges_of_corner_;
  std::vector<EdgeEnd> by_edge_;  // of usable corners; `other` is the edge
  JoinedSets edges_of_place_, groups_;
  std::vector<glm::dvec3> sums_;
  std::vector<double> weights_;
};

CornerNormals FlatNormals(const SmoothingInput& input) {
  CornerNormals result;
  std::vector<std::uint32_t> of_face;
  for (const Face& face : FacesOf(input)) {
    const glm::vec3 normal = face.normal != glm::dvec3(0.0) ? glm::vec3(face.normal) : glm::vec3(0.0f, 0.0f, 1.0f);
    const bool merges = input.merges_equal && !result.normals.empty() && result.normals.back() == normal;
    if (!merges) result.normals.push_back(normal);
    of_face.push_back(static_cast<std::uint32_t>(result.normals.size()) - 1);
  }
  for (std::size_t t = 0; t < input.triangles.size(); ++t) {
    result.of_corners.emplace_back(of_face[input.faces.empty() ? t : input.faces[t]]);
  }
  return result;
}

// One normal for all corners at a place.
CornerNormals NormalsOfPlaces(const SmoothingInput& input) {
  CornerNormals result;
  result.normals = SmoothNormals(input.positions, input.triangles, input.weld);
  result.of_corners.assign(input.triangles.begin(), input.triangles.end());
  return result;
}

}  // namespace

CornerNormals AutoSmoothNormals(const SmoothingInput& input, double degrees) {
  SCUMBLE_CHECK(degrees >= 0.0 && degrees <= 180.0);
  SCUMBLE_CHECK_EQ(input.weld.size(), input.positions.size());
  if (input.triangles.empty()) return {};
  if (degrees == 0.0) return FlatNormals(input);
  if (degrees == 180.0) return NormalsOfPlaces(input);
  const std::vector<Face> faces = FacesOf(input);
  const CornersByPlace by_place(input);
  std::vector<std::uint32_t> leaders(by_place.corners.size());
  std::vector<glm::vec3> normals(leaders.size());
  const double cosine = degrees + kAngleRounding < 180.0 ? CosDegrees(degrees + kAngleRounding) : -1.0;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, input.positions.size(), 4096), [&](const auto& range) {
    PlaceSmoother smoother(input, faces, cosine);
    for (std::size_t place = range.begin(); place < range.end(); ++place) {
      const std::size_t begin = by_place.begin[place], count = by_place.begin[place + 1] - begin;
      if (count > 0) smoother.Smooth(std::span(by_place.corners).subspan(begin, count), leaders, normals);
    }
  });
  CornerNormals result;
  constexpr std::uint32_t kUnnumbered = ~0u;
  std::vector<std::uint32_t> numbers(leaders.size(), kUnnumbered);
  for (std::size_t corner = 0; corner < leaders.size(); corner += 3) {
    glm::uvec3 of_corner(0);
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t leader = leaders[corner + std::size_t(i)];
      if (numbers[leader] == kUnnumbered) {
        numbers[leader] = static_cast<std::uint32_t>(result.normals.size());
        result.normals.push_back(normals[leader]);
      }
      of_corner[i] = numbers[leader];
    }
    result.of_corners.push_back(of_corner);
  }
  return result;
}

SplitVertices SetCornerNormals(const CornerNormals& normals, Mesh& mesh) {
  mesh.normals.clear();
  CornerSplit corners = SplitByCorners(normals.of_corners, mesh);
  SplitVertices split;
  split.sources = std::move(corners.sources);
  mesh.normals.assign(mesh.positions.size(), glm::vec3(0.0f, 0.0f, 1.0f));
  split.shared.resize(mesh.positions.size());
  std::vector<std::uint32_t> owner(normals.normals.size(), kNoValue);
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    split.shared[v] = v;
    const std::uint32_t normal = corners.values[v];
    if (normal == kNoValue) continue;
    mesh.normals[v] = normals.normals[normal];
    if (owner[normal] == kNoValue) owner[normal] = v;
    split.shared[v] = owner[normal];
  }
  return split;
}

std::optional<double> MissingNormals::Take(Rule rule, std::size_t triangles) {
  counts_[static_cast<int>(rule)] += triangles;
  if (degrees_) return degrees_;
  if (rule == Rule::kGroups) return std::nullopt;
  return rule == Rule::kFlat ? 0.0 : kDefaultAutoSmooth;
}

void MissingNormals::Tell(std::vector<std::string>& notes) const {
  const auto way = [](double degrees) -> std::string {
    std::ostringstream text;
    text << "smooth up to " << degrees << "°";
    return degrees == 0.0 ? "flat" : degrees == 180.0 ? "smooth everywhere" : text.str();
  };
  const auto triangles = [](std::size_t count) {
    return std::to_string(count) + (count == 1 ? " triangle without normals is " : " triangles without normals are ");
  };
  if (degrees_) {
    const std::size_t all = counts_[0] + counts_[1] + counts_[2];
    notes.push_back(all > 0 ? triangles(all) + way(*degrees_) + ", as --auto-smooth says"
                            : "--auto-smooth changes nothing: the file gives all its normals");
    return;
  }
  const std::string ways[] = {"flat, as glTF demands", "smooth as the file's smoothing groups say",
                              way(kDefaultAutoSmooth)};
  for (int rule = 0; rule < 3; ++rule) {
    if (counts_[rule] == 0) continue;
    notes.push_back(triangles(counts_[rule]) + ways[rule] + "; --auto-smooth DEGREES changes it");
  }
}

}  // namespace scumble
