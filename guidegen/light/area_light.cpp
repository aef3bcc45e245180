#include "guidegen/light/area_light.h"

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>

#include "guidegen/light/light_visibility.h"
#include "guidegen/rays/ray_offset.h"
#include "guidegen/rays/single_ray.h"
#include "guidegen/surface/bsdf.h"
#include "guidegen/surface/shading_normal.h"
#include "guidegen/surface/work_counters.h"

namespace scumble {
namespace {

// Seen from a white Lambert surface: the density with which it samples directions is also what it reflects, but for the
// shadow of its shading normal.
double DiffuseDensity(const SurfacePoint& point, const glm::dvec3& direction) {
  const double cosine = glm::dot(point.normal, direction);
  return cosine > 0.0 && glm::dot(point.facing, direction) > 0.0 ? cosine * glm::one_over_pi<double>() : 0.0;
}

}  // namespace

PointLighting::PointLighting(const EmbreeScene& scene, const LightSet& lights, const SurfacePoint& point, double wide)
    : scene_(&scene), lights_(&lights), point_(&point), wide_(wide), origin_(ShadowRayOrigin(point)) {
  for (int light = 0; light < lights.count() && !looks_; ++light) looks_ = LooksFor(light);
}

bool PointLighting::LooksFor(int light) const {
  return lights_->IsWideFrom(point_->position, light, lights_->IsEmitter(light) ? kWideDistance : wide_);
}

std::vector<int> PointLighting::LightTerms(const LightSet& lights) {
  if (!lights.FewHaveExtent()) return {kAnyLight};
  std::vector<int> terms;
  for (int light = 0; light < lights.count(); ++light) {
    if (!lights.IsDelta(light)) terms.push_back(light);
  }
  return terms;
}

// The weighted contribution of a direction to a light that point sampling finds with `density`; the balance heuristic.
double PointLighting::Weighed(int light, const glm::dvec3& radiance, double density, double reflected) const {
  const double chosen = lights_->FewHaveExtent() ? 1.0 : lights_->Probability(*point_, light, false);
  return Brightness(radiance) * reflected / (reflected + density * chosen);
}

// A point of a light that was chosen with a probability.
PointLighting::Take PointLighting::TakeFrom(int light, double probability, double u, double v) const {
  Take take;
  take.light_number = light;
  take.draw = lights_->Draw(light, *point_, u, v);
  const double reflected = DiffuseDensity(*point_, take.draw.direction);
  const double density = probability * take.draw.density;
  if (!(reflected > 0.0) || !(density > 0.0) || std::isinf(density)) return take;
  const double other = LooksFor(light) ? reflected : 0.0;
  const double share = ShadingNormalShadow(point_->normal, point_->smooth_normal, take.draw.direction);
  const double brought = Brightness(take.draw.radiance) * reflected * share / (density + other);
  if (brought > 0.0) take.light = brought;
  return take;
}

PointLighting::Take PointLighting::TakeLight(int light, const Sampler& sampler, std::uint32_t index) const {
  if (light == kAnyLight) {
    const Quad u = sampler.Draw(index, 1);
    const LightChoice choice = lights_->Choose(*point_, u[0], false);
    return choice.light >= 0 ? TakeFrom(choice.light, choice.probability, choice.remainder, u[1]) : Take();
  }
  const Quad u = sampler.Draw(index, std::uint32_t(light) + 1);
  return TakeFrom(light, 1.0, u[0], u[1]);
}

bool PointLighting::IsBlocked(const Take& take) const { return scumble::IsBlocked(*scene_, origin_, take.draw); }

AreaLighting PointLighting::Resolve(const Take& take, bool blocked, RayCounts& rays) const {
  if (!blocked) return {take.light, take.light};
  if (lights_->IsEmitter(take.light_number)) {
    ++rays.shadow;
    if (scumble::IsBlocked(*scene_, origin_, take.draw, Blockers::kEmitters)) return {};
  }
  return {0.0, take.light};
}

// The light of the world and of analytic lights that a direction meets before `length`.
double PointLighting::MetBefore(const glm::dvec3& direction, double length, double reflected) const {
  double light = std::isinf(length) ? Brightness(lights_->world()) : 0.0;
  if (!looks_) return light;
  lights_->VisitAnalytic(origin_, direction, length, [&](int met, const glm::dvec3& radiance, double density) {
    if (LooksFor(met)) light += Weighed(met, radiance, density, reflected);
  });
  return light;
}

AreaLighting PointLighting::TakeDirection(const Sampler& sampler, std::uint32_t index, RayCounts& rays) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Quad u = sampler.Draw(index, 0);
  ++thread_counters.light_samples;
  const glm::dvec2 disc = SquareToDisc(u[0], u[1]);
  glm::dvec3 x, y;
  MakeFrame(point_->normal, x, y);
  const double up = std::sqrt(std::max(0.0, 1.0 - glm::dot(disc, disc)));
  const glm::dvec3 direction = glm::normalize(x * disc.x + y * disc.y + point_->normal * up);
  const double reflected = DiffuseDensity(*point_, direction);
  const double share = ShadingNormalShadow(point_->normal, point_->smooth_normal, direction);
  if (!(reflected * share > 0.0)) return {};
  bool near_emitter = false;
  if (looks_) {
    lights_->VisitEmitters(origin_, direction, [&](int light) { near_emitter = near_emitter || LooksFor(light); });
  }
  if (near_emitter) ++rays.shadow;
  const double emitted =
      near_emitter ? Emitted(CastAmongEmitters(*scene_, origin_, direction), direction, reflected) : 0.0;
  AreaLighting light;
  light.unoccluded = share * (MetBefore(direction, kInfinity, reflected) + emitted);
  if (!(light.unoccluded > 0.0)) return {};
  ++rays.shadow;
  const RTCRayHit hit = CastSingleRay(*scene_, origin_, direction);
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
    light.reached = share * MetBefore(direction, kInfinity, reflected);
  } else {
    const double met = emitted > 0.0 ? Emitted(hit, direction, reflected) : 0.0;
    light.reached = share * (MetBefore(direction, double(hit.ray.tfar), reflected) + met);
  }
  return light;
}

// Light of the mesh that a sampled direction hit.
double PointLighting::Emitted(const RTCRayHit& hit, const glm::dvec3& direction, double reflected) const {
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return 0.0;
  const int light = lights_->EmitterOf(hit.hit.geomID);
  if (light < 0 || !LooksFor(light)) return 0.0;
  const PlacedObject& object = scene_->objects()[hit.hit.geomID];
  const SurfacePoint met = FindSurfacePoint(object, hit.hit.primID, {origin_, direction});
  const glm::dvec3 radiance = SurfaceEmission(object, hit.hit.primID, met.barycentric);
  return Weighed(light, radiance, lights_->EmitterDensity(light, *point_, hit.hit.primID, met), reflected);
}

}  // namespace scumble
