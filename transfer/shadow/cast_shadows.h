// Stylised ground shadows: what `catcher` objects catch, laid over the background in the style's own strokes.
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

// Writes shadow paint into the catching pixels of the region. It is copied in pieces around seeds, each of a place
// whose tone suits the strength, in steps (ShadowPaint::kSteps) to which every piece rounds in its own way, so that no
// contour shows.
//
// The layer is sampled once a pixel, so its outlines have steps. The tone is that of the strongest shadow in the 5 × 5
// pixels around, and alpha carries what their binomial mean is less: over some four pixels a hard outline fades evenly
// in the same paint, and the mean strength stays. Only pixels that catch count. False: asked to stop.
bool PaintShadows(const ShadowInput& input, Picture& out, RowProgress& progress);

}  // namespace scumble::internal
