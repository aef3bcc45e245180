// The painting's own silhouette as the picture's: where the brush ends raggedly round the sphere, it does so round objects.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "image/guides.h"
#include "image/picture.h"
#include "image/style.h"
#include "transfer/colorize.h"
#include "transfer/parallel.h"
#include "transfer/region.h"
#include "transfer/seeds.h"
#include "transfer/source_field.h"

namespace scumble {

// What an exemplar shows around its rim: paint with the opacity that it has there. Immutable.
class RimPaint {
 public:
  // `picture` is square, its sphere fills it; resized to `size`. Opacity is alpha times the distance from the paper's
  // colour: that of `paper`, or without one the median of the picture's corners.
  RimPaint(const Picture& picture, const Paper& paper, int size);

  // Whether the paint ends near the rim. A sheet that is painted all over has no edge that could continue.
  bool HasEdge() const { return has_edge_; }
  int size() const { return size_; }
  // How far from the rim the edge is looked for, pixels on either side; at least 1.
  int band() const { return band_; }
  // Colour and, as alpha, opacity; transparent outside the picture.
  const std::uint16_t* At(int x, int y) const;

 private:
  int size_ = 0, band_ = 1;
  bool has_edge_ = false;
  Picture picture_;
};

}  // namespace scumble

namespace scumble::internal {

// A style as the painted edge sees it.
struct EdgePaint {
  std::span<const RimPaint> rims;  // by exemplar; empty: this style's silhouettes stay exact
  SeedRules seeds;
  Tint tint;  // an edge has its object's colour as the paint inside it has
};

struct PaintedEdgeInput {
  const GuideSet& guides;                // with object and depth; albedo where a style tints
  std::span<const std::uint16_t> style;  // per pixel; empty: style 0 everywhere
  std::span<const EdgePaint> paints;     // by style
  const SourceField& field;
  Region region;
};

// Lays rim paint over both sides of silhouettes and borders with things further away, and thins `coverage` where the
// painting thins out before nothing. What the rim shows at a distance from the sphere's edge goes to the same distance from
// the silhouette, on the side that faces the same way; along the silhouette it is copied in pieces around seeds. Reads coverage from the guides, changes `coverage` and `picture` inside the
// region. False: asked to stop.
bool PaintEdges(const PaintedEdgeInput& input, std::vector<float>& coverage, Picture& picture, RowProgress& progress);

}  // namespace scumble::internal
