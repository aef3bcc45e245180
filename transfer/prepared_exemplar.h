// An exemplar made ready: resized, its paint extended past the rim, with the guides of the sphere that fills it.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "image/picture.h"

namespace scumble {

// A pixel of the exemplar.
struct Source {
  int x = 0;
  int y = 0;
  bool operator==(const Source&) const = default;
};

// The sphere fills the N × N picture: centre N/2, radius N/2. Positions inside radius 1 - rim are usable; all others
// are never shown. Immutable once made; concurrent reads are safe.
class PreparedExemplar {
 public:
  // One picture or several, the same sphere under different light; all are resized to N = `size`, 1 … 32767. `rim` is in
  // pixels of each picture; all must be square. Paint is extended outward from the rim before resizing, so nothing from
  // outside the painted disc reaches a usable texel.
  PreparedExemplar(std::span<const Picture* const> pictures, double rim, int size);
  PreparedExemplar(const Picture& picture, double rim, int size)
      : PreparedExemplar(std::vector<const Picture*>{&picture}, rim, size) {}

  int size() const { return size_; }
  int count() const { return static_cast<int>(pictures_.size()); }
  const Picture& picture(int index = 0) const { return pictures_[std::size_t(index)]; }

  bool Usable(int x, int y) const {
    if (static_cast<unsigned>(x) >= static_cast<unsigned>(size_)) return false;
    if (static_cast<unsigned>(y) >= static_cast<unsigned>(size_)) return false;
    const std::int64_t dx = 2 * x + 1 - size_, dy = 2 * y + 1 - size_;
    return dx * dx + dy * dy <= limit_;
  }

  // The sphere's view-space normal at the centre of a usable pixel.
  glm::vec3 Normal(int x, int y) const {
    const float nx = coordinate_[x], ny = -coordinate_[y];
    return {nx, ny, std::sqrt(std::fmax(0.0f, 1.0f - nx * nx - ny * ny))};
  }

  // The analytic nearest neighbour u* = argmin ‖normal - Normal(u)‖ over usable pixels, within one pixel of the exact
  // one; ties to the lowest (y, x). A normal beyond the rim, or with z < 0, takes the usable pixel nearest to the point
  // of the rim along its (x, y), and (0, 0, -1) that at +Y. (The exact argmin would jump along the rim's staircase of
  // pixels there, by many at once, for no gain that anyone can see.) Any finite or NaN input gives a usable pixel.
  Source NearestNeighbour(glm::vec3 normal) const;

 private:
  // The usable pixel nearest to (nx, ny) of the unit disc, near pixel (x, y).
  Source NearestUsable(float nx, float ny, int x, int y) const;

  int size_;
  std::int64_t limit_;              // squared usable radius in half pixels
  float usable_radius_;             // the same as a fraction of the sphere's
  std::vector<float> coordinate_;   // pixel index → [-1, 1]
  std::vector<Picture> pictures_;
};

// N for a picture of `size` pixels at `scale`, for an output of `output_height` pixels; `reference_height` 0 means that
// the height does not matter. At least 1.
int ScaledSize(int size, double scale, int reference_height, int output_height);

}  // namespace scumble
