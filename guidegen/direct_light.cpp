#include "guidegen/direct_light.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <string>

#include "image/color.h"

namespace scumble {
namespace {

// Corners are rounded to 2⁻²⁴ of their largest coordinate, and the intersection loses a few more bits.
constexpr double kOffsetPerCoordinate = 0x1.0p-20;

// Layers hold floats: brighter than this cannot be told.
constexpr double kMaxIrradiance = std::numeric_limits<float>::max() * glm::pi<double>();

Expected<PlacedLight> PlaceLight(const Light& light, const CameraRays& camera) {
  const std::string who = "light \"" + light.name + "\" ";
  PlacedLight placed;
  placed.type = light.type;
  placed.intensity = light.intensity * Luminance(light.color.r, light.color.g, light.color.b);
  if (!(placed.intensity >= 0.0) || !std::isfinite(placed.intensity)) {
    return InputError(who + "has the brightness " + std::to_string(placed.intensity) + ": give it one of 0 or more");
  }
  const glm::dvec3 position(light.world_from_light[3]);
  const glm::dvec3 axis(light.world_from_light[2]);
  const double length = glm::length(axis);
  if (!std::isfinite(position.x + position.y + position.z)) {
    return InputError(who + "stands at a place that is not finite: mend its matrix");
  }
  placed.position = camera.ViewFromWorld(position);
  if (light.type == LightType::kPoint) return placed;

  if (!(length > 0.0) || !std::isfinite(length)) {
    return InputError(who + "shines nowhere: the third axis of its matrix must be finite and not zero");
  }
  placed.axis = camera.DirectionToView(-axis / length);
  if (light.type == LightType::kSun) return placed;

  const double cos_inner = std::cos(glm::radians(light.inner_cone_degrees));
  const double cos_outer = std::cos(glm::radians(light.outer_cone_degrees));
  if (!std::isfinite(cos_inner) || !std::isfinite(cos_outer)) {
    return InputError(who + "has a cone that is not finite: mend its angles");
  }
  placed.cone_scale = 1.0 / std::max(0.001, cos_inner - cos_outer);
  placed.cone_offset = -cos_outer * placed.cone_scale;
  return placed;
}

}  // namespace

Expected<std::vector<PlacedLight>> PlaceLights(const std::vector<Light>& lights, const CameraRays& camera) {
  std::vector<PlacedLight> placed;
  for (const Light& light : lights) {
    SCUMBLE_ASSIGN(PlacedLight one, PlaceLight(light, camera));
    placed.push_back(one);
  }
  return placed;
}

LightSample SampleLight(const PlacedLight& light, const SurfacePoint& point) {
  LightSample sample;
  sample.endless = light.type == LightType::kSun;
  sample.to_light = sample.endless ? -light.axis : light.position - point.position;
  const double distance = glm::length(sample.to_light);
  if (!(distance > 0.0)) return sample;
  const glm::dvec3 direction = sample.to_light / distance;
  const double cosine = glm::dot(point.normal, direction);
  if (!(cosine > 0.0) || !(glm::dot(point.facing, direction) > 0.0)) return sample;
  double irradiance = light.intensity * cosine;
  if (!(irradiance > 0.0)) return sample;
  // The square of a distance may underflow to 0. What is infinite is clamped before a cone's 0 can make it NaN.
  if (!sample.endless) irradiance /= distance * distance;
  irradiance = std::min(irradiance, kMaxIrradiance);
  if (light.type == LightType::kSpot) {
    const double along = glm::dot(light.axis, -direction);
    const double attenuation = std::clamp(along * light.cone_scale + light.cone_offset, 0.0, 1.0);
    irradiance *= attenuation * attenuation;
  }
  sample.luminance = irradiance * glm::one_over_pi<double>();
  return sample;
}

glm::dvec3 ShadowRayOrigin(const SurfacePoint& point) {
  return point.position + point.facing * (point.largest_coordinate * kOffsetPerCoordinate);
}

}  // namespace scumble
