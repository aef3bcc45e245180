// Direct light on white Lambert from lights with extent: area lights, meshes that emit, the world. These are the rays
// that make luminance and shadow expensive. This is the light of one point, a sample at a time; area_light_tile.h
// decides how many samples each point takes, and casts the rays of many points together.
#pragma once

#include <vector>

#include "guidegen/guidegen.h"
#include "guidegen/light/light_sampling.h"
#include "guidegen/light/sampler.h"
#include "guidegen/rays/embree_scene.h"

namespace scumble {

// Reflected luminance, irradiance/π, with and without occluders. A mesh that emits does not occlude other meshes that
// emit, nor its own back: a sphere of light casts no shadow.
struct AreaLighting {
  double reached = 0.0;
  double unoccluded = 0.0;

  AreaLighting& operator+=(const AreaLighting& other) {
    reached += other.reached;
    unoccluded += other.unoccluded;
    return *this;
  }
};

// The light of one point as a sum of terms, each the mean of any number of samples. Each light with extent is a term;
// where they are many, a single term samples a light chosen anew each time. A further term samples directions of the
// surface, where lights are so wide that they must be looked for, and where the world shines. Delta lights are left
// out. Borrows all that it is given.
class PointLighting {
 public:
  PointLighting() = default;
  // `wide`: the distance, in radii of an analytic light, within which directions look for it; for meshes that emit it
  // is kWideDistance always.
  PointLighting(const EmbreeScene& scene, const LightSet& lights, const SurfacePoint& point,
                double wide = kWideDistance);

  // The terms of lights: numbers of lights, or kAnyLight alone; none where no light has extent.
  static constexpr int kAnyLight = -1;
  static std::vector<int> LightTerms(const LightSet& lights);

  // Whether directions are sampled here, and whether they look for any light besides the world.
  bool HasDirections() const { return lights_->has_world() || looks_; }
  bool LooksForLights() const { return looks_; }

  const glm::dvec3& origin() const { return origin_; }  // of shadow rays

  // Sample `index` of a light or of any light, before its shadow ray is cast: what it brings if nothing is in the way,
  // and to where. Light of 0 needs no ray.
  struct Take {
    double light = 0.0;
    int light_number = -1;
    LightDraw draw;
  };
  Take TakeLight(int light, const Sampler& sampler, std::uint32_t index) const;
  // What the sample brings, once it is known whether its shadow ray is blocked. Casts the second ray that the blocked
  // light of a mesh needs.
  AreaLighting Resolve(const Take& take, bool blocked, RayCounts& rays) const;
  // Whether the shadow ray is blocked: a ray of its own.
  bool IsBlocked(const Take& take) const;

  // Sample `index` of the directions.
  AreaLighting TakeDirection(const Sampler& sampler, std::uint32_t index, RayCounts& rays) const;

 private:
  bool LooksFor(int light) const;
  Take TakeFrom(int light, double probability, double u, double v) const;
  double Weighed(int light, const glm::dvec3& radiance, double density, double reflected) const;
  double MetBefore(const glm::dvec3& direction, double length, double reflected) const;
  double Emitted(const RTCRayHit& hit, const glm::dvec3& direction, double reflected) const;

  const EmbreeScene* scene_ = nullptr;
  const LightSet* lights_ = nullptr;
  const SurfacePoint* point_ = nullptr;
  double wide_ = kWideDistance;
  bool looks_ = false;
  glm::dvec3 origin_{0.0};
};

}  // namespace scumble
