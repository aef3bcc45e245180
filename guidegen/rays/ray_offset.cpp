#include "guidegen/rays/ray_offset.h"

#include <algorithm>
#include <limits>

namespace scumble {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

glm::dvec3 WithinRange(const glm::dvec3& v) {
  return glm::clamp(v, glm::dvec3(-kLargestInRay), glm::dvec3(kLargestInRay));
}

}  // namespace

double LightGap(const glm::dvec3& origin, const glm::dvec3& light) {
  return kRoundingPerCoordinate * std::max(LargestCoordinate(origin), LargestCoordinate(light));
}

LightRay LightRayTo(const glm::dvec3& origin, const glm::dvec3& light) {
  LightRay ray{WithinRange(origin), light - origin, 1.0, 0.0};
  const double largest = LargestCoordinate(ray.direction);
  if (largest > kLargestInRay) {
    ray.end = largest;
    ray.direction /= largest;
  }
  ray.reach =
      std::max(0.0, ray.end - LightGap(origin, light) / glm::length(ray.direction));  // 0 if both ends are one point
  return ray;
}

LightRay EndlessLightRay(const glm::dvec3& origin, const glm::dvec3& direction) {
  return {WithinRange(origin), direction, kInfinity, kInfinity};
}

glm::dvec3 MaxRayOffset(const ViewRay& ray, double clear_from, const glm::dvec3& point) {
  const glm::dvec3 back = ray.origin + ray.direction * clear_from - point;
  return glm::dot(back, ray.direction) < 0.0 ? back : glm::dvec3(0.0);
}

glm::dvec3 ShadowRayOrigin(const SurfacePoint& point) {
  // If the surface is seen flatter than this (about half a degree), the offset would be too long for the height it
  // gains.
  constexpr double kLeastCosine = 0.01;
  const double height = point.largest_coordinate * kRoundingPerCoordinate;
  const double length = glm::length(point.max_ray_offset);
  if (!(length > 0.0)) return point.position + point.facing * height;
  const glm::dvec3 direction = point.max_ray_offset / length;
  const double cosine = glm::dot(point.facing, direction);
  const double back = std::min(height / std::max(cosine, kLeastCosine), length);
  return point.position + direction * back + point.facing * (height - back * cosine);
}

}  // namespace scumble
