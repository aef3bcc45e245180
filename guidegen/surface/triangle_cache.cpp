#include "guidegen/surface/triangle_cache.h"

#include <algorithm>
#include <cmath>

#include "guidegen/surface/normal_map.h"

namespace scumble {
namespace {

void Put(const glm::dvec3& v, double (&to)[3]) {
  for (int axis = 0; axis < 3; ++axis) to[axis] = v[axis];
}

}  // namespace

std::vector<ObjectRecord> MakeObjectRecords(std::span<const PlacedObject> objects) {
  std::vector<ObjectRecord> records;
  for (const PlacedObject& object : objects) {
    ObjectRecord record;
    for (int column = 0; column < 3; ++column) {
      for (int row = 0; row < 3; ++row)
        record.view_from_normal[3 * column + row] = object.view_from_normal[column][row];
    }
    record.winding = object.winding;
    record.object_id = float(object.object_id);
    record.material_id = float(object.material_id);
    record.interpolates = object.mesh && !object.mesh->normals.empty() && !ChangesNormals(object);
    records.push_back(record);
  }
  return records;
}

TriangleCache::TriangleCache(std::span<const PlacedObject> objects, std::span<const ObjectRecord> records, bool points)
    : objects_(objects), object_records_(records), slots_(kSize), records_(kSize), points_(points) {}

void TriangleCache::Fill(std::uint32_t object, std::uint32_t primitive, TriangleRecord& record) const {
  record.regular = object_records_[object].interpolates;
  if (!record.regular) return;
  const Mesh& mesh = *objects_[object].mesh;
  const Triangle triangle = ViewTriangle(objects_[object], primitive);
  const glm::dvec3 area = glm::cross(triangle.corner[1] - triangle.corner[0], triangle.corner[2] - triangle.corner[0]);
  Put(triangle.corner[0], record.corner);
  Put(triangle.corner[0] - triangle.corner[1], record.first_edge);
  Put(triangle.corner[2] - triangle.corner[0], record.second_edge);
  Put(area, record.area);
  const double squared = glm::dot(area, area);
  record.area_length = std::sqrt(squared);
  record.edge_on = 2.0 * kEdgeOn * LongestEdgeSquared(triangle);
  record.regular = squared > kLeastPlainSquare && squared < kLargestPlainSquare;
  for (int corner = 0; corner < 3; ++corner) {
    const glm::vec3 normal = mesh.normals[mesh.triangles[primitive][corner]];
    for (int axis = 0; axis < 3; ++axis) record.normal[3 * corner + axis] = normal[axis];
  }
  if (!points_ || !record.regular) return;
  Put(area * (1.0 / std::sqrt(squared)), record.facing);
  record.largest_coordinate = 0.0;
  for (const glm::dvec3& corner : triangle.corner) {
    record.largest_coordinate = std::max(record.largest_coordinate, LargestCoordinate(corner));
  }
}

}  // namespace scumble
