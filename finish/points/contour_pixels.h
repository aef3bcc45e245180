// Pixels beside hard contours of light.
#pragma once

#include <span>
#include <vector>

#include "finish/points/point_block.h"

namespace scumble::internal {

// The pixels beside hard contours of the light that steps look at. In the share that lies beyond, the steps see the
// guides of the pixel on that side.
class ContourPixels {
 public:
  // Keeps references to the steps and the guides of the frame.
  ContourPixels(std::span<const PointStep> steps, const FinishFrame& frame);

  bool any() const { return !contours_.empty(); }

  // The row has been painted without them. From several threads.
  void PaintRow(const GivenRow& row, Picture& picture) const;

 private:
  struct Contour {
    const PointStep& step;
    LightContour light;
  };

  std::span<const PointStep> steps_;
  std::vector<Contour> contours_;
};

}  // namespace scumble::internal
