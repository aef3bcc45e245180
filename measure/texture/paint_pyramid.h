// Local features of paint: its tone, and its strokes in four octaves of size.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "measure/texture/normal_tone.h"
#include "scumble/picture.h"

namespace scumble::internal {

inline constexpr int kOctaves = 4;
inline constexpr std::uint8_t kNoExemplar = 0xff;

// Features of one octave. Its picture is the whole one, each side divided by 2 once an octave.
struct FeatureGroup {
  static constexpr std::size_t kDirections = 4;  // of bars

  int width = 0;                             // of a row
  bool strokes = false;                      // bars of the colours, or else the colours themselves
  std::array<std::vector<float>, 3> colors;  // L, a and b
  std::vector<std::uint8_t> exemplar;        // the pixel's own, or kNoExemplar where the features see two surfaces
  std::array<std::vector<float>, 2> normal;  // x and y

  std::size_t count() const { return strokes ? colors.size() * kDirections : colors.size(); }
  // Feature f at a pixel that has an exemplar. Bars are second differences: the mean of the values on either side less
  // the one in the middle.
  float At(std::size_t f, std::size_t pixel) const {
    if (!strokes) return colors[f][pixel];
    const std::size_t row = std::size_t(width), steps[kDirections] = {1, row, row + 1, row - 1};
    const float* const here = colors[f / kDirections].data() + pixel;
    const std::size_t step = steps[f % kDirections];
    return 0.5f * (*(here - step) + *(here + step)) - *here;
  }
};

// The first group is tone: Oklab's L, a and b of each pixel. The others are strokes: what the picture has beside the
// exemplar's tone under its normal, so that bends of the surface do not count. Octave o is the mean of blocks of 2^o ×
// 2^o pixels, under a Gaussian of one pixel of its own. Its features are second differences of L, a and b in four
// directions each, the answers of a bank of bars (after the steerable pyramids of Heeger, Bergen 1995, and Portilla,
// Simoncelli 2000). Colours are as sharp as lightness: where dabs of one lightness lie side by side, they alone show
// that the paint is blurred.
using PaintFeatures = std::array<FeatureGroup, 1 + kOctaves>;

// A pixel's surface: its object's id and, in the upper byte, the exemplar that it is compared with.
using Surface = std::uint32_t;
inline constexpr Surface kNoSurface = 0xffffffff;  // nothing is measured
inline Surface SurfaceOf(std::uint32_t id, std::uint8_t exemplar) { return std::uint32_t(exemplar) << 24 | id; }
inline std::uint8_t ExemplarOf(Surface surface) { return std::uint8_t(surface >> 24); }  // or kNoExemplar

// `surface` by pixel; features are valid where all pixels in reach have one. `tones` by exemplar. Colours are straight;
// alpha does not matter. O(pixels). Runs in the caller's arena; the bytes do not depend on its threads.
PaintFeatures FeaturesOf(const Picture& picture, const NormalPlanes& normal, std::vector<Surface> surface,
                         std::span<const NormalTone* const> tones);

}  // namespace scumble::internal
