// Texels as Oklab (core/image/oklab.h), a block of a row at a time: for effects that work on lightness, hue and chroma.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace scumble::internal {

inline constexpr std::size_t kOklabBlock = 256;

// Up to kOklabBlock colours.
struct OklabBlock {
  alignas(64) std::array<float, kOklabBlock> lightness, a, b;
};

// Decodes `count` texels, kOklabBlock at most. The same bits on every machine.
void OklabFromTexels(const std::uint16_t* texels, std::size_t count, OklabBlock& block);

// The same of linear Rec.709 in planes; values are clamped to 0 … 1, NaN becomes 0.
void OklabFromPlanes(const std::array<const float*, 3>& planes, std::size_t count, OklabBlock& block);

// The lightness of linear greys, clamped to 0 … 1; NaN becomes 0. `greys` and `lightness` may be one array. kOklabBlock
// at most.
void LightnessFromGreys(const float* greys, std::size_t count, float* lightness);

// Encodes `count` colours. A colour that sRGB does not have loses chroma, at the same hue and lightness, until it has
// it; lightness is clamped to 0 … 1. Alpha stays. Finite numbers only.
void TexelsFromOklab(const OklabBlock& block, std::size_t count, std::uint16_t* texels);

}  // namespace scumble::internal
