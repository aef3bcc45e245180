// Votes on a colour, counted one by one.
#pragma once

#include <cstdint>

namespace scumble::internal {

// Sums are integers, so their order does not matter. 16-bit texels of straight alpha; at least one vote, at most 2^20.
struct VoteSum {
  std::uint64_t color[3] = {0, 0, 0};
  std::uint64_t alpha = 0;
  std::uint32_t votes = 0;

  // One vote, or several of the same.
  void Add(const std::uint16_t* texel, std::uint32_t count = 1) {
    const std::uint64_t weight = std::uint64_t{count} * texel[3];
    for (int c = 0; c < 3; ++c) color[c] += weight * texel[c];
    alpha += weight;
    votes += count;
  }
  // The mean, colours weighted by alpha; halves are rounded up. Transparent results have colour 0.
  void Count(std::uint16_t* out) const {
    for (int c = 0; c < 3; ++c) out[c] = alpha ? static_cast<std::uint16_t>((color[c] + alpha / 2) / alpha) : 0;
    out[3] = static_cast<std::uint16_t>((alpha + votes / 2) / votes);
  }
};

}  // namespace scumble::internal
