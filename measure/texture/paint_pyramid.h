// Local features of paint: its tone, and its strokes in four octaves of size.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "measure/texture/normal_tone.h"
#include "scumble/picture.h"

namespace scumble::internal {

inline constexpr int kOctaves = 4;

// Values of one octave. Its picture is the whole one, each side divided by 2 once an octave.
struct FeatureGroup {
  std::vector<std::vector<float>> planes;    // by feature
  std::vector<std::uint8_t> valid;           // not 0: the features see one surface alone
  std::array<std::vector<float>, 2> normal;  // x and y
};

// The first group is tone: Oklab's L, a and b of each pixel. The others are strokes: what the picture has beside the
// exemplar's tone under its normal, so that bends of the surface do not count. Octave o is the mean of blocks of 2^o ×
// 2^o pixels, under a Gaussian of one pixel of its own. Its features are second differences of L, a and b in four
// directions each, the answers of a bank of bars (after the steerable pyramids of Heeger, Bergen 1995, and Portilla,
// Simoncelli 2000). Colours are as sharp as lightness: where dabs of one lightness lie side by side, they alone show
// that the paint is blurred.
using PaintFeatures = std::array<FeatureGroup, 1 + kOctaves>;

// `surface`: by pixel the number of its surface, below 0 where nothing is measured; features are valid where all pixels
// in reach have one number. Colours are straight; alpha does not matter. O(pixels). Runs in the caller's arena; the
// bytes do not depend on its threads.
PaintFeatures FeaturesOf(const Picture& picture, const NormalPlanes& normal, std::vector<float> surface,
                         const NormalTone& tone);

}  // namespace scumble::internal
