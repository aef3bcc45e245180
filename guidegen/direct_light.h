// Direct light on white Lambert: what reaches a point when nothing is in the way.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "guidegen/camera_rays.h"
#include "guidegen/scene.h"
#include "guidegen/surface.h"
#include "image/status.h"

namespace scumble {

// A light before the camera, in view space.
struct PlacedLight {
  LightType type = LightType::kPoint;
  glm::dvec3 position{0.0};
  glm::dvec3 axis{0.0, 0.0, -1.0};  // unit, where it shines
  double intensity = 0.0;           // Rec.709 luminance of colour × intensity
  double cone_scale = 0.0;          // spot: attenuation is clamp(cosine · scale + offset)²
  double cone_offset = 1.0;
};

// Fails with kInput, naming the light, where a value is not finite or negative, or a matrix has no direction.
Expected<std::vector<PlacedLight>> PlaceLights(const std::vector<Light>& lights, const CameraRays& camera);

// What one light does to a point.
struct LightSample {
  double luminance = 0.0;    // reflected radiance of white Lambert, irradiance/π; 0 where the light cannot reach
  glm::dvec3 to_light{0.0};  // view space; reaches the light at length 1 unless `endless`
  bool endless = false;      // a sun: the way has no end
};

// Point: I cosθ/(π d²). Spot: the same within KHR_lights_punctual's cone. Sun: E cosθ/π. Light must come from the
// viewer's side of the geometric surface as well as of the shading normal. Finite as a float, too.
LightSample SampleLight(const PlacedLight& light, const SurfacePoint& point);

// Where a shadow ray starts: off the surface, on the viewer's side, by more than Embree's floats can be wrong.
glm::dvec3 ShadowRayOrigin(const SurfacePoint& point);

}  // namespace scumble
