// Coverage, paper and the picture underneath.
#pragma once

#include <cstdint>
#include <span>

#include "core/filter/parallel.h"
#include "core/image/style.h"
#include "scumble/picture.h"

namespace scumble::internal {

// The background of the objects.
struct Background {
  const Paper& paper;
  const Picture* over = nullptr;  // instead of the paper; the guides' size
  bool empty() const { return !over && !paper.picture && !paper.color; }
};

// Porter and Duff's "over" with straight alpha, colours blended in linear light: `front` becomes it laid over `back`.
// Where front is opaque, or only one of them is there, colours are unchanged.
void BlendOver(std::uint16_t* front, const std::uint16_t* back);

// Multiplies `coverage`, 0 … 1 by pixel of the picture, or empty for 1, into the alpha of `picture`, then blends it
// over the background in linear light. Where the result is opaque or the background is empty, colours are unchanged.
// False: cancelled.
bool Compose(std::span<const float> coverage, const Background& background, const Region& region, Picture& picture,
             RowProgress& progress);

}  // namespace scumble::internal
