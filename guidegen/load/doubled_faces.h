// Faces that lie on others. Two-sided surfaces are often modelled by each face twice, the second time turned over.
// Where a loader makes smooth normals, the two would cancel each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace scumble {

struct DoubledFace {
  std::size_t under = 0;  // the first face with these corners; itself, if it is that one
  bool is_turned = false;
};

// By face, which of them have the same corners in any order. `triangles` are corners as numbers of places, where equal
// positions are one place. Triangles of a face follow each other, and `faces` has the face of each, counted from 0.
// Empty if no face lies on another.
std::vector<DoubledFace> FindDoubledFaces(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                                          std::span<const std::uint32_t> faces);

}  // namespace scumble
