// Which of several styles paints which pixel.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "image/guides.h"

namespace scumble {

// Per pixel the index of its style, rows from the top.
struct StyleMap {
  static constexpr std::uint16_t kLeave = 0xffff;  // left as it is: the picture underneath shows, or nothing
  // Not painted either, but catches shadows: see transfer.shadow of the first style.
  static constexpr std::uint16_t kCatch = 0xfffe;
  static constexpr int kMaxStyles = 0xfffe;
  std::vector<std::uint16_t> style;
};

// Styles by the ids of objects and of materials; an object's own goes before its material's, and both before the default.
struct StyleAssignment {
  std::map<std::uint32_t, std::uint16_t> of_object;
  std::map<std::uint32_t, std::uint16_t> of_material;
  std::uint16_t otherwise = 0;
};

// O(pixels · log assignments). The guides must hold the object layer if an object is named, and material likewise.
StyleMap MapStyles(const GuideSet& guides, const StyleAssignment& assignment);

// Likewise on top of a map, where what is not named keeps its style; `otherwise` is not looked at.
void AssignStyles(const GuideSet& guides, const StyleAssignment& assignment, StyleMap& map);

}  // namespace scumble
