// Stylised ground shadows: the shadows on `catcher` objects, laid over the background in the style's own strokes.
#pragma once

#include <cstdint>
#include <span>

#include "core/filter/parallel.h"
#include "core/filter/region.h"
#include "core/image/guides.h"
#include "scumble/picture.h"
#include "transfer/seeds/seeds.h"
#include "transfer/shadow/shadow_paint.h"

namespace scumble::internal {

struct ShadowInput {
  const GuideSet& guides;                // with shadow
  std::span<const std::uint16_t> style;  // StyleMap::kShadowCatcher: a pixel that catches shadows
  const ShadowPaint& paint;
  SeedRules seeds;
  Region region;
};

// Writes shadow paint into the catching pixels of the region. It is copied in chunks around seeds. Each comes from a
// place whose tone suits the strength, in steps (ShadowPaint::kSteps); every chunk rounds to them by its own hash, so
// that no contour shows.
//
// The layer is sampled once a pixel, so its outlines have steps. The tone is that of the strongest shadow in the 5 × 5
// pixels around, and alpha carries the ratio to their binomial mean: over some four pixels a hard outline fades evenly
// in one paint, and the mean strength stays. Only pixels that catch count. False: cancelled.
bool PaintShadows(const ShadowInput& input, Picture& out, RowProgress& progress);

}  // namespace scumble::internal
