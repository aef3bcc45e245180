// The paint around an exemplar's rim.
#pragma once

#include <cstdint>

#include "scumble/picture.h"

namespace scumble {

// Paint without its paper, on either side of the sphere's edge. Immutable.
class RimPaint {
 public:
  // `picture` is square and its sphere fills it; resized to `size`. The sphere touches the picture's sides, so at four
  // places of the rim the paint outside it is not in the picture. There the paint 30 degrees farther on is used.
  RimPaint(const Picture& picture, int size);

  // Whether paint ends near the rim, on bare paper or on transparency. A sheet that is painted all over has no edge to
  // continue, nor has one without paint at the rim.
  bool HasEdge() const { return has_edge_; }
  int size() const { return size_; }  // of the sphere, pixels
  float radius() const { return 0.5f * static_cast<float>(size_); }
  // The distance from the rim within which the edge is searched, pixels on either side; at least 1.
  int band() const { return band_; }
  // Sums of colour · opacity, of opacity, and of weights.
  struct Sum {
    std::uint64_t color[3] = {0, 0, 0}, opacity = 0, weight = 0;
  };
  // Adds the paint at a position from the sphere's centre in pixels, y down, interpolated between the four texels
  // around it in steps of 1/256. Transparent farther out than the band, and deeper inside than two bands. Up to 256
  // positions of weight 256 fit.
  void Add(float x, float y, std::uint64_t weight, Sum& sum) const;

 private:
  const std::uint16_t* At(int x, int y) const;  // transparent outside
  int size_ = 0, band_ = 1, margin_ = 2;
  bool has_edge_ = false;
  Picture paint_;  // the resized picture, with a margin on every side
};

}  // namespace scumble
