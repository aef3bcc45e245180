// Perspective maps between planes (R. Hartley, A. Zisserman, "Multiple View Geometry", 2nd ed., 2004, section 4.1).
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>

namespace scumble {

// A point under a perspective map.
inline glm::dvec2 Project(const glm::dmat3& map, glm::dvec2 point) {
  const glm::dvec3 p = map * glm::dvec3(point, 1.0);
  return {p.x / p.z, p.y / p.z};
}

// The map that takes `from` to `to` with the least squares of the linear equations, its last element 1; exact for four
// points. Empty for fewer than four points, or where they do not determine the map. The map must not take the origin of
// `from` to infinity.
std::optional<glm::dmat3> FitHomography(std::span<const glm::dvec2> from, std::span<const glm::dvec2> to);

// Solves the normal equations a · x = b of `n` unknowns in place; a is n × n by rows. False where they are singular.
bool SolveLinear(double* a, double* b, int n);

}  // namespace scumble
