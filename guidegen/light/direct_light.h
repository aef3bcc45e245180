// Lights before the camera, and their direct light on white Lambert: the light that reaches a point without
// occluders.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "core/image/status.h"
#include "guidegen/rays/camera_rays.h"
#include "guidegen/scene.h"
#include "guidegen/surface/surface.h"

namespace scumble {

// A light before the camera, in view space. A light without extent is a delta light: one ray is enough for it.
struct PlacedLight {
  LightType type = LightType::kPoint;
  glm::dvec3 position{0.0};
  glm::dvec3 axis{0.0, 0.0, -1.0};  // unit, the direction in which it shines
  glm::dvec3 color{0.0};            // colour × intensity, in the units of Light::intensity
  double intensity = 0.0;           // its Rec.709 luminance
  double cone_scale = 0.0;          // spot: attenuation is clamp(cosine · scale + offset)²
  double cone_offset = 1.0;
  bool cycles_spot = false;  // spot: cosine · smoothstep((cosine − cone_cosine) / cone_blend) instead
  bool spot_cosine = true;   // false: without the first cosine
  double cone_cosine = 0.0;
  double cone_blend = 0.0;
  double radius = 0.0;      // point, spot
  double half_angle = 0.0;  // sun: radians, at most a right angle
  glm::dvec3 half_x{0.0};   // area: from the centre to the middle of two edges
  glm::dvec3 half_y{0.0};
  bool ellipse = false;

  bool IsDelta() const { return type != LightType::kArea && radius == 0.0 && half_angle == 0.0; }
};

// Fails with kInput, naming the light, where a value is not finite or negative, a sun is wider than 180°, or a matrix
// has no direction.
Expected<std::vector<PlacedLight>> PlaceLights(const std::vector<Light>& lights, const CameraPose& camera);

// The share of a spot's intensity that leaves it in a direction, a unit vector; 1 for other lights.
double SpotAttenuation(const PlacedLight& light, const glm::dvec3& from_light);

// The effect of one delta light on a point.
struct LightSample {
  double luminance = 0.0;    // reflected radiance of white Lambert, irradiance/π; 0 where the light cannot shine
  glm::dvec3 to_light{0.0};  // view space; reaches the light at length 1 unless `endless`
  bool endless = false;      // a sun: infinitely far
};

// For delta lights. Point: I cosθ/(π d²). Spot: the same within its cone. Sun: E cosθ/π. Light must come from the
// viewer's side of the geometric surface as well as of the shading normal. Finite as a float, too.
LightSample SampleLight(const PlacedLight& light, const SurfacePoint& point);

}  // namespace scumble
