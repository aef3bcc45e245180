// Stylised ground shadows: what `catcher` objects catch, laid over the background in the style's darkest paint.
#pragma once

#include <cstdint>
#include <span>

#include "image/guides.h"
#include "image/picture.h"
#include "transfer/parallel.h"
#include "transfer/prepared_exemplar.h"
#include "transfer/region.h"
#include "transfer/seeds.h"

namespace scumble {

// The darkest piece of an exemplar.
struct DarkPlace {
  Source center;
  int exemplar = 0;
  int reach = 0;  // pixels around the centre that count as dark
};

// The square of usable paint, an eighth of the exemplar's shorter side wide, whose mean luminance is lowest, in any
// lighting condition; ties to the first in (exemplar, y, x). A painting too broken up for that gives its darkest pixel.
DarkPlace DarkestPlace(const PreparedExemplar& exemplar);

}  // namespace scumble

namespace scumble::internal {

struct ShadowInput {
  const GuideSet& guides;                // with shadow
  std::span<const std::uint16_t> style;  // StyleMap::kCatch: a pixel that catches shadows
  const PreparedExemplar& exemplar;
  DarkPlace dark;
  SeedRules seeds;
  Region region;
};

// Writes dark paint with alpha = its own × shadow into the catching pixels of the region. The paint is copied in pieces
// around seeds, each from another spot of the dark place. False: asked to stop.
bool PaintShadows(const ShadowInput& input, Picture& out, RowProgress& progress);

}  // namespace scumble::internal
