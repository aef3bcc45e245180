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

namespace scumble::internal {

// The surface's slope in depth per pixel. A step shows on one side of a pixel only, or turns back on the other: it is
// no slope. Computed once for all styles of a picture. The guides must hold depth. O(pixels).
struct DepthSlopes {
  explicit DepthSlopes(const GuideSet& guides);
  std::vector<float> x, y;
};

// DepthSlopes on demand: the first thread that asks computes them. Keeps a reference to the guides.
class LazyDepthGradient {
 public:
  explicit LazyDepthGradient(const GuideSet& guides) : guides_(guides) {}
  const DepthSlopes& Get() {
    std::call_once(made_, [this] { slopes_.emplace(guides_); });
    return *slopes_;
  }

 private:
  const GuideSet& guides_;
  std::once_flag made_;
  std::optional<DepthSlopes> slopes_;
};

// The depth difference allowed beyond a surface's slope between two pixels, as a share of the nearer depth. In an
// orthographic view depth depends on where the camera stands, so the share is of the height in view. Of the depth it
// then allows only float rounding in casting, 2^-20.
struct DepthTolerance {
  DepthTolerance(const GuideSet& guides, double depth_tolerance);
  float At(float depth) const { return fixed + share * depth; }

  float share = 0.0f;
  float fixed = 0.0f;  // metres
};

// A style's rules for edges. The guides must hold depth and object; the slopes belong to these guides.
struct EdgeRules {
  // The cosine the test compares with. At 180 degrees even opposite normals pass, whose cosine rounding may put below
  // -1.
  float CreaseCosine() const { return CreaseCosine(crease_degrees); }
  static float CreaseCosine(double degrees);
  DepthTolerance Tolerance() const { return {guides, depth_tolerance}; }

  const GuideSet& guides;
  LazyDepthGradient& slopes;  // for callers that need the slopes of the whole picture
  double crease_degrees = 180.0;
  double depth_tolerance = 0.0;
  // By pixel: whether its coverage is above 0; empty: taken from the guides.
  std::span<const std::uint8_t> covered = {};
};

// Whether two neighbouring pixels lie on one surface:
//   - the same object id;
//   - normals less than `crease` degrees apart; 180 takes any;
//   - a depth difference that the surface's own slope explains: the mean of both pixels' slopes (the trapezoidal rule),
//     give or take the gentler slope and `depth_tolerance` of the depth (DepthTolerance). All of it is relative, so one
//     setting works near and far. A step in depth of more than twice the slope per pixel plus the tolerance never
//     passes.
class EdgeTest {
 public:
  // Keeps references to guides and slopes. `guides` must hold depth and object.
  EdgeTest(const GuideSet& guides, const DepthSlopes& slopes, double crease_degrees, double depth_tolerance);
  explicit EdgeTest(const EdgeRules& rules)
      : EdgeTest(rules.guides, rules.slopes.Get(), rules.crease_degrees, rules.depth_tolerance) {}

  // The values that the test reads at one pixel.
  struct Side {
    float object, depth, slope_x, slope_y;
    glm::vec3 normal;
  };
  Side At(std::size_t pixel) const {
    return {object_[pixel],
            depth_[pixel],
            slope_x_[pixel],
            slope_y_[pixel],
            {normal_x_[pixel], normal_y_[pixel], normal_z_[pixel]}};
  }
  // q is (dx, dy) pixels from p, both at most 1. The result from q's side is equal to the bit. Along a row the vertical
  // slopes do not matter, and along a column the horizontal ones.
  bool SameSurface(const Side& p, const Side& q, int dx, int dy) const {
    if (p.object != q.object) return false;
    float along = 0.0f, slope_tolerance = 0.0f;
    if (dx != 0) {
      along += (p.slope_x + q.slope_x) * static_cast<float>(dx);
      slope_tolerance += std::min(std::fabs(p.slope_x), std::fabs(q.slope_x));
    }
    if (dy != 0) {
      along += (p.slope_y + q.slope_y) * static_cast<float>(dy);
      slope_tolerance += std::min(std::fabs(p.slope_y), std::fabs(q.slope_y));
    }
    const float tolerance = slope_tolerance + tolerance_.At(std::min(p.depth, q.depth));
    return std::fabs(q.depth - p.depth - 0.5f * along) <= tolerance && NormalsAlike(p, q);
  }
  // Whether the normals are less than the crease apart.
  bool NormalsAlike(const Side& p, const Side& q) const {
    const glm::vec3 &a = p.normal, &b = q.normal;
    return a.x * b.x + a.y * b.y + a.z * b.z > crease_cosine_;
  }

 private:
  std::span<const float> object_, depth_, slope_x_, slope_y_, normal_x_, normal_y_, normal_z_;
  float crease_cosine_;
  DepthTolerance tolerance_;
};

}  // namespace scumble::internal
