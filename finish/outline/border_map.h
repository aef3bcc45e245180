// Where lines may run: the borders between neighbouring pixels, by class.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/image/finish_pass.h"
#include "core/image/guides.h"

namespace scumble::internal {

// What a border is: 0 none, else 1 + LineClass.
struct BorderMap {
  int width = 0, height = 0;
  // By pixel: the border with the pixel to the right, and with the one below. There are none at the picture's edge.
  std::vector<std::uint8_t> right, below;
};

// A border counts where its class has a width. The guides must hold the pass's layers. `only`: by pixel; borders whose
// nearer pixel has 0 do not count; empty: all do. `scale`: pixels for one of the reference height.
BorderMap FindBorders(const OutlinePass& pass, const GuideSet& guides, double scale,
                      std::span<const std::uint8_t> only);

}  // namespace scumble::internal
