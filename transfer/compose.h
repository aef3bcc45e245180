// Coverage, paper and the picture underneath.
#pragma once

#include "image/guides.h"
#include "image/picture.h"
#include "image/style.h"
#include "transfer/parallel.h"

namespace scumble::internal {

// Multiplies the coverage into the alpha of `picture`, then blends it over `over` (the same size) or else over the
// paper, in linear light. Where the result is opaque or nothing is behind, colours pass through untouched.
bool Compose(const GuideSet& guides, const Paper& paper, const Picture* over, const Region& region, Picture& picture,
             RowProgress& progress);

}  // namespace scumble::internal
