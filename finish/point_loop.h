// The loop over a picture for steps that treat each pixel by itself.
//
// A pixel may show several surfaces (core/image/fragments.h). It is painted once for each, by the guides of a pixel
// beside it that shows the surface, and the colours are mixed by coverage, in linear light. A pixel beside a hard
// contour of light (core/filter/light_contour.h) sees the light beyond in its share of it. So all borders are smooth.
// The stroke of a painted edge (core/image/edge_strokes.h) is a surface of its pixel, too: it is painted by the guides
// of its owner.
#pragma once

#include <span>
#include <vector>

#include "core/filter/light_contour.h"
#include "core/filter/parallel.h"
#include "finish/finish.h"
#include "finish/tone/point_effect.h"

namespace scumble::internal {

struct PointStep {
  PointEffect apply;
  const FinishStep* step = nullptr;
  std::span<const float> coverage;  // the step changes only surfaces, as far as they cover; empty: it changes all
  PointEffect behind = {};          // what it does to background, where that is another thing; `coverage` parts the two
  std::vector<HardLight> lights = {};  // that the step looks at
};

// Whether the step changes the guides.
bool IsOfGuides(const FinishStep& step);

// Whether nothing of the paint is left to be seen, strokes of painted edges included.
bool HidesPaint(const FinishStep& step);

// Applies the steps to the picture. False: cancelled.
bool PaintPoints(std::span<const PointStep> steps, const FinishFrame& frame, RowProgress& progress, Picture& picture);

}  // namespace scumble::internal
