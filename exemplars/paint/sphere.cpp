#include "exemplars/paint/sphere.h"

#include <algorithm>
#include <cmath>

namespace scumble::paint {

float RimDistance(glm::vec2 at) { return glm::length(at - kRadius) / kRadius; }

glm::vec3 NormalAt(glm::vec2 at) {
  const glm::vec2 across((at.x - kRadius) / kRadius, (kRadius - at.y) / kRadius);
  const float distance = glm::length(across);
  if (distance >= 1.0f) return {across / distance, 0.0f};
  return {across, std::sqrt(1.0f - distance * distance)};
}

glm::vec2 PlaceOf(glm::vec3 normal) { return {kRadius + kRadius * normal.x, kRadius - kRadius * normal.y}; }

Shading ShadingOf(glm::vec3 normal) {
  static const glm::vec3 kHalfway = glm::normalize(kKeyLight + glm::vec3(0, 0, 1));
  static const glm::vec3 kBounce = glm::normalize(glm::vec3(0.60f, -0.78f, -0.12f));
  Shading shading{};
  shading.light = std::max(glm::dot(normal, kKeyLight), 0.0f);
  shading.highlight = std::pow(std::max(glm::dot(normal, kHalfway), 0.0f), 90.0f);
  const float bounce = std::max(glm::dot(normal, kBounce), 0.0f);
  shading.reflected = bounce * bounce;
  shading.value =
      glm::clamp(0.05f + 0.80f * std::pow(shading.light, 0.85f) + 0.24f * shading.reflected + 0.30f * shading.highlight,
                 0.0f, 1.0f);
  return shading;
}

}  // namespace scumble::paint
