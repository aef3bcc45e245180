#include "exemplars/paint/sphere.h"

#include <algorithm>
#include <cmath>

namespace scumble::paint {
namespace {
constexpr glm::vec3 kBounce{0.60f, -0.78f, -0.12f};  // direction of the light reflected from below
}  // namespace

float RimDistance(glm::vec2 at) { return glm::length(at - kRadius) / kRadius; }

glm::vec3 NormalAt(glm::vec2 at) {
  const glm::vec2 across((at.x - kRadius) / kRadius, (kRadius - at.y) / kRadius);
  const float distance = glm::length(across);
  if (distance >= 1.0f) return {across / distance, 0.0f};
  return {across, std::sqrt(1.0f - distance * distance)};
}

glm::vec2 PlaceOf(glm::vec3 normal) { return {kRadius + kRadius * normal.x, kRadius - kRadius * normal.y}; }

glm::vec3 Towards(Light light) {
  switch (light) {
    case Light::kGrazing:
      return glm::normalize(kKeyLight + glm::vec3(0.0f, -0.1f, 0.5f));
    case Light::kSky:
      return glm::normalize(glm::vec3(-0.25f, 0.85f, 0.35f));
    case Light::kCrevice:
      return glm::normalize(kBounce);
    case Light::kKey:
      break;
  }
  return kKeyLight;
}

Shading ShadingOf(glm::vec3 normal, Light light) {
  static const glm::vec3 kHalfway = glm::normalize(kKeyLight + glm::vec3(0, 0, 1));
  Shading shading{};
  const float facing = glm::dot(normal, Towards(light));
  const float bounce = std::max(glm::dot(normal, glm::normalize(kBounce)), 0.0f);
  shading.reflected = bounce * bounce;
  switch (light) {
    case Light::kKey:
      shading.light = std::max(facing, 0.0f);
      shading.highlight = std::pow(std::max(glm::dot(normal, kHalfway), 0.0f), 90.0f);
      shading.value =
          0.05f + 0.80f * std::pow(shading.light, 0.85f) + 0.24f * shading.reflected + 0.30f * shading.highlight;
      break;
    case Light::kGrazing:
      shading.light = std::max(facing, 0.0f);
      shading.value = 0.06f + 0.58f * std::pow(shading.light, 0.85f) + 0.20f * shading.reflected;
      break;
    case Light::kSky:
      shading.light = std::pow(std::max(0.5f + 0.5f * facing, 0.0f), 1.4f);
      shading.value = 0.05f + 0.26f * shading.light + 0.10f * shading.reflected;
      break;
    case Light::kCrevice:
      shading.light = std::pow(std::max(0.5f + 0.5f * facing, 0.0f), 1.4f);
      shading.value = 0.02f + 0.05f * shading.light + 0.08f * shading.reflected;
      break;
  }
  shading.value = glm::clamp(shading.value, 0.0f, 1.0f);
  return shading;
}

}  // namespace scumble::paint
