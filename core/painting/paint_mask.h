// Which pixels of a picture are painted, and where the outline of the paint runs.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "core/painting/bare_paper.h"
#include "scumble/picture.h"

namespace scumble {

// Whether the mean of the 3 × 3 pixels around one is paint, so that a paper's grain is none: more than half opaque
// before transparency, of another colour than the paper.
bool IsPaint(const Picture& picture, const BarePaper& ground, int x, int y);

// Separates paint from ground, by the corners of the picture (FindBarePaper), which must be bare but for a few
// splashes: at most 15% of them are painted.
class PaintMask {
 public:
  explicit PaintMask(const Picture& picture);
  // `ground` is the picture's.
  PaintMask(const Picture& picture, const BarePaper& ground);

  // Whether the ground is distinct from the paint: paper of one colour, or transparency. If not, all pixels are paint.
  bool known() const { return ground_.kind != BarePaper::Kind::kCovered; }
  const BarePaper& ground() const { return ground_; }
  int width() const { return width_; }
  int height() const { return height_; }
  const std::vector<std::uint8_t>& values() const { return values_; }  // 1: paint

 private:
  int width_, height_;
  BarePaper ground_;
  std::vector<std::uint8_t> values_;
};

inline constexpr int kOutlineDirections = 720;

// The unit vector of direction `i`, of kOutlineDirections all around.
glm::dvec2 OutlineDirection(int i);

// The first paint on each ray from the picture's edge towards a point: three pixels of it in a row, behind three of
// ground, so that a speck of grain is none. Rays on which paint reaches the edge have no point. `mask` holds width ×
// height values.
std::vector<glm::dvec2> PaintOutline(const std::vector<std::uint8_t>& mask, int width, int height, glm::dvec2 towards);

}  // namespace scumble
