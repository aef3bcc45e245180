// A Gaussian blur of the masked part of a picture.
#pragma once

#include <cstdint>
#include <span>

#include "scumble/picture.h"

namespace scumble::internal {

// A texel's channels times its alpha, so that transparent texels add no colour to a mean.
inline std::uint16_t Premultiplied(const std::uint16_t* texel, int channel) {
  if (channel == 3) return texel[3];
  return static_cast<std::uint16_t>((std::uint32_t(texel[channel]) * texel[3] + 32767u) / 65535u);
}

// The picture with premultiplied colours, blurred by a Gaussian of `sigma` pixels, above 0, over the pixels of the mask
// alone: (G ∗ mask·v) / (G ∗ mask) on them, so that the mean stays a mean at the mask's edge, and 0 elsewhere. From the
// picture's longer side on, infinity included, it is one mean over the whole mask.
//
// G is four extended box filters one after the other, with exactly that variance: Gwosdek, Grewenig, Bruhn, Weickert,
// "Theoretical Foundations of Gaussian Convolution by Extended Box Filtering", SSVM 2011. O(pixels), whatever sigma is.
// Plain doubles in a fixed order: the same bytes everywhere. Rows run in parallel, in the caller's arena.
Picture MaskedBlur(const Picture& picture, std::span<const std::uint8_t> mask, double sigma);

}  // namespace scumble::internal
