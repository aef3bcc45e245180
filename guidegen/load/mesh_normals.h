// Normals for meshes whose files give none.
//
// Normals here are smooth; guidegen/load/auto_smooth.h limits that by an angle. They are the sum of the adjoining
// triangles' normals, each weighted by its angle at the vertex (Thürmer & Wüthrich, "Computing vertex normals from
// polygonal facets", 1998), so they do not depend on the triangulation.
// Sums are in double and in the order of the triangles: the same bits every time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "guidegen/scene.h"

namespace scumble {

// One id per vertex; vertices at exactly the same place share one. Positions must not be NaN.
std::vector<std::uint32_t> WeldByPosition(std::span<const glm::vec3> positions);

// One unit normal per vertex; vertices with equal `weld` ids share theirs. If the shared normal vanishes (a sheet
// modelled with both sides), a vertex takes that of its own triangles; without any triangle of positive area, +Z.
// Indices must be valid; `weld` ids must be below the number of positions.
std::vector<glm::vec3> SmoothNormals(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                                     std::span<const std::uint32_t> weld);

// Whether a normal has one: not zero, NaN or infinite.
bool HasDirection(const glm::vec3& normal);

// Makes mesh.normals one unit normal per vertex: those given are normalised, missing ones and ones that have no
// direction become smooth, welded by position. Returns how many given normals were replaced.
std::size_t FillNormals(Mesh& mesh);

}  // namespace scumble
