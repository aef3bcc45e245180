// Where suggestive contours may run.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image/finish_pass.h"
#include "core/image/guides.h"
#include "finish/area/float_plane.h"

namespace scumble::internal {

// Valleys of c, the cosine between the normal and the direction to the viewer: DeCarlo, Finkelstein, Rusinkiewicz,
// Santella, "Suggestive Contours for Conveying Shape", 2003, section 2. There c has a minimum along w, the viewer's
// direction laid on the surface. w is seen in the picture as the normal's part across the view. With r the pass's
// reach:
//   slope = c(p + r/2 · w) - c(p - r/2 · w), which changes its sign in the middle of a valley;
//   depth = the smaller of c(p + r · w) and c(p - r · w), less c(p), which must be the pass's suggestive_depth or more.
// There is none where one of those places belongs to another object or to none.
class Valleys {
 public:
  // `scale`: pixels for one of the reference height. The guides hold coverage, normal and object. O(pixels).
  Valleys(const OutlinePass& pass, const GuideSet& guides, double scale);

  // Whether the middle of a valley lies between two neighbouring pixels.
  bool Between(std::size_t p, std::size_t q) const {
    if (!((slope_[p] < 0.0f) != (slope_[q] < 0.0f)) || !(is_deep_[p] || is_deep_[q])) return false;
    return along_x_[p] * along_x_[q] + along_y_[p] * along_y_[q] > 0.5f;
  }

 private:
  FloatPlane slope_, along_x_, along_y_;  // along: w in the picture, a unit vector; 0 where there is no slope
  std::vector<std::uint8_t> is_deep_;
};

}  // namespace scumble::internal
