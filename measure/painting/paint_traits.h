// Everything that is measured of one painting: what its table row and its check are made of.
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
  double covered_percent = 0.0;  // of what is usable: painted, and not the paper that the corners show
  ToneReport tone;
  PaintedLight light;
  TextureReport texture;
  AlphaReport alpha;
  // Of spheres:
  bool ground_known = false;  // the paper round the paint can be told from it
  PaintedDisc disc;
  double fringe_percent = 0.0;  // of the rim
  Patches bare_shade;
  Patches bare_template;          // pixels that are still the kit's own grey, in patches of 0.05% of the disc or more
  double template_percent = 0.0;  // of the disc
  std::optional<PaintedLight> template_light;  // of the template that it was painted over
};

// `rim` is the style's, in pixels. `bare_template` is the unpainted sphere, the size of the exemplar's picture, or
// null. A pixel is bare where the picture is the template's within 2 of 255 on 90% of the 9×9 pixels round it: paint
// that meets the same grey by chance is not. `printed_template` is the pale sphere of the page, likewise or null; a
// scan of it is bare within 6 of 255 where it is grey, and on white paper alone. The exemplar's picture must not be
// empty. Deterministic; some 0.3 s at 1024².
PaintTraits MeasurePaint(const Exemplar& exemplar, double rim, const Picture* bare_template,
                         const Picture* printed_template = nullptr);

}  // namespace scumble
