// Fragments: the surfaces that share a pixel with the one at its centre, for smooth borders between objects.
//
// A surface is here an object with a material. The subsamples of a pixel's coverage may see several surfaces. Then the
// layers of the guides hold the one at the centre, as they do everywhere, and a fragment holds each of the others. So
// whoever does not know fragments loses nothing but smooth borders. Pixels that show one surface have no fragment:
// memory is in proportion to the borders in the picture.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "core/image/status.h"

namespace scumble {

// What to do about fragments that are unusable: the end of messages.
inline constexpr const char* kRemedyForFragments = ": make the guides again with scumble guidegen";

struct Fragments {
  // So a pixel shows four surfaces at most: that of its centre, and the three others with the largest coverage.
  static constexpr int kMostInPixel = 3;

  // By fragment, the index of its pixel (GuideSet::Index), never falling. A pixel's fragments follow each other.
  std::vector<std::uint32_t> pixel;
  // count() × 1 values: the layers of the guides, at the subsample of this surface that is nearest to the mean place of
  // them all. Coverage is the share of the pixel that the surface fills. What is left of the pixel's own coverage
  // belongs to the surface at its centre. Luminance, shadow and light paths are those of the nearest pixel, among the
  // eight around and the fragment's own, whose centre shows the surface. If there is none, they are those of the
  // fragment's own pixel.
  GuideSet values;
  // count() values, or none where it is not known: which of the pixel's 4 × 4 cells the surface shows in, bit
  // 4 · row + column, row 0 at the top. A cell without subsamples has no bit.
  std::vector<std::uint16_t> cells;
  static constexpr std::uint16_t kAllCells = 0xffff;

  std::size_t count() const { return pixel.size(); }
  // The first fragment of this pixel or a later one.
  std::size_t From(std::size_t pixel_index) const;

  // Ok, or what makes the fragments unusable beside these guides. Layers are missing. Pixels are not in the picture or
  // out of order, or one has more than kMostInPixel. A coverage is 0, or more than the pixel's own. An id is not among
  // the guides' names, where there are names. GuideSet::Validate refuses a value. `name` stands for the guides in the
  // message. O(fragments).
  Status Validate(const GuideSet& guides, const std::string& name) const;
};

// The paint of each surface in a picture that mixes them, straight alpha, by fragment.
struct FragmentColors {
  using Texel = std::array<std::uint16_t, 4>;

  std::vector<Texel> own;
  // At the first fragment of each pixel: of the surface at its centre, and what the mixture was.
  std::vector<Texel> centre, mixed;
};

// A stroke of a painted edge on a pixel whose guides are not those of the stroke's surface.
//
// With transfer.edge = "exemplar" a brush goes past the silhouette. There the guides describe the background, or the
// object behind; at the silhouette they cover a part of the pixel. A stroke names a pixel of its own surface, so that
// finishing effects change its paint as they change the paint beside it.
struct EdgeStroke {
  using Texel = std::array<std::uint16_t, 4>;

  std::uint32_t pixel = 0;                   // GuideSet::Index
  std::uint32_t owner = 0;                   // a pixel whose guides are those of the stroke's surface
  Texel own = {}, beneath = {}, mixed = {};  // straight alpha: the stroke, what it lies on, the one over the other
};

// At most one by pixel, pixels rising. Memory is in proportion to the outlines in the picture.
using EdgeStrokes = std::vector<EdgeStroke>;

}  // namespace scumble
