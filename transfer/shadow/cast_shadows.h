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

// Paints single pixels: the input outlives it. Free to use from any thread.
class ShadowPainter {
 public:
  explicit ShadowPainter(const ShadowInput& input)
      : input_(input), seeds_(input.seeds, input.paint.level(), input.region) {}

  // Writes the shadow paint of a pixel of the region, which itself need not catch shadows. If none of the catching
  // pixels around is in shadow, the texel is left alone.
  void Paint(int x, int y, std::uint16_t* texel) const;

 private:
  const ShadowInput& input_;
  SeedGrid seeds_;
};

// Writes shadow paint into the catching pixels of the region. It is copied in chunks around seeds. Each comes from a
// place whose tone suits the strength, in steps (ShadowPaint::kSteps); every chunk rounds to them by its own hash, so
// that no contour shows.
//
// The layer is sampled once a pixel, so its outlines have steps. The tone is that of the strongest shadow in the 5 × 5
// pixels around, and alpha carries the ratio to their binomial mean. So over some four pixels a hard outline fades
// evenly in one paint, and the mean strength stays. Only pixels that catch count. False: cancelled.
bool PaintShadows(const ShadowInput& input, Picture& out, RowProgress& progress);

}  // namespace scumble::internal
