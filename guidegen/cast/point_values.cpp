#include "guidegen/cast/point_values.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace scumble {
namespace {

// The smallest rotation that takes the direction to the eye to +Z.
glm::dvec3 RotateToEye(const glm::dvec3& normal, const ViewRay& ray) {
  const glm::dvec3 to_eye = glm::normalize(-ray.direction);
  const glm::dvec3 axis = glm::cross(to_eye, glm::dvec3(0.0, 0.0, 1.0));
  const glm::dvec3 turn = glm::cross(axis, normal);
  return normal + turn + glm::cross(axis, turn) / (1.0 + to_eye.z);
}

}  // namespace

glm::dvec3 PointValues::Normal(const SurfacePoint& point, const ViewRay& ray) const {
  return frame_ == NormalFrame::kEye ? RotateToEye(point.normal, ray) : point.normal;
}

glm::dvec3 PointValues::Rest(std::uint32_t object, std::uint32_t primitive, const SurfacePoint& point,
                             const ViewRay& ray) const {
  const PlacedObject& placed = scene_.objects()[object];
  return placed.mesh ? RestPosition(placed, primitive, point.barycentric)
                     : FindSurfacePoint(placed, 0, ray).rest_position;
}

glm::dvec2 PointValues::Motion(std::uint32_t object, std::uint32_t primitive, const glm::dvec2& barycentric) const {
  const PlacedObject& next = view_.next_objects[object];
  if (!next.mesh) return glm::dvec2(0.0);
  // Both frames use equal arithmetic, so that still points move by exactly 0.
  const auto seen_at = [&](const PlacedObject& placed, const CameraRays& camera) {
    return camera.PixelOf(ViewPlace(placed, primitive, barycentric));
  };
  const std::optional<glm::dvec2> from = seen_at(scene_.objects()[object], view_.camera);
  const std::optional<glm::dvec2> to = seen_at(next, view_.next_camera);
  return from && to && std::isfinite(to->x + to->y) ? *to - *from : glm::dvec2(0.0);
}

double PointValues::Cosine(const SurfacePoint& point) const {
  if (!view_.key_lamp) return 0.0;
  return std::clamp(glm::dot(point.normal, view_.key_lamp->Towards(point.position)), -1.0, 1.0);
}

glm::dvec2 PointValues::Uv(std::uint32_t object, std::uint32_t primitive, const glm::dvec2& barycentric) const {
  const std::optional<glm::vec2> uv = SurfaceUv(scene_.objects()[object], primitive, barycentric);
  return uv ? glm::dvec2(uv->x, 1.0 - double(uv->y)) : glm::dvec2(0.0);
}

}  // namespace scumble
