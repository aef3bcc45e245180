// The painting's own silhouette as the picture's: where the brush ends raggedly round the sphere, it does so round
// objects.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/filter/parallel.h"
#include "core/filter/region.h"
#include "core/image/guides.h"
#include "scumble/picture.h"
#include "transfer/field/source_field.h"
#include "transfer/outline/rim_paint.h"
#include "transfer/seeds/seeds.h"
#include "transfer/tint/colorize.h"

namespace scumble::internal {

// A style as the painted edge sees it.
struct EdgePaint {
  std::span<const RimPaint> rims;  // by exemplar, all of one size; empty: this style's silhouettes stay exact
  SeedRules seeds;
  Tint tint;  // an edge has its object's colour as the paint inside it has
};

struct PaintedEdgeInput {
  const GuideSet& guides;                // with object and depth; albedo where a style tints
  std::span<const std::uint16_t> style;  // per pixel; empty: style 0 everywhere
  std::span<const EdgePaint> paints;     // by style
  const SourceField& field;              // of the region and EdgeReach around it
  Region region;
};

// How far from a pixel the object may be that its edge belongs to, for a rim with that band.
constexpr int EdgeReach(int band) { return band + 2; }

// Lays rim paint over both sides of silhouettes and borders with things further away, and thins `coverage` where the
// painting thins out before nothing. What the rim shows at a distance from the sphere's edge goes to the same distance
// from the silhouette, in the direction that rim_pieces.h chooses; on thin things (silhouettes.h) all distances shrink,
// and the line with them. Reads coverage from the guides, changes `coverage` and `picture` inside the region. Colours
// meet in linear light. O(pixels of the region + outline pixels · band²). False: asked to stop.
bool PaintEdges(const PaintedEdgeInput& input, std::vector<float>& coverage, Picture& picture, RowProgress& progress);

}  // namespace scumble::internal
