#include "guidegen/light/key_lamp.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "guidegen/framing.h"
#include "guidegen/light/light_tree.h"
#include "guidegen/surface/bsdf.h"

namespace scumble {
namespace {

// The largest irradiance so far, and its lamp.
class Brightest {
 public:
  explicit Brightest(const glm::dvec3& centre) : centre_(centre) {}

  void AddSun(double irradiance, const glm::dvec3& towards) { Add(irradiance, {true, towards}); }
  // `power` is the irradiance at a distance of one metre.
  void AddNear(double power, const glm::dvec3& at) {
    const glm::dvec3 off = at - centre_;
    Add(power / std::max(glm::dot(off, off), kLeastSquaredDistance), {false, at});
  }
  const std::optional<KeyLamp>& lamp() const { return lamp_; }

 private:
  void Add(double irradiance, const KeyLamp& lamp) {
    if (irradiance > most_) most_ = irradiance, lamp_ = lamp;
  }

  glm::dvec3 centre_;
  double most_ = 0.0;
  std::optional<KeyLamp> lamp_;
};

void AddLight(const Light& light, Brightest& brightest) {
  const double strength = light.intensity * Brightness(glm::dvec3(light.color));
  const glm::dvec3 at(light.world_from_light[3]);
  switch (light.type) {
    case LightType::kSun:
      brightest.AddSun(strength, glm::normalize(glm::dvec3(light.world_from_light[2])));
      return;
    case LightType::kArea:
      brightest.AddNear(strength * light.size_x * light.size_y * (light.ellipse ? 0.25 * std::numbers::pi : 1.0), at);
      return;
    case LightType::kPoint:
    case LightType::kSpot:
      brightest.AddNear(strength, at);
      return;
  }
}

void AddEmitter(const Mesh& mesh, const glm::dmat4& world_from_object, double radiance, Brightest& brightest) {
  double area = 0.0;
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  for (const glm::uvec3& triangle : mesh.triangles) {
    glm::dvec3 corner[3];
    for (int i = 0; i < 3; ++i) {
      corner[i] = glm::dvec3(world_from_object * glm::dvec4(glm::dvec3(mesh.positions[triangle[i]]), 1.0));
    }
    const double size = 0.5 * glm::length(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
    if (!(size > 0.0) || !std::isfinite(size)) continue;
    area += size;
    for (const glm::dvec3& one : corner) low = glm::min(low, one), high = glm::max(high, one);
  }
  if (area > 0.0 && std::isfinite(area)) brightest.AddNear(radiance * area, 0.5 * (low + high));
}

}  // namespace

glm::dvec3 KeyLamp::Towards(const glm::dvec3& point) const {
  if (endless) return at;
  const glm::dvec3 off = at - point;
  const double length = glm::length(off);
  return length > 0.0 ? off / length : glm::dvec3(0.0);
}

std::optional<KeyLamp> FindKeyLamp(const Scene& scene) {
  Brightest brightest(SphereAround(scene).center);
  for (const Light& light : scene.lights) AddLight(light, brightest);
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    const Material& material = scene.materials[std::size_t(mesh.material)];
    if (!MayEmit(material)) continue;
    AddEmitter(mesh, instance.world_from_object, Brightness(glm::dvec3(material.emission)), brightest);
  }
  return brightest.lamp();
}

}  // namespace scumble
