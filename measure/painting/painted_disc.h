// Where the paint of a sphere ends, against the paper or the transparency that it stands on.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image/bare_paper.h"
#include "measure/painting/connected_regions.h"
#include "measure/painting/paint_sheet.h"

namespace scumble {

// What stands on the ground and what is ground, by the corners of the picture (FindBarePaper), which must be bare but
// for a few splashes. Spheres only.
class PaintOnGround {
 public:
  explicit PaintOnGround(const PaintSheet& sheet);

  // Whether there is a ground to be told from the paint: paper of one colour, or transparency.
  bool known() const { return ground_.kind != BarePaper::Kind::kCovered; }
  const BarePaper& ground() const { return ground_; }
  const PaintSheet& sheet() const { return sheet_; }
  // 1: paint. Where the ground is not known, everything is.
  const std::vector<std::uint8_t>& mask() const { return mask_; }
  bool IsPaint(int x, int y) const { return mask_[sheet_.Index(x, y)] != 0; }

 private:
  const PaintSheet& sheet_;
  BarePaper ground_;
  std::vector<std::uint8_t> mask_;
};

// The circle that the paint's outline lies on.
struct PaintedDisc {
  bool found = false;  // false: nothing to go by, or no clean circle; paint that runs over the rim as it likes has none
  double x = 0, y = 0;  // centre, pixels
  double radius = 0;    // pixels
  double outline = 0;  // share of all directions from the picture's middle in which the outline is on the circle, 0 … 1
};

// By random sampling of three outline points at a time (Fischler and Bolles 1981, with fixed chance), then least
// squares over the points within 0.4% of the picture's width. A circle is found where half of all directions agree on
// it. O(pixels).
PaintedDisc FindPaintedDisc(const PaintOnGround& paint);

// Share of the rim, 0 … 1, on which a fringe of ground stands inside the usable disc although the paint beside it is of
// clearly another colour: up to a tenth of the radius wide, 5 degrees or more long. Light paper in the light, wide bare
// places and gaps between strokes are no fringe. 0 where the ground is not known.
double FringeOfRim(const PaintOnGround& paint);

// Patches of bare ground in the shade, 3% of the diameter or more across, in the inner nine tenths of the disc:
// painters leave paper for lights, not for shades. `light` points to the light, unit length. Transparent patches do not
// count. Empty where the ground is not lighter than three quarters of the paint. Pixels are those that are this far
// from paint, so fewer than are bare.
Patches BareShade(const PaintOnGround& paint, const glm::vec3& light);

}  // namespace scumble
