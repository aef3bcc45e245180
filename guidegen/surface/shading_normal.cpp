#include "guidegen/surface/shading_normal.h"

#include <algorithm>
#include <cmath>

namespace scumble {
namespace {

// Cycles leaves out what reflects less: such a surface has no closure.
constexpr double kLeastReflection = 1e-5;
// Cycles takes a mirrored ray of this height for one above the surface.
constexpr double kLeastHeight = 1e-5;

// Whether Cycles turns the normal of all closures alike. Textures are not read.
bool BendsNormals(const Material& material) {
  if (material.cycles4 && material.bsdf != Bsdf::kGlossy) return false;
  if (material.bsdf == Bsdf::kMetallicRoughness) return true;
  const glm::dvec3 color(material.base_color);
  return material.bsdf != Bsdf::kEmission && color.r + color.g + color.b >= 3.0 * kLeastReflection;
}

}  // namespace

glm::dvec3 BentNormal(const glm::dvec3& facing, const glm::dvec3& to_eye, const glm::dvec3& normal) {
  if (normal == facing) return normal;
  const double up = glm::dot(to_eye, facing);
  const double height = std::min(kReflectionShare * up, kReflectionHeight);
  const glm::dvec3 mirrored = normal * (2.0 * glm::dot(normal, to_eye)) - to_eye;
  if (glm::dot(mirrored, facing) >= height) return normal;
  glm::dvec3 across = normal - facing * glm::dot(normal, facing);
  if (!MakeUnit(across)) return facing;
  const double side = glm::dot(to_eye, across);
  const double squared = side * side + up * up;
  if (!(squared > 0.0)) return facing;
  const double root = std::sqrt(std::max(squared - height * height, 0.0));
  const auto turned = [&](double sign) {
    const double cosine_of_twice = std::clamp((up * height + sign * side * root) / squared, -1.0, 1.0);
    return glm::dvec2(std::sqrt(0.5 * (1.0 - cosine_of_twice)), std::sqrt(0.5 * (1.0 + cosine_of_twice)));
  };
  glm::dvec2 turn = turned(-1.0);
  const glm::dvec2 other = turned(1.0);
  const double other_height = 2.0 * (other.x * side + other.y * up) * other.y - up;
  if (other_height >= kLeastHeight && other_height < height) turn = other;
  return across * turn.x + facing * turn.y;
}

void BendShadingNormal(const PlacedObject& object, const ViewRay& ray, SurfacePoint& point) {
  if (!BendsNormals(*object.material)) return;
  const glm::dvec3 bent = BentNormal(point.facing, glm::normalize(-ray.direction), point.normal);
  if (bent == point.normal) return;
  if (point.smooth_normal == glm::dvec3(0.0)) point.smooth_normal = point.normal;
  point.normal = bent;
}

double ShadingNormalShadow(const glm::dvec3& normal, const glm::dvec3& smooth_normal, const glm::dvec3& to_light) {
  if (smooth_normal == glm::dvec3(0.0)) return 1.0;
  const double above = glm::dot(smooth_normal, to_light);
  const double below = glm::dot(normal, to_light) * glm::dot(smooth_normal, normal);
  if (below == 0.0) return 0.0;
  const double share = above / below;
  if (share >= 1.0) return 1.0;
  return share > 0.0 ? share * (1.0 + share * (1.0 - share)) : 0.0;
}

}  // namespace scumble
