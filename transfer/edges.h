// Where votes must not cross: object borders, depth steps, creases.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "image/guides.h"

namespace scumble::internal {

// The surface's slope in depth per pixel. A step shows on one side of a pixel only, or turns back on the other, and is no
// slope. Made once for all styles of a picture; the guides must hold depth. O(pixels).
struct DepthSlopes {
  explicit DepthSlopes(const GuideSet& guides);
  std::vector<float> x, y;
};

// Whether two pixels near each other show the same piece of surface:
//   - the same object id;
//   - normals less than `crease` degrees apart; 180 takes any;
//   - a depth difference that the surface's own slope explains: the mean of both pixels' slopes times their distance (the
//     trapezoidal rule), give or take the gentler slope over that distance and `depth_tolerance` of the depth. All of it
//     is relative, so one setting works near and far.
class EdgeTest {
 public:
  // Keeps references to both; `guides` must hold depth and object.
  EdgeTest(const GuideSet& guides, const DepthSlopes& slopes, double crease_degrees, double depth_tolerance);

  // q stands (dx, dy) pixels from p.
  bool SameSurface(std::size_t p, std::size_t q, int dx, int dy) const;

 private:
  const GuideSet& guides_;
  const DepthSlopes& slopes_;
  std::span<const float> depth_, object_;
  float crease_cosine_, depth_tolerance_;
};

}  // namespace scumble::internal
