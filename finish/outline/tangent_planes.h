// How depth changes along the planes that touch what pixels show.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <span>

#include "core/image/guides.h"
#include "finish/tone/view_rays.h"

namespace scumble::internal {

// Guides without a camera, or with one that sees nothing, know no such planes. Keeps a reference to the guides.
class TangentPlanes {
 public:
  explicit TangentPlanes(const GuideSet& guides) : guides_(guides), rays_(guides), depth_(guides.Plane(Layer::kDepth)) {
    if (!guides.camera) return;
    const glm::dmat4& clip = guides.camera->clip_from_view;
    const glm::dvec2 step(2.0 / (guides.width() * clip[0][0]), -2.0 / (guides.height() * clip[1][1]));
    if (!std::isfinite(step.x + step.y)) return;
    step_ = step, has_perspective_ = !guides.camera->IsOrthographic();
  }

  // By how much the depth on the plane of the pixel's surface grows to the next pixel of its row, or to the one below.
  // 0 if that is unknown, or if the surface looks away. A surface of which next to nothing shows counts for one that is
  // a little less steep: there small errors of a normal are large ones of a slope.
  float StepAt(std::size_t pixel, bool is_below) const {
    constexpr float kLeastFacing = 0.05f;
    const auto width = static_cast<std::size_t>(guides_.width());
    const glm::vec3 normal = guides_.Vec3(Layer::kNormal, pixel);
    const glm::vec2 sight = rays_.SightAt(static_cast<int>(pixel % width), static_cast<int>(pixel / width));
    const float facing = normal.z - normal.x * sight.x - normal.y * sight.y;
    if (!(facing > 0.0f)) return 0.0f;
    const float across = is_below ? normal.y * step_.y : normal.x * step_.x;
    return across * (has_perspective_ ? depth_[pixel] : 1.0f) / std::max(facing, kLeastFacing);
  }

 private:
  const GuideSet& guides_;
  ViewRays rays_;
  std::span<const float> depth_;
  glm::vec2 step_{0.0f};  // metres a pixel; in perspective one metre before the eye
  bool has_perspective_ = false;
};

}  // namespace scumble::internal
