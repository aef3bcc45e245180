// Assigns one of several styles to each pixel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "core/image/guides.h"

namespace scumble {

// Per pixel the index of its style, rows from the top.
struct StyleMap {
  static constexpr std::uint16_t kPassThrough = 0xffff;  // unchanged: the picture underneath shows, or nothing
  // Not painted, but receives shadows: see transfer.shadow of the first style.
  static constexpr std::uint16_t kShadowCatcher = 0xfffe;
  static constexpr int kMaxStyles = 0xfffe;
  std::vector<std::uint16_t> style;
  // By fragment of the guides, likewise; empty: fragments are of their pixel's style.
  std::vector<std::uint16_t> fragment_style = {};
};

// Styles by the ids of objects and of materials. An object's style takes precedence over its material's, and both over
// the default.
struct StyleAssignment {
  std::map<std::uint32_t, std::uint16_t> of_object;
  std::map<std::uint32_t, std::uint16_t> of_material;
  std::uint16_t otherwise = 0;
};

// O(pixels · log assignments). The guides must hold the object layer if an object is named, and material likewise; a
// value that is no id counts as 0 (IdOf).
StyleMap MapStyles(const GuideSet& guides, const StyleAssignment& assignment);

// A style by the rank-th of several assignments.
struct RankedStyle {
  std::size_t rank = 0;
  std::uint16_t style = 0;
};
struct RankedAssignment {
  std::map<std::uint32_t, RankedStyle> of_object;
  std::map<std::uint32_t, RankedStyle> of_material;
};

// Adds assignments to a map; pixels without one keep their style. Of a pixel's object and its material the one of
// higher rank wins, the object's at equal rank. Adds the number of pixels of each rank to `pixels`, which has a place
// for each. Otherwise as MapStyles.
void AssignStyles(const GuideSet& guides, const RankedAssignment& assignment, StyleMap& map,
                  std::span<std::size_t> pixels);

}  // namespace scumble
