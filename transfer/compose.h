// Coverage, paper and the picture underneath.
#pragma once

#include <span>

#include "image/picture.h"
#include "image/style.h"
#include "transfer/parallel.h"

namespace scumble::internal {

// What stands behind the objects.
struct Background {
  const Paper& paper;
  const Picture* over = nullptr;  // instead of the paper; the guides' size
};

// Multiplies `coverage`, 0 … 1 by pixel of the picture, into the alpha of `picture`, then blends it over the background in linear light. Where the
// result is opaque or nothing is behind, colours pass through untouched. False: asked to stop.
bool Compose(std::span<const float> coverage, const Background& background, const Region& region, Picture& picture,
             RowProgress& progress);

}  // namespace scumble::internal
