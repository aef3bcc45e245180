// All measures of one exemplar: for its table row and its check.
#pragma once

#include <optional>

#include "measure/painting/paint_alpha.h"
#include "measure/painting/paint_texture.h"
#include "measure/painting/paint_tone.h"
#include "measure/painting/painted_disc.h"

namespace scumble {

struct PaintTraits {
  int width = 0, height = 0;  // of the picture without its template's margin, pixels
  bool is_sphere = true;
  double covered_percent = 0.0;  // of the usable pixels: painted, and not the paper in the corners
  ToneReport tone;
  PaintedLight light;
  TextureReport texture;
  AlphaReport alpha;
  // Of spheres:
  bool ground_known = false;  // the paper around the paint is distinct from the paint
  PaintedDisc disc;
  double fringe_percent = 0.0;  // of the rim
  Patches bare_shade;
  Patches bare_template;          // pixels that still have the kit's own grey, in regions of 0.05% of the disc or more
  double template_percent = 0.0;  // of the disc
  std::optional<PaintedLight> template_light;  // of the template that it was painted over
};

// `rim` is the style's, in pixels. `bare_template` is the unpainted sphere, the size of the exemplar's picture, or
// null. A pixel is bare if the picture equals the template within 2 of 255 on 90% of the 9×9 pixels around it: paint
// with an equal grey by chance does not count. `printed_template` is the pale sphere of the page, likewise or null; a
// scan of it is bare within 6 of 255 where it is grey, and on white paper alone. The exemplar's picture must not be
// empty. Deterministic; some 0.3 s at 1024².
PaintTraits MeasurePaint(const Exemplar& exemplar, double rim, const Picture* bare_template,
                         const Picture* printed_template = nullptr);

}  // namespace scumble
