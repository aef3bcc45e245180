#include "guidegen/load/obj/obj_normals.h"

#include <map>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "core/image/hash.h"
#include "guidegen/load/auto_smooth.h"
#include "guidegen/load/doubled_faces.h"
#include "guidegen/load/mesh_normals.h"

namespace scumble {
namespace {

// Corners of smoothing groups with equal keys share a normal.
struct SmoothKey {
  std::uint32_t place = 0;  // the same for positions that are equal
  unsigned group = 0;
  bool operator==(const SmoothKey&) const = default;
};
struct SmoothKeyHash {
  std::size_t operator()(const SmoothKey& k) const { return Hash(k.place, k.group); }
};

// All faces of a group at one place share a normal there. `groups` are those of the input's triangles; in group 0 they
// keep their normals.
void SmoothInsideGroups(const SmoothingInput& input, std::span<const unsigned> groups, CornerNormals& normals) {
  std::unordered_map<SmoothKey, std::uint32_t, SmoothKeyHash> ids;
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  const auto first = static_cast<std::uint32_t>(normals.normals.size());
  for (std::size_t t = 0; t < input.triangles.size(); ++t) {
    if (groups[t] == 0) continue;
    glm::uvec3 indices(0);
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t place = input.weld[input.triangles[t][i]];
      const auto [it, is_new] =
          ids.try_emplace(SmoothKey{place, groups[t]}, static_cast<std::uint32_t>(positions.size()));
      if (is_new) positions.push_back(input.positions[place]);
      indices[i] = it->second;
    }
    triangles.push_back(indices);
    normals.of_corners[t] = indices + first;
  }
  std::vector<std::uint32_t> own(positions.size());
  std::iota(own.begin(), own.end(), 0u);
  const std::vector<glm::vec3> smooth = SmoothNormals(positions, triangles, own);
  normals.normals.insert(normals.normals.end(), smooth.begin(), smooth.end());
}

// Faces that lie on others have the normals of those, turned over as they are.
void TakeNormalsFromUnder(std::span<const DoubledFace> doubled, std::span<const std::uint32_t> weld,
                          std::span<ObjTriangle> triangles, ObjNormals& normals) {
  std::vector<bool> is_under(doubled.size(), false);
  for (std::size_t f = 0; f < doubled.size(); ++f) {
    if (doubled[f].under != f) is_under[doubled[f].under] = true;
  }
  std::map<std::pair<std::size_t, std::uint32_t>, ObjCorner> corners;  // by face and place
  std::map<std::int64_t, std::int64_t> turned;
  for (ObjTriangle& triangle : triangles) {
    const DoubledFace& face = doubled[triangle.face];
    for (ObjCorner& corner : triangle.corners) {
      const std::uint32_t place = weld[std::size_t(corner.position)];
      if (is_under[triangle.face]) corners.try_emplace({triangle.face, place}, corner);
      if (face.under == triangle.face || corner.normal >= 0) continue;
      const ObjCorner& under = corners.at({face.under, place});
      corner.normal = under.normal;
      if (!face.is_turned) continue;
      const auto [found, is_new] = turned.try_emplace(under.normal, -1 - std::int64_t(normals.made.size()));
      if (is_new) normals.made.push_back(-normals.At(under));
      corner.normal = found->second;
    }
  }
}

}  // namespace

glm::vec3 ObjNormals::At(const ObjCorner& corner) const {
  if (corner.normal < 0) return made[std::size_t(-1 - corner.normal)];
  const double* n = given.data() + 3 * std::size_t(corner.normal);
  return {n[0], n[1], n[2]};
}

void MakeObjNormals(const ObjPlaces& places, std::optional<double> degrees, std::span<ObjTriangle> triangles,
                    ObjNormals& normals) {
  const std::vector<std::uint32_t> weld = WeldFrames(places);
  std::vector<glm::uvec3> vertices, welded;  // of each triangle's corners
  std::vector<std::uint32_t> faces;
  for (const ObjTriangle& triangle : triangles) {
    const ObjCorner* const c = triangle.corners;
    vertices.emplace_back(c[0].position, c[1].position, c[2].position);
    welded.emplace_back(weld[vertices.back().x], weld[vertices.back().y], weld[vertices.back().z]);
    faces.push_back(static_cast<std::uint32_t>(triangle.face));
  }
  const std::vector<DoubledFace> doubled = FindDoubledFaces(places.positions, welded, faces);
  const auto is_kept = [&](std::size_t t) { return doubled.empty() || doubled[faces[t]].under == faces[t]; };
  std::vector<std::size_t> kept;
  std::vector<unsigned> groups;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!is_kept(t)) continue;
    vertices[kept.size()] = vertices[t], faces[kept.size()] = faces[t];
    groups.push_back(triangles[t].smoothing_group);
    kept.push_back(t);
  }
  vertices.resize(kept.size()), faces.resize(kept.size());
  const SmoothingInput input{places.positions, vertices, weld, faces};
  // Where there are groups, these are the normals of faces outside of all groups.
  CornerNormals made = AutoSmoothNormals(input, degrees.value_or(0.0));
  if (!degrees) SmoothInsideGroups(input, groups, made);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    for (int i = 0; i < 3; ++i) {
      ObjCorner& corner = triangles[kept[k]].corners[i];
      if (corner.normal < 0) corner.normal = -1 - std::int64_t(made.of_corners[k][i]);
    }
  }
  normals.made = std::move(made.normals);
  if (!doubled.empty()) TakeNormalsFromUnder(doubled, weld, triangles, normals);
}

}  // namespace scumble
