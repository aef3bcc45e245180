// Directions by azimuth and elevation, as every option and file of Scumble gives them.
#pragma once

#include <cmath>
#include <glm/glm.hpp>

namespace scumble {

// The light that the bundled exemplars are painted in: from the upper left, over the viewer's shoulder. Degrees in
// *view* space.
inline constexpr double kKeyLightAzimuth = -40.0;
inline constexpr double kKeyLightElevation = 40.0;

// The unit vector of a direction. Right-handed, +Y up: azimuth turns from +Z towards +X, elevation rises from the
// horizon, so that (0°, 0°) is +Z, (90°, 0°) is +X and (any, 90°) is +Y. In view space +Z is towards the viewer.
inline glm::dvec3 DirectionFromAngles(double azimuth_degrees, double elevation_degrees) {
  const double azimuth = glm::radians(azimuth_degrees), elevation = glm::radians(elevation_degrees);
  return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation), std::cos(elevation) * std::cos(azimuth)};
}

}  // namespace scumble
