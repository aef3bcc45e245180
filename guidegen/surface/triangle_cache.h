// Triangles in view space, prepared for many rays: values that FindSurfacePoint computes anew for each ray.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "guidegen/surface/surface.h"

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
  double edge_on;         // kEdgeOn times the longest edge's square, and twice that so as to err on the safe side
  float normal[9];        // of the three corners, object space
  bool regular;           // false: it takes FindSurfacePoint itself to say what is here
  // Of caches with points only.
  double facing[3];  // `area` as a unit vector
  double largest_coordinate;
};

// The triangles met last, for one thread. Answers do not depend on what was asked before.
class TriangleCache {
 public:
  // Between two calls of Begin at most so many different triangles may be asked for.
  static constexpr std::size_t kMost = 256;

  // Both are borrowed, and the cache is cleared with every change of them by making a new one.
  TriangleCache(std::span<const PlacedObject> objects, std::span<const ObjectRecord> records, bool points);

  // Forgets nothing, but what was found before may go now.
  void Begin() { ++now_; }
  // What is found stays where it is until the next Begin.
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
