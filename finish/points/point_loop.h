// The loop over a picture for steps that treat each pixel by itself.
//
// A pixel may show several surfaces (core/image/fragments.h). It is painted once for each, by the guides of a pixel
// beside it that shows the surface, and the colours are mixed by coverage, in linear light. A pixel beside a hard
// contour of light (core/filter/light_contour.h) sees the light beyond in its share of it. So all borders are smooth.
// The stroke of a painted edge (core/image/fragments.h) is a surface of its pixel, too: it is painted by the guides
// of its owner.
#pragma once

#include <span>

#include "core/filter/parallel.h"
#include "finish/points/point_block.h"

namespace scumble::internal {

// Applies the steps to the picture. False: cancelled.
bool PaintPoints(std::span<const PointStep> steps, const FinishFrame& frame, RowProgress& progress, Picture& picture);

}  // namespace scumble::internal
