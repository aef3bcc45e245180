// Where lines may run: the borders between neighbouring pixels, by class.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/filter/edge_test.h"
#include "core/image/finish_pass.h"
#include "core/image/guides.h"
#include "core/image/plane_allocator.h"

namespace scumble::internal {

// What a border is: 0 none, else 1 + LineClass.
struct BorderMap {
  int width = 0, height = 0;
  // By pixel: the border with the pixel to the right, and with the one below. There are none at the picture's edge.
  std::vector<std::uint8_t, PlaneAllocator<std::uint8_t>> right, below;
};

// The pixel that a border between neighbours p and q belongs to, q being to the right of p or below: the nearer one.
class BorderOwner {
 public:
  explicit BorderOwner(const GuideSet& guides);
  // Where two objects meet neither is nearer: there it is the one that faces the viewer more.
  bool IsSecond(std::size_t p, std::size_t q) const;
  std::size_t Of(std::size_t p, std::size_t q) const { return IsSecond(p, q) ? q : p; }
  // Whether two objects meet near the border: somewhere between the middles of p and q their surfaces reach one depth,
  // to a tolerance.
  bool Meet(std::size_t p, std::size_t q) const;

 private:
  // How much the depth of the pixel's surface grows to the next one; `before`: the pixel on its other side.
  float SlopeTowards(std::size_t pixel, std::optional<std::size_t> before) const;

  std::span<const float> coverage_, depth_, object_, facing_;
  std::size_t width_;
  DepthTolerance tolerance_;
};

// A border counts where its class has a width. The guides must hold the pass's layers. `only`: by pixel; borders whose
// owner has 0 do not count, but where it meets an object that has not; empty: all do. `scale`: pixels for one of the
// reference height. `shadow`: by pixel, where that class has a width.
BorderMap FindBorders(const OutlinePass& pass, const GuideSet& guides, double scale, std::span<const std::uint8_t> only,
                      std::span<const float> shadow);

}  // namespace scumble::internal
