// Light of a Cycles render as guides: the layers luminance and shadow, from the passes that a view layer can have.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/image/guides.h"

namespace scumble {

enum class LightPass { kDiffuseDirect, kShadow, kShadowCatcher };

// The meaning of a channel like "ViewLayer.DiffDir.R"; nothing for any other name.
struct LightChannel {
  std::string prefix;  // "ViewLayer", or empty
  LightPass pass;
  int component;  // 0 … 2
};
std::optional<LightChannel> ParseLightChannel(std::string_view name);

// Planes of the picture's size, by pass.
using BlenderLight = std::map<LightPass, std::array<std::vector<float>, 3>>;

// The passes that make a layer, any of them; empty for all layers but luminance and shadow.
std::vector<LightPass> LightPassesFor(Layer layer);

// Fills those of the layers luminance and shadow that `guides` have and a pass in `light` makes. The guides' coverage
// is known. `catchers`: the share of each pixel that shadow catchers cover; empty: there are none.
//   luminance: Cycles' Diffuse Direct is the direct light that a diffuse surface sends out, divided by its colour: on
//     every Lambert surface that of a white one, shadows included. Its luminance (Rec. 709) is ours. A surface without
//     a diffuse part, as metal, has none, nor has a shadow catcher: 0.
//   shadow: on shadow catchers 1 less the luminance of Shadow Catcher, which is the light that is left. Elsewhere,
//     where there is a pass Shadow, 1 less its luminance, which is the share of a pixel's light samples that reached a
//     lamp: each lamp counts alike, and a surface that no lamp faces counts as shadowed. Samples beside the surface
//     reached none, so it is divided by the coverage.
void ConvertBlenderLight(const BlenderLight& light, std::span<const float> catchers, GuideSet& guides);

}  // namespace scumble
