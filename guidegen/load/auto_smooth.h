// Normals that a file lacks: flat, or smooth up to an angle between faces, as Blender's Auto Smooth.
//
// Two faces that share an edge are smooth there if their normals are at most the limit apart; an angle that is the
// limit but for rounding (0.01°) is smooth. The faces about a place fall into groups that such edges join, and each
// group has one normal there: the sum of its faces' normals, each weighted by its angle at the place (mesh_normals.h).
//   0     flat: each face has its own normal, also beside a face in its plane
//   180   all faces at a place share one normal, also those that share no edge
// Edges are found by place, so vertices that a file repeats (for texture coordinates) make no border. All edges of a
// place that belong to one triangle only count as one edge: where two surfaces meet with other vertices between, the
// border is smooth, too. Triangles whose normal would be rounding noise, because they are slivers or have no area, have
// no say: the faces at their sides are neighbours of each other, and the sliver takes a normal of theirs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "guidegen/load/split_vertices.h"
#include "guidegen/scene.h"

namespace scumble {

// Degrees, for formats that leave it open.
inline constexpr double kDefaultAutoSmooth = 60.0;

// Triangles and what they share.
struct SmoothingInput {
  std::span<const glm::vec3> positions;
  std::span<const glm::uvec3> triangles;
  std::span<const std::uint32_t> weld;   // of each position, as WeldByPosition gives it
  std::span<const std::uint32_t> faces;  // of each triangle, the polygon that it is a part of; empty: its own
  // Flat faces that follow each other and have equal normals share one, which saves vertices. Not for shapes that will
  // be deformed.
  bool merges_equal = true;
};

// Unit normals, and of each triangle's corners which one.
struct CornerNormals {
  std::vector<glm::vec3> normals;
  std::vector<glm::uvec3> of_corners;
};

// `degrees` in [0, 180]. The result does not depend on the number of threads.
CornerNormals AutoSmoothNormals(const SmoothingInput& input, double degrees);

// Of each vertex of a mesh that normals have split:
struct SplitVertices {
  std::vector<std::uint32_t> sources;  // the vertex that it was
  std::vector<std::uint32_t> shared;   // the first vertex with the same one of the normals, for SmoothNormals
};

// Gives a mesh these normals. A vertex whose corners have several is split: the first keeps its number, further ones
// are appended. All lists of the mesh follow.
SplitVertices SetCornerNormals(const CornerNormals& normals, Mesh& mesh);

// The choice of a loader, and what it says of it.
class MissingNormals {
 public:
  enum class Rule { kFlat, kGroups, kAngle };

  // `degrees` are the user's, for all that lacks normals; none: the format's own rule.
  explicit MissingNormals(std::optional<double> degrees = std::nullopt) : degrees_(degrees) {}

  // Counts triangles without normals that are treated by the format's rule, where the user gives no degrees. Returns
  // the degrees to use; kGroups has none of its own.
  std::optional<double> Take(Rule rule, std::size_t triangles);
  // One line a rule; one that says so where the user's degrees had nothing to do.
  void Tell(std::vector<std::string>& notes) const;

 private:
  std::optional<double> degrees_;
  std::size_t counts_[3] = {};
};

}  // namespace scumble
