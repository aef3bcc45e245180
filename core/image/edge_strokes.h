// Strokes of a painted edge that lie on pixels whose guides are not those of the stroke's surface.
//
// With transfer.edge = "exemplar" a brush goes past the silhouette. There the guides describe the background, or the
// object behind; at the silhouette they cover a part of the pixel. A stroke names a pixel of its own surface, so that
// finishing effects change its paint as they change the paint beside it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace scumble {

struct EdgeStroke {
  using Texel = std::array<std::uint16_t, 4>;

  std::uint32_t pixel = 0;                   // GuideSet::Index
  std::uint32_t owner = 0;                   // a pixel whose guides are those of the stroke's surface
  Texel own = {}, beneath = {}, mixed = {};  // straight alpha: the stroke, what it lies on, the one over the other
};

// At most one by pixel, pixels rising. Memory is in proportion to the outlines in the picture.
using EdgeStrokes = std::vector<EdgeStroke>;

}  // namespace scumble
