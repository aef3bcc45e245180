// The colorized extension: the paint takes on the scene's base colours.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "image/guides.h"
#include "image/picture.h"
#include "image/style.h"
#include "transfer/parallel.h"
#include "transfer/prepared_exemplar.h"

namespace scumble::internal {

// How a style takes on base colours.
struct Tint {
  std::span<const float> mean_lightness;  // Oklab's, of each exemplar; for kOklab only
  float weight = 0.0f;                    // 0 … 1
  ColorizeMode mode = ColorizeMode::kMultiply;

  bool active() const { return weight > 0.0f; }
  // Changes one texel's colour, paint of that exemplar, in linear light; alpha stays. kMultiply: paint × (1 − w +
  // w · albedo). kOklab: from the paint towards the scene's colour, whose lightness is varied by what the paint's differs
  // from its exemplar's mean; chroma follows lightness and is reduced where the colour would leave the gamut.
  void Apply(glm::vec3 albedo, int exemplar, std::uint16_t* texel) const;
};

struct ColorizeInput {
  const GuideSet& guides;                // with albedo
  std::span<const std::uint8_t> active;  // 1: a pixel that this style paints
  int width = 0;                           // of the picture
  std::span<const std::uint8_t> exemplar;  // by pixel: whose tone it has
  Tint tint;
  Region region;
};

// Tints active pixels in place. False: asked to stop.
bool Colorize(const ColorizeInput& input, Picture& picture, RowProgress& progress);

// The mean of Oklab's L over the usable texels of an exemplar's picture, weighted by alpha.
float MeanLightness(const PreparedExemplar& exemplar, int index);

}  // namespace scumble::internal
