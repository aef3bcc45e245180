// Direct light on white Lambert from lights with extent: lamps, meshes that emit, the world. The luminance and shadow
// layers' share that no single ray can tell.
#pragma once

#include "guidegen/rays/embree_scene.h"
#include "guidegen/guidegen.h"
#include "guidegen/light/light_sampling.h"
#include "guidegen/light/sampler.h"

namespace scumble {

// Reflected luminance, irradiance/π, with and without what stands in the way. What shines does not count as standing in
// the way of other shining meshes, nor the front of one as standing before its back: a ball of light casts no shadow.
struct AreaLighting {
  double reached = 0.0;
  double unoccluded = 0.0;
};

// The mean of `samples` samples; delta lights are left out. The same sampler gives the same bits.
AreaLighting SampleAreaLights(const EmbreeScene& scene, const LightSet& lights, const SurfacePoint& point,
                          const Sampler& sampler, int samples, RayCounts& rays);

}  // namespace scumble
