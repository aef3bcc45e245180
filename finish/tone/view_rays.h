// The directions in which a view looks.
#pragma once

#include <cmath>
#include <glm/glm.hpp>

#include "core/image/guides.h"

namespace scumble::internal {

// In the space of the normals: normals in the eye's frame are turned to the line of sight already. Guides without a
// camera, or with one that sees nothing, are taken for orthographic.
class ViewRays {
 public:
  explicit ViewRays(const GuideSet& guides) {
    const auto normal_frame = guides.attributes.find("scumble:normal_frame");
    if (normal_frame != guides.attributes.end() && normal_frame->second == "eye") return;
    if (!guides.camera || guides.camera->IsOrthographic()) return;
    const glm::dmat4& clip = guides.camera->clip_from_view;
    // x of clip space, -1 … 1 over the width, is clip[0][0] X - clip[2][0] one metre before the eye; y likewise.
    const glm::dvec2 step(2.0 / (guides.width() * clip[0][0]), -2.0 / (guides.height() * clip[1][1]));
    const glm::dvec2 first((1.0 / guides.width() - 1.0 + clip[2][0]) / clip[0][0],
                           (1.0 - 1.0 / guides.height() + clip[2][1]) / clip[1][1]);
    if (!std::isfinite(step.x + step.y + first.x + first.y)) return;
    step_ = step, first_ = first;
  }

  // Where the line of sight of a pixel's centre meets the plane one metre before the eye; (0, 0) where all are
  // parallel.
  glm::vec2 SightAt(int x, int y) const { return first_ + step_ * glm::vec2(x, y); }
  // From what the pixel shows to the viewer, of length 1.
  glm::vec3 ToViewer(int x, int y) const { return glm::normalize(glm::vec3(-SightAt(x, y), 1.0f)); }

 private:
  glm::vec2 first_{0.0f}, step_{0.0f};
};

}  // namespace scumble::internal
