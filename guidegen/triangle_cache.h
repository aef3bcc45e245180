// Triangles before the camera, made ready for many rays: what FindSurfacePoint works out again for each of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "guidegen/surface.h"

namespace scumble {

// What FindSurfacePoint takes from an object.
struct ObjectRecord {
  double view_from_normal[9];  // columns
  double winding;
  float object_id;
  float material_id;
  // Nothing but a triangle's corners decides its surface: no sphere, no normal map, no missing normals.
  bool interpolates;
};
std::vector<ObjectRecord> MakeObjectRecords(std::span<const PlacedObject> objects);

// What FindSurfacePoint takes from a triangle, by the same sums.
struct TriangleRecord {
  double corner[3];       // the first, view space
  double first_edge[3];   // back from the second corner to the first
  double second_edge[3];  // from the first corner to the third
  double area[3];         // the edges' cross product
  double facing[3];       // `area` as a unit vector
  double largest_coordinate;
  float normal[9];  // of the three corners, object space
  std::uint32_t object;
  std::uint32_t primitive;
  bool regular;  // false: it takes FindSurfacePoint itself to say what is here
};

// The triangles met last, for one thread. Answers do not depend on what was asked before.
class TriangleCache {
 public:
  // Both are borrowed, and the cache is cleared with every change of them by making a new one.
  TriangleCache(std::span<const PlacedObject> objects, std::span<const ObjectRecord> records);

  const TriangleRecord& Find(std::uint32_t object, std::uint32_t primitive) {
    TriangleRecord& record = records_[(primitive + object * 97u) % kSize];
    if (record.object != object || record.primitive != primitive) Fill(object, primitive, record);
    return record;
  }
  std::span<const ObjectRecord> objects() const { return object_records_; }

 private:
  static constexpr std::uint32_t kSize = 512;

  void Fill(std::uint32_t object, std::uint32_t primitive, TriangleRecord& record) const;

  std::span<const PlacedObject> objects_;
  std::span<const ObjectRecord> object_records_;
  std::vector<TriangleRecord> records_;
};

}  // namespace scumble
