// Edge-aware voting: cross-based support regions select the pixels of a window that may vote.
//
// A step between two pixels side by side, or one above the other, is open if both are active and EdgeTest finds one
// surface; otherwise it is a crack. Two pixels of a row or a column, at most `radius` apart, are on one arm if
//   - all steps between them are open, and
//   - no two normals from the one to the other are `crease` degrees or more apart (the turn limit).
// A pixel's vertical arm holds all pixels of its column that are on one arm with it, its horizontal arm those of its
// row. Its support region is the union of the horizontal arms of all pixels of its vertical arm.
//
// An arm is an interval, and along a row or a column the ends of arms never move backwards (docs/numerics.md,
// "Derivations").
//
// Zhang, Lu, Lafruit, "Cross-Based Local Stereo Matching Using Orthogonal Integral Images", IEEE Transactions on
// Circuits and Systems for Video Technology 19(7), 2009. Their arms compare colours; these compare guides.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/filter/edge_test.h"
#include "core/filter/region.h"

namespace scumble::internal {

// The definition in plain form. The fast forms (wide_arms.h, small_vote.h) are tested against it.
class SupportRegions {
 public:
  // For windows of `radius` around the active pixels of `region`. `active` has a value for every pixel of the guides;
  // an active pixel is covered. O(pixels of the region grown by the radius · radius) time, O(those pixels) memory.
  SupportRegions(const EdgeRules& rules, std::span<const std::uint8_t> active, int radius, const Region& region);

  // Calls visit(q, dx, dy) for every pixel of the support region of the active pixel (x, y), itself included, in row
  // order. q is the pixel's index in the guides, dx and dy its offset from (x, y).
  template <class Visit>
  void ForEach(int x, int y, const Visit& visit) const {
    const Arms& vertical = arms_[Index(x, y)];
    for (int dy = -vertical.up; dy <= vertical.down; ++dy) {
      const Arms& horizontal = arms_[Index(x, y + dy)];
      const std::size_t q = static_cast<std::size_t>(y + dy) * static_cast<std::size_t>(width_) + x;
      for (int dx = -horizontal.left; dx <= horizontal.right; ++dx) visit(q + std::ptrdiff_t(dx), dx, dy);
    }
  }

 private:
  struct Arms {
    std::uint16_t left = 0, right = 0, up = 0, down = 0;  // pixels beside this one
  };
  std::size_t Index(int x, int y) const {
    return static_cast<std::size_t>(y - grown_.y0) * (grown_.x1 - grown_.x0) + (x - grown_.x0);
  }

  int width_;
  Region grown_;
  std::vector<Arms> arms_;
};

}  // namespace scumble::internal
