// A row of a picture as the weighted sum of others: the inner loop of Resample.
#pragma once

#include <cstdint>
#include <span>

namespace scumble::internal {

// Weights are integers of so many bits: they sum to 2^kWeightBits, their magnitudes to less than twice that.
inline constexpr int kWeightBits = 14;

// `out` is the sum of as many rows of `width` pixels as there are weights; 16 bits a channel, straight alpha. Colours
// weigh by their alpha, so that transparent pixels add none. Integers, so every machine gives the same bytes.
void SumRows(std::span<const std::int32_t> weights, std::span<const std::uint16_t* const> rows, int width,
             std::uint16_t* out);

}  // namespace scumble::internal
