// A picture's pixels in blocks, as core/filter/oklab_rows.h takes them, and their tone.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/filter/oklab_rows.h"
#include "finish/area/float_plane.h"
#include "finish/finish.h"

namespace scumble::internal {

// Calls visit(first, count) for blocks of up to kOklabBlock pixels, from several threads.
template <class Visit>
void ForEachOklabBlock(std::size_t pixels, const Visit& visit) {
  const std::size_t blocks = (pixels + kOklabBlock - 1) / kOklabBlock;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, 16), [&](const auto& part) {
    for (std::size_t i = part.begin(); i != part.end(); ++i)
      visit(i * kOklabBlock, std::min(kOklabBlock, pixels - i * kOklabBlock));
  });
}

// Puts colours into `count` texels, as far as `share`, 0 … 1, says. Texels of alpha 0, those for which `only` is 0
// (null: none), and those whose colour stays keep their bits. `after` is changed.
void PutBlock(const OklabBlock& before, float share, const std::uint8_t* only, std::size_t count, OklabBlock& after,
              std::uint16_t* texels);

// By pixel, the lightness 0 … 1 of the paint, of the light without its noise, or of base colours; of the latter two
// background has that of bare paper, 1. The guides hold coverage and the layer.
FloatPlane ToneOf(EdgesPass::Tone of, const FinishFrame& frame, const Picture& picture);

}  // namespace scumble::internal
