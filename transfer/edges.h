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
//   - a depth difference that the surface's own slope explains: |Δz| ≤ 2·slope·|Δ| + 0.002·z, where the slope is depth
//     per pixel, the smaller of both sides' differences (the larger side may be the edge itself) and the steeper of
//     the two pixels'. It is relative to slope and distance, so one setting works near and far.
class EdgeTest {
 public:
  // Keeps a reference to `guides`, which must hold depth and object. O(pixels).
  explicit EdgeTest(const GuideSet& guides);

  bool SameSurface(std::size_t p, std::size_t q, int dx, int dy) const;

 private:
  const GuideSet& guides_;
  std::span<const float> depth_, object_;
  std::vector<float> slope_x_, slope_y_;
};

}  // namespace scumble::internal
