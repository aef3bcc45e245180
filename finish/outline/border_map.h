// Where lines may run: the borders between neighbouring pixels, by class.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

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

// The pixel that a border between p and q belongs to: the nearer one.
class BorderOwner {
 public:
  explicit BorderOwner(const GuideSet& guides)
      : coverage_(guides.Plane(Layer::kCoverage)), depth_(guides.Plane(Layer::kDepth)) {}
  bool IsSecond(std::size_t p, std::size_t q) const {
    return coverage_[q] > 0.0f && (!(coverage_[p] > 0.0f) || depth_[q] < depth_[p]);
  }
  std::size_t Of(std::size_t p, std::size_t q) const { return IsSecond(p, q) ? q : p; }

 private:
  std::span<const float> coverage_, depth_;
};

// A border counts where its class has a width. The guides must hold the pass's layers. `only`: by pixel; borders whose
// nearer pixel has 0 do not count; empty: all do. `scale`: pixels for one of the reference height. `shadow`: by pixel,
// where that class has a width.
BorderMap FindBorders(const OutlinePass& pass, const GuideSet& guides, double scale, std::span<const std::uint8_t> only,
                      std::span<const float> shadow);

}  // namespace scumble::internal
