#include "guidegen/light/direct_light.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <string>

#include "core/image/color.h"
#include "guidegen/surface/shading_normal.h"
#include "guidegen/surface/work_counters.h"

namespace scumble {
namespace {

// Metres up to which a light has no extent. Floats hold nothing smaller, so no scene is smaller; and a radiance, over
// the square of it, stays within a double's range.
constexpr double kLeastRadius = 0x1p-149;

// Radians up to which a sun has no extent: floats cannot show the difference.
constexpr double kLeastHalfAngle = 1e-9;

// Degrees; beyond, the tangent of half the angle would leave every range.
constexpr double kWidestSun = 179.9;

// Layers hold floats: they cannot hold anything brighter.
constexpr double kMaxIrradiance = std::numeric_limits<float>::max() * glm::pi<double>();

Status CheckBrightness(const Light& light, const std::string& who) {
  for (int i = 0; i < 3; ++i) {
    const double value = light.intensity * light.color[i];
    if (value >= 0.0 && std::isfinite(value)) continue;
    return InputError(who + "has the brightness " + std::to_string(value) + ": give it one of 0 or more");
  }
  return Ok();
}

Status CheckExtent(const std::string& who, const char* what, double value) {
  if (value >= 0.0 && std::isfinite(value)) return Ok();
  return InputError(who + "has the " + what + " " + std::to_string(value) + ": give it one of 0 or more");
}

Status PlaceCone(const Light& light, const std::string& who, PlacedLight& placed) {
  const double cos_inner = std::cos(glm::radians(light.inner_cone_degrees));
  const double cos_outer = std::cos(glm::radians(light.outer_cone_degrees));
  if (!std::isfinite(cos_inner) || !std::isfinite(cos_outer) || !std::isfinite(light.spot_blend)) {
    return InputError(who + "has a cone that is not finite: fix its angles");
  }
  placed.cone_scale = 1.0 / std::max(0.001, cos_inner - cos_outer);
  placed.cone_offset = -cos_outer * placed.cone_scale;
  placed.cycles_spot = light.cycles_spot;
  placed.spot_cosine = light.spot_cosine;
  placed.cone_cosine = cos_outer;
  placed.cone_blend = (1.0 - cos_outer) * std::clamp(light.spot_blend, 0.0, 1.0);
  return Ok();
}

Status PlaceArea(const Light& light, const std::string& who, const CameraPose& camera, PlacedLight& placed) {
  SCUMBLE_RETURN_IF_ERROR(CheckExtent(who, "size", light.size_x));
  SCUMBLE_RETURN_IF_ERROR(CheckExtent(who, "size", light.size_y));
  placed.ellipse = light.ellipse;
  const auto half = [&](int column, double size) {
    const glm::dvec3 side(light.world_from_light[column]);
    const double length = glm::length(side);
    return length > 0.0 ? camera.DirectionToView(side / length) * (0.5 * size) : glm::dvec3(0.0);
  };
  placed.half_x = half(0, light.size_x);
  placed.half_y = half(1, light.size_y);
  return Ok();
}

Expected<PlacedLight> PlaceLight(const Light& light, const CameraPose& camera) {
  const std::string who = "light \"" + light.name + "\" ";
  PlacedLight placed;
  placed.type = light.type;
  SCUMBLE_RETURN_IF_ERROR(CheckBrightness(light, who));
  placed.color = glm::dvec3(light.color) * light.intensity;
  placed.intensity = light.intensity * Luminance(light.color.r, light.color.g, light.color.b);
  const glm::dvec3 position(light.world_from_light[3]);
  const glm::dvec3 axis(light.world_from_light[2]);
  const double length = glm::length(axis);
  if (!std::isfinite(position.x + position.y + position.z)) {
    return InputError(who + "stands at a place that is not finite: fix its matrix");
  }
  placed.position = camera.ViewFromWorld(position);
  if (light.type == LightType::kPoint || light.type == LightType::kSpot) {
    SCUMBLE_RETURN_IF_ERROR(CheckExtent(who, "radius", light.radius));
    if (light.radius > kLeastRadius) placed.radius = light.radius;
  }
  if (light.type == LightType::kPoint) return placed;

  if (!(length > 0.0) || !std::isfinite(length)) {
    return InputError(who + "shines nowhere: the third axis of its matrix must be finite and not zero");
  }
  placed.axis = camera.DirectionToView(-axis / length);
  if (light.type == LightType::kSun) {
    SCUMBLE_RETURN_IF_ERROR(CheckExtent(who, "angle", light.angle_degrees));
    if (light.angle_degrees > 180.0) {
      return InputError(who + "is " + std::to_string(light.angle_degrees) + " degrees wide: give a sun at most 180");
    }
    const double half_angle = glm::radians(0.5 * std::min(light.angle_degrees, kWidestSun));
    if (half_angle > kLeastHalfAngle) placed.half_angle = half_angle;
    return placed;
  }
  SCUMBLE_RETURN_IF_ERROR(light.type == LightType::kSpot ? PlaceCone(light, who, placed)
                                                         : PlaceArea(light, who, camera, placed));
  return placed;
}

}  // namespace

Expected<std::vector<PlacedLight>> PlaceLights(const std::vector<Light>& lights, const CameraPose& camera) {
  std::vector<PlacedLight> placed;
  for (const Light& light : lights) {
    SCUMBLE_ASSIGN(PlacedLight one, PlaceLight(light, camera));
    placed.push_back(one);
  }
  return placed;
}

double SpotAttenuation(const PlacedLight& light, const glm::dvec3& from_light) {
  if (light.type != LightType::kSpot) return 1.0;
  const double along = glm::dot(light.axis, from_light);
  if (light.cycles_spot) {
    if (!(along > light.cone_cosine)) return 0.0;
    const double inside = along - light.cone_cosine;
    const double t = inside < light.cone_blend ? inside / light.cone_blend : 1.0;
    return (light.spot_cosine ? std::max(along, 0.0) : 1.0) * t * t * (3.0 - 2.0 * t);
  }
  const double attenuation = std::clamp(along * light.cone_scale + light.cone_offset, 0.0, 1.0);
  return attenuation * attenuation;
}

LightSample SampleLight(const PlacedLight& light, const SurfacePoint& point) {
  ++thread_counters.light_samples;
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
  irradiance *= SpotAttenuation(light, -direction);
  sample.luminance = irradiance * glm::one_over_pi<double>();
  sample.luminance *= ShadingNormalShadow(point.normal, point.smooth_normal, direction);
  return sample;
}

}  // namespace scumble
