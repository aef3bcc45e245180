// The border of a sphere's paint against its paper or transparency.
#pragma once

#include <cstdint>
#include <vector>

#include "core/painting/paint_mask.h"
#include "measure/painting/connected_regions.h"
#include "measure/painting/paint_sheet.h"

namespace scumble {

// A sheet with its PaintMask. Spheres only.
class PaintOnGround {
 public:
  explicit PaintOnGround(const PaintSheet& sheet);

  // Whether the ground is distinct from the paint: paper of one colour, or transparency.
  bool known() const { return mask_.known(); }
  const BarePaper& ground() const { return mask_.ground(); }
  const PaintSheet& sheet() const { return sheet_; }
  // 1: paint. If the ground is unknown, all pixels are paint.
  const std::vector<std::uint8_t>& mask() const { return mask_.values(); }
  bool IsPaint(int x, int y) const { return mask_.values()[sheet_.Index(x, y)] != 0; }

 private:
  const PaintSheet& sheet_;
  PaintMask mask_;
};

// The circle of the paint's outline.
struct PaintedDisc {
  bool found = false;   // false: no evidence, or no clean circle; paint that runs over the rim irregularly has none
  double x = 0, y = 0;  // centre, pixels
  double radius = 0;    // pixels
  double outline = 0;  // share of all directions from the picture's middle in which the outline is on the circle, 0 … 1
};

// The circle on which most of the outline lies (FitCircle), within 0.4% of the picture's width. It counts as found if
// half of all directions agree on it. O(pixels).
PaintedDisc FindPaintedDisc(const PaintOnGround& paint);

// Share of the rim, 0 … 1, with a fringe of ground inside the usable disc although the paint beside it has a clearly
// different colour: up to a tenth of the radius wide, at least 5 degrees long. Light paper in the light, wide bare
// places and gaps between strokes are no fringe. 0 if the ground is unknown.
double FringeOfRim(const PaintOnGround& paint);

// Regions of bare ground in the shade, at least 3% of the diameter across, in the inner nine tenths of the disc:
// painters leave paper for lights, not for shades. `light` points to the light, unit length. Transparent regions do not
// count. Empty if the ground is not lighter than three quarters of the paint. Only pixels this far from paint are
// counted, fewer than are bare.
Patches BareShade(const PaintOnGround& paint, const glm::vec3& light);

}  // namespace scumble
