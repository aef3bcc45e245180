// The texture of an exemplar: whether its strokes have a direction, and whether it is a regular pattern.
#pragma once

#include "measure/painting/paint_sheet.h"
#include "measure/painting/regularity.h"

namespace scumble {

struct TextureReport {
  // 0: texture has no direction, 1: all strokes of a window are parallel. The mean over the windows of the structure
  // tensor's coherence, (λ1 - λ2) / (λ1 + λ2) (Bigün and Granlund 1987), each weighted by its gradients' power.
  double anisotropy = 0.0;
  RegularityReport regularity;
};

// In up to 25 windows, evenly distributed over the usable pixels, each wholly inside: squares of 128 pixels, in
// pictures below 512 of a quarter of the shorter side. Not measured if no window of at least 16 pixels fits.
TextureReport MeasureTexture(const PaintSheet& sheet);

}  // namespace scumble
