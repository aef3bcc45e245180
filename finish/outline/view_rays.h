// The directions in which a view looks.
#pragma once

#include <glm/glm.hpp>

#include "core/image/guides.h"

namespace scumble::internal {

// From what a pixel shows to the viewer, a unit vector in the space of the normals. Guides without a camera are taken
// for orthographic; normals in the eye's frame are turned to it already.
class ViewRays {
 public:
  explicit ViewRays(const GuideSet& guides)
      : per_width_(2.0f / static_cast<float>(guides.width())), per_height_(2.0f / static_cast<float>(guides.height())) {
    const auto normal_frame = guides.attributes.find("scumble:normal_frame");
    if (normal_frame != guides.attributes.end() && normal_frame->second == "eye") return;
    if (!guides.camera || guides.camera->IsOrthographic()) return;
    const glm::dmat4& clip = guides.camera->clip_from_view;
    if (clip[0][0] == 0.0 || clip[1][1] == 0.0) return;
    slope_ = glm::vec2(1.0 / clip[0][0], 1.0 / clip[1][1]);
    middle_ = glm::vec2(clip[2][0] / clip[0][0], clip[2][1] / clip[1][1]);
  }

  glm::vec3 ToViewer(int x, int y) const {
    const glm::vec2 at((static_cast<float>(x) + 0.5f) * per_width_ - 1.0f,
                       1.0f - (static_cast<float>(y) + 0.5f) * per_height_);
    return glm::normalize(glm::vec3(-(at * slope_ + middle_), 1.0f));
  }

 private:
  float per_width_, per_height_;
  glm::vec2 slope_{0.0f}, middle_{0.0f};  // of x and y for a step towards -z
};

}  // namespace scumble::internal
