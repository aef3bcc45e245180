// Nearest neighbours of directions by a table: the cost of one lookup does not depend on the exemplar.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "transfer/nearest/guide_tree.h"
#include "transfer/source.h"

namespace scumble {

// The direction for a lookup, always of length 1 and facing the viewer. A normal that faces away takes the rim along
// its (x, y), (0, 0, -1) the rim at +Y; NaN, infinity and the zero vector take the direction of the viewer.
inline glm::vec3 FacingDirection(glm::vec3 normal) {
  float length = std::sqrt(normal.x * normal.x + normal.y * normal.y + normal.z * normal.z);
  if (!(length > 0.0f && length <= 3.0e38f)) return {0.0f, 0.0f, 1.0f};
  if (normal.z < 0.0f) {
    length = std::sqrt(normal.x * normal.x + normal.y * normal.y);
    if (!(length > 0.0f)) return {0.0f, 1.0f, 0.0f};
    return {normal.x / length, normal.y / length, 0.0f};
  }
  return {normal.x / length, normal.y / length, normal.z / length};
}

// Lambert's azimuthal equal-area projection of the hemisphere that faces the viewer onto the unit disc,
// (x, y) / √(1 + z).
inline glm::vec2 ProjectDirection(glm::vec3 facing) {
  const float scale = 1.0f / std::sqrt(1.0f + facing.z);
  return {scale * facing.x, scale * facing.y};
}
// Its inverse; a point outside the disc is taken to its edge.
glm::vec3 DirectionAt(double px, double py);

// The hemisphere of directions that face the viewer, mapped to [-1, 1]² by ProjectDirection and cut into R × R cells.
// Each cell holds the source nearest to the direction at its centre. Equal areas, because a table over plain (x, y) is
// ten times as coarse at the rim as in the middle. Immutable and thread-safe.
class LookUpTable {
 public:
  static constexpr int kResolution = 512;

  // `sources` are the tree's points, of unit normals, in the order given to it. Runs on all threads of the caller's
  // oneTBB arena; the result does not depend on them.
  LookUpTable(const PointTree& normals, std::span<const Source> sources, int resolution);

  int resolution() const { return resolution_; }

  // The source for a FacingDirection: at most Quantisation() farther from it, in Euclidean distance, than the nearest.
  Source Find(glm::vec3 direction) const { return cells_[CellOf(direction)]; }

  // 4√2 / R. Two directions whose projections are d apart are at most 2d apart, and a cell's corner is √2 / R from its
  // centre. By the triangle inequality, the centre's nearest source exceeds a direction's own by at most twice that
  // distance.
  static double Quantisation(int resolution);

  // For storage: 4 bytes a cell, x before y, little endian. Stored bytes are accepted only if their size fits the
  // resolution; the caller checks whether the sources are usable.
  std::vector<std::byte> ToBytes() const;
  static std::optional<LookUpTable> FromBytes(std::span<const std::byte> bytes, int resolution);

  // Half a Source, so that a table of the usual size stays in a core's cache.
  struct Cell {
    std::uint16_t x = 0, y = 0;
    operator Source() const { return {x, y}; }
  };
  std::span<const Cell> cells() const { return cells_; }

 private:
  explicit LookUpTable(int resolution) : resolution_(resolution), cells_(std::size_t(resolution) * resolution) {}
  std::size_t CellOf(glm::vec3 direction) const {
    const glm::vec2 p = ProjectDirection(direction);
    const float half = 0.5f * static_cast<float>(resolution_);
    const int i = std::clamp(static_cast<int>(half + half * p.x), 0, resolution_ - 1);
    const int j = std::clamp(static_cast<int>(half - half * p.y), 0, resolution_ - 1);
    return std::size_t(j) * static_cast<std::size_t>(resolution_) + static_cast<std::size_t>(i);
  }

  int resolution_;
  std::vector<Cell> cells_;  // rows from +Y down
};

}  // namespace scumble
