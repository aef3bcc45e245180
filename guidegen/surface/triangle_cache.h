// Triangles in view space, prepared for many rays: values that FindSurfacePoint computes anew for each ray.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "guidegen/surface/surface.h"

namespace scumble {

// FindSurfacePoint's data of an object.
struct ObjectRecord {
  double view_from_normal[9];  // columns
  double winding;
  float object_id;
  float material_id;
  // Only a triangle's corners determine its surface: no sphere, no normal map or bump, no missing normals.
  bool interpolates;
};
std::vector<ObjectRecord> MakeObjectRecords(std::span<const PlacedObject> objects);

// FindSurfacePoint's data of a triangle, by equal sums.
struct TriangleRecord {
  double corner[3];       // the first, view space
  double first_edge[3];   // back from the second corner to the first
  double second_edge[3];  // from the first corner to the third
  double area[3];         // the edges' cross product
  double area_length;     // of `area`: twice the triangle's area
  double edge_on;         // kEdgeOn times the longest edge's square, and twice that as a safety margin
  float normal[9];        // of the three corners, object space
  bool regular;           // false: FindSurfacePoint itself is needed here
  // Of caches with points only.
  double facing[3];  // `area` as a unit vector
  double largest_coordinate;
};

// The triangles that were hit last, for one thread. Results do not depend on earlier calls.
class TriangleCache {
 public:
  // The most triangles between two calls of Begin.
  static constexpr std::size_t kMost = 256;

  // Both are borrowed; after a change of either, make a new cache.
  TriangleCache(std::span<const PlacedObject> objects, std::span<const ObjectRecord> records, bool points);

  // Releases nothing yet, but lets earlier records be replaced.
  void Begin() { ++now_; }
  // The record stays in place until the next Begin.
  const TriangleRecord& Find(std::uint32_t object, std::uint32_t primitive) {
    for (std::uint32_t place = primitive + object * 97u;; ++place) {
      Slot& slot = slots_[place % kSize];
      if (slot.object != object || slot.primitive != primitive) {
        if (slot.used == now_) continue;
        slot.object = object;
        slot.primitive = primitive;
        Fill(object, primitive, records_[place % kSize]);
      }
      slot.used = now_;
      return records_[place % kSize];
    }
  }
  std::span<const ObjectRecord> objects() const { return object_records_; }

 private:
  struct Slot {
    std::uint32_t object = ~0u;
    std::uint32_t primitive = 0;
    std::uint64_t used = 0;  // the time of Begin
  };
  static constexpr std::uint32_t kSize = 2 * kMost;

  void Fill(std::uint32_t object, std::uint32_t primitive, TriangleRecord& record) const;

  std::span<const PlacedObject> objects_;
  std::span<const ObjectRecord> object_records_;
  std::vector<Slot> slots_;
  std::vector<TriangleRecord> records_;
  std::uint64_t now_ = 1;
  bool points_;
};

}  // namespace scumble
