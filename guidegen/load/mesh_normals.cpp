#include "guidegen/load/mesh_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/image/check.h"
#include "guidegen/load/loader_util.h"

namespace scumble {
namespace {

// Sums shorter than this share of their weight have no reliable direction.
constexpr double kVanishing = 1e-6;

struct NormalSum {
  glm::dvec3 sum{0.0};
  double weight = 0.0;
  bool HasDirection() const { return glm::length(sum) > kVanishing * weight && weight > 0.0; }
};

// The unit normal of a triangle and its three angles; false where it has no area.
bool TriangleFrame(std::span<const glm::vec3> positions, const glm::uvec3& triangle, glm::dvec3& normal,
                   std::array<double, 3>& angles) {
  const glm::dvec3 p[3] = {glm::dvec3(positions[triangle.x]), glm::dvec3(positions[triangle.y]),
                           glm::dvec3(positions[triangle.z])};
  const glm::dvec3 cross = glm::cross(p[1] - p[0], p[2] - p[0]);
  const double doubled_area = glm::length(cross);
  if (!(doubled_area > 0.0) || !std::isfinite(doubled_area)) return false;
  normal = cross / doubled_area;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 to_next = p[(i + 1) % 3] - p[i], to_last = p[(i + 2) % 3] - p[i];
    angles[i] = std::atan2(doubled_area, glm::dot(to_next, to_last));
  }
  return true;
}

glm::dvec3 UnitOrZero(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0.0 && std::isfinite(length) ? v / length : glm::dvec3(0.0);
}

}  // namespace

std::vector<std::uint32_t> WeldByPosition(std::span<const glm::vec3> positions) {
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto less = [&](std::uint32_t a, std::uint32_t b) {
    const glm::vec3 &p = positions[a], &q = positions[b];
    if (p.x != q.x) return p.x < q.x;
    if (p.y != q.y) return p.y < q.y;
    if (p.z != q.z) return p.z < q.z;
    return a < b;
  };
  std::sort(order.begin(), order.end(), less);
  std::vector<std::uint32_t> weld(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && positions[order[i]] == positions[order[i - 1]];
    weld[order[i]] = same ? weld[order[i - 1]] : order[i];
  }
  return weld;
}

std::vector<glm::vec3> SmoothNormals(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                                     std::span<const std::uint32_t> weld) {
  SCUMBLE_CHECK_EQ(weld.size(), positions.size());
  std::vector<NormalSum> own(positions.size());
  std::vector<glm::dvec3> first(positions.size(), glm::dvec3(0.0));
  for (const glm::uvec3& triangle : triangles) {
    glm::dvec3 normal;
    std::array<double, 3> angles;
    if (!TriangleFrame(positions, triangle, normal, angles)) continue;
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t vertex = triangle[i];
      own[vertex].sum += angles[i] * normal;
      own[vertex].weight += angles[i];
      if (first[vertex] == glm::dvec3(0.0)) first[vertex] = normal;
    }
  }
  std::vector<NormalSum> joint(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    joint[weld[i]].sum += own[i].sum;
    joint[weld[i]].weight += own[i].weight;
  }
  std::vector<glm::vec3> normals(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    glm::dvec3 normal(0.0, 0.0, 1.0);
    if (joint[weld[i]].HasDirection()) {
      normal = glm::normalize(joint[weld[i]].sum);
    } else if (own[i].HasDirection()) {
      normal = glm::normalize(own[i].sum);
    } else if (first[i] != glm::dvec3(0.0)) {
      normal = first[i];
    }
    normals[i] = glm::vec3(normal);
  }
  return normals;
}

bool HasDirection(const glm::vec3& normal) { return UnitOrZero(glm::dvec3(normal)) != glm::dvec3(0.0); }

std::size_t FillNormals(Mesh& mesh) {
  if (mesh.normals.empty()) {
    mesh.normals = SmoothNormals(mesh.positions, mesh.triangles, WeldByPosition(mesh.positions));
    return 0;
  }
  SCUMBLE_CHECK_EQ(mesh.normals.size(), mesh.positions.size());
  std::vector<std::uint32_t> bad;
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    const glm::dvec3 unit = UnitOrZero(glm::dvec3(mesh.normals[i]));
    if (unit == glm::dvec3(0.0)) bad.push_back(static_cast<std::uint32_t>(i));
    mesh.normals[i] = glm::vec3(unit);
  }
  if (!bad.empty()) {
    const std::vector<glm::vec3> smooth = SmoothNormals(mesh.positions, mesh.triangles, WeldByPosition(mesh.positions));
    for (std::uint32_t i : bad) mesh.normals[i] = smooth[i];
  }
  return bad.size();
}

}  // namespace scumble
