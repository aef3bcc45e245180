// The colorized extension: the paint takes on the scene's base colours.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "core/image/guides.h"
#include "core/image/style.h"
#include "scumble/picture.h"
#include "transfer/prepared_exemplar.h"

namespace scumble::internal {

// A style's use of base colours.
struct Tint {
  float reference_lightness = 0.0f;  // Oklab's L of the paint that becomes exactly the base colour; for kOklab only
  float weight = 0.0f;               // 0 … 1
  ColorizeMode mode = ColorizeMode::kMultiply;

  bool active() const { return weight > 0.0f; }
  // Changes one texel's colour in linear light; alpha stays.
  //
  // kMultiply: paint × (1 − w + w · albedo).
  //
  // kOklab: w of the way, in Oklab, from the paint to its target. With P the paint's lightness, R the reference, and
  // (L, a, b) the albedo, clamped to 0 … 1:
  //   P ≤ R   P / R · (L, a, b): darker as in weaker light, so the ratio of two paints' luminances stays;
  //   P > R   t = (P − R) / (1 − min(R, L)), lightness L + t · (1 − L), chroma × (1 − t²), or less where a channel
  //           would be above 0.98 and above the albedo's: towards white as far as the paint and the gamut allow.
  // So black stays black, no paint short of white becomes white, and lightness is monotone and continuous in P. Where
  // the way from the paint to the target is outside the gamut, lightness and hue stay and chroma is reduced.
  void Apply(glm::vec3 albedo, std::uint16_t* texel) const;
};

struct ColorizeInput {
  const GuideSet& guides;                // with albedo
  std::span<const std::uint8_t> active;  // 1: a pixel that this style paints
  Tint tint;
  int first_row = 0;  // the row that `active` begins with
};

// Tints the active ones of the pixels x0 … x1 - 1 of a row in place. Rows and parts of rows are independent.
void ColorizeRow(const ColorizeInput& input, int y, int x0, int x1, Picture& picture);

// The mean of Oklab's L over the usable texels of an exemplar's picture, weighted by alpha.
float MeanLightness(const PreparedExemplar& exemplar, int index);

// The lightness that stands for full light: that of the style's lightest exemplar on average. One for all of its
// exemplars, so that those for weaker light stay darker and a blend of two lies between them.
float ReferenceLightness(const PreparedExemplar& exemplar);

}  // namespace scumble::internal
