// Where votes must not cross: object borders, depth steps, creases.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "image/guides.h"

namespace scumble::internal {

// Whether two pixels near each other show the same piece of surface:
//   - the same object id;
//   - normals less than 60° apart;
//   - a depth difference that the surface's own slope explains: the mean of both pixels' slopes times their distance (the
//     trapezoidal rule), give or take the gentler slope over that distance and 0.002 of the depth. A step shows on one side of a pixel only, or
//     turns back on the other, and is no slope. All of it is relative, so one setting works near and far.
class EdgeTest {
 public:
  // Keeps a reference to `guides`, which must hold depth and object. O(pixels).
  explicit EdgeTest(const GuideSet& guides);

  // q stands (dx, dy) pixels from p.
  bool SameSurface(std::size_t p, std::size_t q, int dx, int dy) const;

 private:
  const GuideSet& guides_;
  std::span<const float> depth_, object_;
  std::vector<float> slope_x_, slope_y_;
};

}  // namespace scumble::internal
