// Continues the exemplar's own silhouette in the picture: where the brush ends raggedly around the sphere, it does so
// around objects.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/filter/parallel.h"
#include "core/filter/region.h"
#include "core/image/fragments.h"
#include "core/image/guides.h"
#include "scumble/picture.h"
#include "transfer/rim/rim_paint.h"
#include "transfer/seeds/seeds.h"
#include "transfer/source_field.h"
#include "transfer/tint/colorize.h"

namespace scumble::internal {

// A style's data for the painted edge.
struct EdgePaint {
  std::span<const RimPaint> rims;  // by exemplar, all of one size; empty: this style's silhouettes stay exact
  SeedRules seeds;
  Tint tint;  // an edge takes its object's colour, like the paint inside it
};

struct PaintedEdgeInput {
  const GuideSet& guides;                // with object and depth; albedo where a style tints
  std::span<const std::uint16_t> style;  // per pixel; empty: style 0 everywhere
  std::span<const EdgePaint> paints;     // by style
  const SourceField& field;              // of the region and EdgeReach around it
  Region region;
};

// The largest distance of a pixel from the object whose edge it shows, for a rim with that band.
constexpr int EdgeReach(int band) { return band + 2; }

// Lays rim paint over both sides of silhouettes and borders with objects farther away, and reduces `coverage` where the
// exemplar's paint thins out before an empty background. Rim paint at a distance from the sphere's edge goes to an
// equal distance from the silhouette, in the direction that rim_segments.h chooses. On thin objects (silhouettes.h) all
// distances shrink, and the line with them. Reads coverage from the guides, changes `coverage` and `picture` inside the
// region. Colours are blended in linear light. `kept`, if not null, gets the region's strokes. O(pixels of the region +
// outline pixels · band²). False: cancelled.
bool PaintEdges(const PaintedEdgeInput& input, std::vector<float>& coverage, Picture& picture, RowProgress& progress,
                EdgeStrokes* kept = nullptr);

}  // namespace scumble::internal
