// A picture's pixels in blocks, as core/filter/oklab_rows.h takes them.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/filter/oklab_rows.h"

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

}  // namespace scumble::internal
