// Colours by tone and detail, for toon with shading = ramp (Barla, Thollot, Markosian, "X-Toon", 2006).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "finish/finish.h"
#include "finish/tone/depth_scale.h"
#include "finish/tone/point_effect.h"
#include "finish/tone/view_rays.h"

namespace scumble::internal {

// The row of a ramp, 0 … 1 from its first to its last. Keeps references to the guides.
class RampRows {
 public:
  RampRows(const ToonPass& pass, const FinishFrame& frame);
  // 0 … 1, of any floats; of pixels of one row of the picture.
  void At(std::size_t first, std::size_t count, float* rows) const;

 private:
  float Depth(std::size_t pixel) const;

  std::span<const float> depth_;
  double near_ = 1.0, far_ = 1.0;
  Curve of_depth_;

  std::span<const float> highlight_[3];
  float bright_ = 1.0f;  // the luminance of a full highlight

  std::span<const float> normal_[3];
  ViewRays rays_;
  std::size_t width_ = 1;
};

// The ramp's colours in Oklab, interpolated along rows and columns.
class RampColors {
 public:
  explicit RampColors(const ColorRamp& ramp);
  // Both 0 … 1.
  LabColor At(float tone, float row) const;

 private:
  int columns_, rows_;
  std::vector<LabColor> colors_;
};

}  // namespace scumble::internal
