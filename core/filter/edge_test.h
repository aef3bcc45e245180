// Where votes must not cross: object borders, depth steps, creases.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "core/image/guides.h"
#include "core/filter/region.h"

namespace scumble::internal {

// The surface's slope in depth per pixel. A step shows on one side of a pixel only, or turns back on the other, and is no
// slope. Made once for all styles of a picture; the guides must hold depth. O(pixels).
struct DepthSlopes {
  explicit DepthSlopes(const GuideSet& guides);
  std::vector<float> x, y;
};

// The same, made when first asked for, by whichever thread is first. Keeps a reference to the guides.
class LateSlopes {
 public:
  explicit LateSlopes(const GuideSet& guides) : guides_(guides) {}
  const DepthSlopes& Get() {
    std::call_once(made_, [this] { slopes_.emplace(guides_); });
    return *slopes_;
  }

 private:
  const GuideSet& guides_;
  std::once_flag made_;
  std::optional<DepthSlopes> slopes_;
};

// How far depth may leave the slope of a surface between two pixels: a share of the nearer one's depth. In orthographic
// views depth depends on where the camera happens to stand, so it is a share of the height that is seen; of the depth only
// what float's rounding in casting comes to, 2^-20.
struct DepthGive {
  DepthGive(const GuideSet& guides, double depth_tolerance);
  float At(float depth) const { return fixed + share * depth; }

  float share = 0.0f;
  float fixed = 0.0f;  // metres
};

// What one style takes for an edge. The guides must hold depth and object; slopes are theirs.
struct EdgeRules {
  // As the test has them; at 180 degrees even opposite normals pass, whose cosine rounding may put below -1.
  float CreaseCosine() const { return CreaseCosine(crease_degrees); }
  static float CreaseCosine(double degrees);
  DepthGive Give() const { return {guides, depth_tolerance}; }

  const GuideSet& guides;
  LateSlopes& slopes;  // for who needs those of the whole picture
  double crease_degrees = 180.0;
  double depth_tolerance = 0.0;
  std::span<const std::uint8_t> covered = {};  // by pixel: whether its coverage is above 0; empty: as the guides have it
};

// Whether two pixels near each other look like the same piece of surface:
//   - the same object id;
//   - normals less than `crease` degrees apart; 180 takes any;
//   - a depth difference that the surface's own slope explains: the mean of both pixels' slopes times their distance (the
//     trapezoidal rule), give or take the gentler slope over that distance and `depth_tolerance` of the depth (DepthGive).
//     All of it is relative, so one setting works near and far. The give grows with the distance, so far apart it says
//     little.
class EdgeTest {
 public:
  // Keeps references to both; `guides` must hold depth and object.
  EdgeTest(const GuideSet& guides, const DepthSlopes& slopes, double crease_degrees, double depth_tolerance);
  explicit EdgeTest(const EdgeRules& rules)
      : EdgeTest(rules.guides, rules.slopes.Get(), rules.crease_degrees, rules.depth_tolerance) {}

  // What the test needs to know of one pixel.
  struct Side {
    float object, depth, slope_x, slope_y;
    glm::vec3 normal;
  };
  Side At(std::size_t pixel) const {
    return {object_[pixel], depth_[pixel], slope_x_[pixel], slope_y_[pixel],
            {normal_x_[pixel], normal_y_[pixel], normal_z_[pixel]}};
  }
  // q stands (dx, dy) pixels from p. To the bit the same from q's side.
  bool SameSurface(const Side& p, const Side& q, int dx, int dy) const {
    if (p.object != q.object) return false;
    const float x = static_cast<float>(dx), y = static_cast<float>(dy);
    const float expected = 0.5f * ((p.slope_x + q.slope_x) * x + (p.slope_y + q.slope_y) * y);
    const float leeway = std::min(std::fabs(p.slope_x), std::fabs(q.slope_x)) * std::fabs(x) +
                         std::min(std::fabs(p.slope_y), std::fabs(q.slope_y)) * std::fabs(y);
    const float tolerance = leeway + give_.At(std::min(p.depth, q.depth));
    if (!(std::fabs(q.depth - p.depth - expected) <= tolerance)) return false;
    const glm::vec3 &a = p.normal, &b = q.normal;
    return a.x * b.x + a.y * b.y + a.z * b.z > crease_cosine_;
  }

 private:
  std::span<const float> object_, depth_, slope_x_, slope_y_, normal_x_, normal_y_, normal_z_;
  float crease_cosine_;
  DepthGive give_;
};

struct PixelStep {
  int dx = 0, dy = 0;
};

// The pixel before `at` on the way to it from (0, 0), not itself (0, 0): a digital straight line. One less along the longer
// side, and the row or column nearest to the line.
PixelStep StepBefore(PixelStep at);

// Which pixels of the window around another are joined to it: they pass the test, and so does every step from pixel to
// pixel on the way there. Over one pixel the test is sharpest: a step in depth of more than twice the slope per pixel (in
// x and y together, where both sides have one slope) plus the tolerance is never crossed, however far away the other
// pixel stands. The way is a digital straight line, to each pixel by way of the one before it that is nearest to the line.
class JoinedWindow {
 public:
  // For windows of `radius` around pixels of `region`. Keeps the test; `guides` are its. O(pixels of the region grown by
  // the radius + radius²) time and memory.
  JoinedWindow(const EdgeTest& test, const GuideSet& guides, int radius, const Region& region);

  // Calls visit(q, dx, dy) for p, which stands at (x, y) in the region, and for every pixel q of the window that is joined
  // to it, in an order that depends on the radius alone.
  template <class Visit>
  void ForEach(int x, int y, const Visit& visit) const {
    const std::size_t p = std::size_t(y) * width_ + x;
    const std::uint8_t* steps = steps_.data() + std::size_t(y - first_row_) * stride_ + (x - first_column_);
    const EdgeTest::Side here = test_.At(p);
    visit(p, 0, 0);
    for (std::size_t k = 0; k < ways_.size();) {
      const Way& way = ways_[k];
      if (!(steps[way.step_offset] & way.step_bit)) {
        k = way.beyond;
        continue;
      }
      const std::size_t q = p + std::ptrdiff_t(way.pixel_offset);
      if (test_.SameSurface(here, test_.At(q), way.dx, way.dy)) visit(q, int(way.dx), int(way.dy));
      ++k;
    }
  }

 private:
  // A pixel of the window and the last step on the way to it. Ways form a tree, listed from the stem to the twigs: where a
  // step is refused, all that follows from it is skipped.
  struct Way {
    std::int16_t dx, dy;
    std::int32_t pixel_offset;   // from p, in the guides
    std::int32_t step_offset;    // from p, in steps_
    std::uint32_t beyond;        // the next way that does not lead over this one
    std::uint8_t step_bit;
  };
  void Grow(int dx, int dy);
  void MarkSteps(const GuideSet& guides, const Region& grown);

  const EdgeTest& test_;
  int width_, radius_;
  int first_column_, first_row_, stride_;
  std::vector<std::uint8_t> steps_;  // bits: steps right, down left, down, down right; a frame of one pixel has none
  std::vector<Way> ways_;
};

// Both, for who wants a whole region at once.
struct EdgeWindows {
  EdgeTest test;
  JoinedWindow joined;
  EdgeWindows(const EdgeRules& rules, int radius, const Region& region)
      : test(rules), joined(test, rules.guides, radius, region) {}
  EdgeWindows(const EdgeWindows&) = delete;
};

}  // namespace scumble::internal
