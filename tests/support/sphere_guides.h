// The guides of the kit's sphere, made without the ray caster.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "core/image/guides.h"

namespace scumble {

// An orthographic unit sphere that fills the square, lit from the upper left.
inline GuideSet SphereGuides(int size) {
  GuideSet guides(size, size);
  for (Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kLuminance}) guides.Add(layer);
  const glm::vec3 light = glm::normalize(glm::vec3(-1, 1, 1));
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const float nx = (2.0f * x + 1.0f) / size - 1.0f, ny = 1.0f - (2.0f * y + 1.0f) / size;
      if (nx * nx + ny * ny >= 1.0f) continue;
      const std::size_t i = guides.Index(x, y);
      const glm::vec3 n(nx, ny, std::sqrt(1.0f - nx * nx - ny * ny));
      guides.Plane(Layer::kCoverage)[i] = 1.0f;
      for (int c = 0; c < 3; ++c) guides.Plane(Layer::kNormal, c)[i] = n[c];
      guides.Plane(Layer::kDepth)[i] = 2.0f - n.z;
      guides.Plane(Layer::kLuminance)[i] = std::max(0.0f, glm::dot(n, light));
    }
  }
  return guides;
}

}  // namespace scumble
