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

struct Sample {
  const EmbreeScene& scene;
  const LightSet& lights;
  const SurfacePoint& point;
  const glm::dvec3 origin;
  AreaLighting& sum;
  RayCounts& rays;

  // Whether sampled directions search for a light, too.
  bool LooksFor(int light) const { return lights.IsWideFrom(point.position, light); }

  // The weighted contribution of a direction to a light that point sampling finds with `density`; the balance
  // heuristic.
  double Weighed(int light, const glm::dvec3& radiance, double density, double reflected) const {
    const double chosen = lights.FewHaveExtent() ? 1.0 : lights.Probability(point, light, false);
    return Brightness(radiance) * reflected / (reflected + density * chosen);
  }

  // Adds a point of a light that was chosen with a probability.
  void TakeLight(int light_number, double probability, double u, double v) {
    const LightDraw draw = lights.Draw(light_number, point.position, u, v);
    const double reflected = DiffuseDensity(point, draw.direction);
    const double density = probability * draw.density;
    if (!(reflected > 0.0) || !(density > 0.0) || std::isinf(density)) return;
    const double other = LooksFor(light_number) ? reflected : 0.0;
    const double share = ShadingNormalShadow(point.normal, point.smooth_normal, draw.direction);
    const double light = Brightness(draw.radiance) * reflected * share / (density + other);
    if (!(light > 0.0)) return;
    ++rays.shadow;
    const bool blocked = IsBlocked(scene, origin, draw);
    if (!blocked) sum.reached += light;
    if (blocked && lights.IsEmitter(light_number)) {
      ++rays.shadow;
      if (IsBlocked(scene, origin, draw, Blockers::kEmitters)) return;
    }
    sum.unoccluded += light;
  }

  // If few lights have extent, a point of each; otherwise a point of one of them.
  void TakeLights(const Sampler& sampler, std::uint32_t index) {
    if (!lights.FewHaveExtent()) {
      const Quad u = sampler.Draw(index, 1);
      const LightChoice choice = lights.Choose(point, u[0], false);
      if (choice.light >= 0) TakeLight(choice.light, choice.probability, choice.remainder, u[1]);
      return;
    }
    for (int light = 0; light < lights.count(); ++light) {
      if (lights.IsDelta(light)) continue;
      const Quad u = sampler.Draw(index, std::uint32_t(light) + 1);
      TakeLight(light, 1.0, u[0], u[1]);
    }
  }

  // Adds a direction of the surface.
  void TakeDirection(const Quad& u) {
    ++thread_counters.light_samples;
    const glm::dvec2 disc = SquareToDisc(u[0], u[1]);
    glm::dvec3 x, y;
    MakeFrame(point.normal, x, y);
    const double up = std::sqrt(std::max(0.0, 1.0 - glm::dot(disc, disc)));
    const glm::dvec3 direction = glm::normalize(x * disc.x + y * disc.y + point.normal * up);
    const double reflected = DiffuseDensity(point, direction);
    const double share = ShadingNormalShadow(point.normal, point.smooth_normal, direction);
    if (!(reflected * share > 0.0)) return;
    const auto met_before = [&](double length) {
      double light = std::isinf(length) ? Brightness(lights.world()) : 0.0;
      lights.VisitAnalytic(origin, direction, length, [&](int met, const glm::dvec3& radiance, double density) {
        if (LooksFor(met)) light += Weighed(met, radiance, density, reflected);
      });
      return light;
    };
    bool near_emitter = false;
    lights.VisitEmitters(origin, direction, [&](int light) { near_emitter = near_emitter || LooksFor(light); });
    if (near_emitter) ++rays.shadow;
    const double emitted =
        near_emitter ? Emitted(CastAmongEmitters(scene, origin, direction), direction, reflected) : 0.0;
    const double unoccluded = met_before(std::numeric_limits<double>::infinity()) + emitted;
    if (!(unoccluded > 0.0)) return;
    sum.unoccluded += share * unoccluded;
    ++rays.shadow;
    const RTCRayHit hit = CastSingleRay(scene, origin, direction);
    if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
      sum.reached += share * met_before(std::numeric_limits<double>::infinity());
    } else {
      const double met = emitted > 0.0 ? Emitted(hit, direction, reflected) : 0.0;
      sum.reached += share * (met_before(double(hit.ray.tfar)) + met);
    }
  }

  // Light of the mesh that a sampled direction hit.
  double Emitted(const RTCRayHit& hit, const glm::dvec3& direction, double reflected) const {
    if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return 0.0;
    const int light = lights.EmitterOf(hit.hit.geomID);
    if (light < 0 || !LooksFor(light)) return 0.0;
    const PlacedObject& object = scene.objects()[hit.hit.geomID];
    const SurfacePoint met = FindSurfacePoint(object, hit.hit.primID, {origin, direction});
    const glm::dvec3 radiance = SurfaceEmission(object, hit.hit.primID, met.barycentric);
    return Weighed(light, radiance, lights.EmitterDensity(light, point.position, met), reflected);
  }
};

}  // namespace

AreaLighting SampleAreaLights(const EmbreeScene& scene, const LightSet& lights, const SurfacePoint& point,
                              const Sampler& sampler, int samples, RayCounts& rays) {
  AreaLighting sum;
  Sample sample{scene, lights, point, ShadowRayOrigin(point), sum, rays};
  const bool by_light = lights.delta_count() < lights.count();
  const bool by_direction = lights.has_world() || lights.AnyWideFrom(point.position);
  for (int i = 0; i < samples; ++i) {
    if (by_light) sample.TakeLights(sampler, std::uint32_t(i));
    if (by_direction) sample.TakeDirection(sampler.Draw(std::uint32_t(i), 0));
  }
  return {sum.reached / samples, sum.unoccluded / samples};
}

}  // namespace scumble
