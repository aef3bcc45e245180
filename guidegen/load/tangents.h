// Tangents for normal maps, as MikkTSpace defines them (Mikkelsen, "Simulation of wrinkled surfaces revisited", 2008),
// which glTF and Blender prescribe.
//
// Vertices of equal position, normal and texture coordinates are one. The triangles about such a vertex that meet in
// common edges, and whose texture is equally mirrored, form a group with one tangent there: each triangle's own, the
// direction in which u grows, laid into the plane of the vertex's normal, weighted by the triangle's angle in that
// plane. A triangle without an area in the texture adds nothing and takes the tangent of a neighbour. Where there is no
// neighbour either, the tangent is +X, as Blender's.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "guidegen/scene.h"

namespace scumble {

// One material's part of a surface. Groups reach from part to part.
struct TangentPart {
  Mesh* mesh = nullptr;
  bool wanted = true;  // whether it gets tangents
  // v of each vertex before it became glTF's 1 − v, which rounds: Blender's vertices that are not quite equal count as
  // different. Used where it fits the UV set in every vertex of every part.
  std::span<const float> exact_v;
};

// Computes the wanted parts' `tangents` from the normals and one of the UV sets, as transformed by `uv_transform`, in
// glTF's sense: the bitangent cross(normal, tangent) · w points up in the picture, against v. A stretch of a mesh
// (Mesh::stretch) is undone for it. Needs normals and that UV set in every part.
// A vertex whose triangles have different tangents, as at the seam of a mirrored texture, is split. Returns for each
// part, of each vertex, the one that it was; empty where no tangents were wanted.
std::vector<std::vector<std::uint32_t>> FillTangents(std::span<const TangentPart> parts, int uv_set,
                                                     const glm::mat3& uv_transform);

// The same for a mesh by itself.
std::vector<std::uint32_t> FillTangents(Mesh& mesh, int uv_set, const glm::mat3& uv_transform);

}  // namespace scumble
