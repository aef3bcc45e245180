// Direct light on white Lambert from lights with extent: area lights, meshes that emit, the world. These are the rays
// that make luminance and shadow expensive.
#pragma once

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
};

// The mean of `samples` samples; delta lights are left out. The same sampler gives the same bits.
AreaLighting SampleAreaLights(const EmbreeScene& scene, const LightSet& lights, const SurfacePoint& point,
                              const Sampler& sampler, int samples, RayCounts& rays);

}  // namespace scumble
