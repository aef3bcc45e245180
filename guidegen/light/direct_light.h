// Lights before the camera, and their direct light on white Lambert: what reaches a point when nothing is in the way.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "guidegen/rays/camera_rays.h"
#include "guidegen/scene/scene.h"
#include "guidegen/surface/surface.h"
#include "core/image/status.h"

namespace scumble {

// A light before the camera, in view space. A light without extent is a delta light: one ray tells all about it.
struct PlacedLight {
  LightType type = LightType::kPoint;
  glm::dvec3 position{0.0};
  glm::dvec3 axis{0.0, 0.0, -1.0};  // unit, where it shines
  glm::dvec3 color{0.0};            // colour × intensity, in the units of Light::intensity
  double intensity = 0.0;           // its Rec.709 luminance
  double cone_scale = 0.0;          // spot: attenuation is clamp(cosine · scale + offset)²
  double cone_offset = 1.0;
  bool cycles_spot = false;  // spot: cosine · smoothstep((cosine − cone_cosine) / cone_blend) instead
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
Expected<std::vector<PlacedLight>> PlaceLights(const std::vector<Light>& lights, const CameraRays& camera);

// The share of a spot's intensity that leaves it in a direction, a unit vector; 1 for other lights.
double SpotAttenuation(const PlacedLight& light, const glm::dvec3& from_light);

// What one delta light does to a point.
struct LightSample {
  double luminance = 0.0;    // reflected radiance of white Lambert, irradiance/π; 0 where the light cannot reach
  glm::dvec3 to_light{0.0};  // view space; reaches the light at length 1 unless `endless`
  bool endless = false;      // a sun: the way has no end
};

// For delta lights. Point: I cosθ/(π d²). Spot: the same within its cone. Sun: E cosθ/π. Light must come from the
// viewer's side of the geometric surface as well as of the shading normal. Finite as a float, too.
LightSample SampleLight(const PlacedLight& light, const SurfacePoint& point);

// How far Embree's floats may be from a surface, for each metre of its largest coordinate C. Across the surface, in
// units of u = 2⁻²⁴: corners and the ray's origin, rounded to float, are off by √3 C each; the ray's direction by 1 for
// each metre of way on the triangle; the corners relative to the origin, and the three products of that vector with the
// normal, by 1 and 3 for each metre of the triangle's length L, and the normal itself, which comes of two products of
// edges, by 4 L over the sine between them. That is 2√3 C + 5 L + 4 L / sine, and 16 C covers it for triangles up to
// L = 1.39 C. (Larger ones fill the view, and their errors never all have one sign: measured, 2 C is enough for them,
// and 8 C for slivers.)
inline constexpr double kRoundingPerCoordinate = 0x1.0p-20;

// How near to a light a ray goes, in metres: Embree's floats put the two ends of its way that far off at most. What is
// nearer may be the wall that a lamp hangs on. So a wall hides a lamp behind it where the lamp is farther from it than
// that and the wall's own rounding together: 2⁻¹⁹ of the largest coordinate of the wall's triangle, the lamp and the
// place that is lit. Lamps have no body; that an emissive mesh does not shade itself is ShadowTarget's to see to.
double LightGap(const glm::dvec3& origin, const glm::dvec3& light);

// A ray of light as Embree can take it, at any distance: where it is too long for a direction, it is shorter, and `end`
// and `reach` are larger. Where a surface is at the end of Embree's range, the origin stays within it.
struct LightRay {
  glm::dvec3 origin;
  glm::dvec3 direction;
  double end;    // where the light is, in lengths of the direction; infinite where the way has no end
  double reach;  // how far to look for what is in the way: short of the end by LightGap
};
LightRay LightRayTo(const glm::dvec3& origin, const glm::dvec3& light);
LightRay EndlessLightRay(const glm::dvec3& origin, const glm::dvec3& direction);  // a unit vector

// Where a shadow ray starts: above the surface, on the viewer's side, by more than Embree's floats can be wrong. It
// goes up along the point's clear way where there is one, so that no other surface comes to lie between: beside an edge
// where surfaces meet at less than a right angle, straight up would be outside.
glm::dvec3 ShadowRayOrigin(const SurfacePoint& point);

}  // namespace scumble
