#include "guidegen/soft_light.h"

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>

#include "guidegen/bsdf.h"
#include "guidegen/single_ray.h"

namespace scumble {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Seen from a white Lambert surface: the density with which it samples directions is also what it reflects.
double DiffuseDensity(const SurfacePoint& point, const glm::dvec3& direction) {
  const double cosine = glm::dot(point.normal, direction);
  return cosine > 0.0 && glm::dot(point.facing, direction) > 0.0 ? cosine * glm::one_over_pi<double>() : 0.0;
}

struct Sample {
  const EmbreeScene& scene;
  const LightSet& lights;
  const SurfacePoint& point;
  const glm::dvec3 origin;
  SoftLight& sum;
  RayCounts& rays;

  // Whether directions look for a light, too. They never meet meshes here.
  bool LooksFor(int light) const { return !lights.IsEmitter(light) && lights.IsWideFrom(point.position, light); }

  // A point of a light that was chosen with a probability.
  void TakeLight(int light_number, double probability, double u, double v) {
    const LightDraw draw = lights.Draw(light_number, point.position, u, v);
    const double reflected = DiffuseDensity(point, draw.direction);
    const double density = probability * draw.density;
    if (!(reflected > 0.0) || !(density > 0.0) || std::isinf(density)) return;
    const double other = LooksFor(light_number) ? reflected : 0.0;
    const double light = Brightness(draw.radiance) * reflected / (density + other);
    if (!(light > 0.0)) return;
    sum.unoccluded += light;
    ++rays.shadow;
    if (!IsBlocked(scene, origin, draw)) sum.reached += light;
  }

  // A point of each light that is no delta light where these are few, or else of one of them.
  void TakeLights(const Sampler& sampler, std::uint32_t index) {
    if (!lights.FewHaveExtent()) {
      const Quad u = sampler.Draw(index, 1);
      const LightChoice choice = lights.Choose(point, u[0], false);
      if (choice.light >= 0) TakeLight(choice.light, choice.probability, choice.rest, u[1]);
      return;
    }
    for (int light = 0; light < lights.count(); ++light) {
      if (lights.IsDelta(light)) continue;
      const Quad u = sampler.Draw(index, std::uint32_t(light) + 1);
      TakeLight(light, 1.0, u[0], u[1]);
    }
  }

  // A direction of the surface.
  void TakeDirection(const Quad& u) {
    const glm::dvec2 disc = SquareToDisc(u[0], u[1]);
    glm::dvec3 x, y;
    MakeFrame(point.normal, x, y);
    const double up = std::sqrt(std::max(0.0, 1.0 - glm::dot(disc, disc)));
    const glm::dvec3 direction = glm::normalize(x * disc.x + y * disc.y + point.normal * up);
    const double reflected = DiffuseDensity(point, direction);
    if (!(reflected > 0.0)) return;
    const auto met_before = [&](double length) {
      double light = std::isinf(length) ? Brightness(lights.world()) : 0.0;
      lights.VisitLamps(origin, direction, length, [&](int lamp, const glm::dvec3& radiance, double density) {
        if (!LooksFor(lamp)) return;
        const double chosen = lights.FewHaveExtent() ? 1.0 : lights.Probability(point, lamp, false);
        const double other = density * chosen;
        light += Brightness(radiance) * reflected / (reflected + other);
      });
      return light;
    };
    const double unoccluded = met_before(kInfinity);
    if (!(unoccluded > 0.0)) return;
    sum.unoccluded += unoccluded;
    ++rays.shadow;
    const RTCRayHit hit = CastSingleRay(scene, origin, direction);
    sum.reached += hit.hit.geomID == RTC_INVALID_GEOMETRY_ID ? unoccluded : met_before(double(hit.ray.tfar));
  }
};

}  // namespace

SoftLight SampleSoftLight(const EmbreeScene& scene, const LightSet& lights, const SurfacePoint& point,
                          const Sampler& sampler, int samples, RayCounts& rays) {
  SoftLight sum;
  Sample sample{scene, lights, point, ShadowRayOrigin(point), sum, rays};
  const bool by_light = lights.delta_count() < lights.count();
  const bool by_direction = lights.has_world() || (lights.has_extended_lamps() && lights.AnyWideFrom(point.position));
  for (int i = 0; i < samples; ++i) {
    if (by_light) sample.TakeLights(sampler, std::uint32_t(i));
    if (by_direction) sample.TakeDirection(sampler.Draw(std::uint32_t(i), 0));
  }
  return {sum.reached / samples, sum.unoccluded / samples};
}

}  // namespace scumble
