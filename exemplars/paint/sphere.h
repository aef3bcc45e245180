// The sphere that fills the picture, and how the key light falls on it.
#pragma once

#include <glm/glm.hpp>

#include "exemplars/paint/canvas.h"

namespace scumble::paint {

inline constexpr float kRadius = kSide / 2.0f;
// Azimuth −40°, elevation 40° in view space: upper left, over the viewer's shoulder.
inline constexpr glm::vec3 kKeyLight{-0.4924039f, 0.6427876f, 0.5868241f};

// Distance from the centre in radii: 1 on the rim.
float RimDistance(glm::vec2 at);

// The view-space normal seen at a place in the picture. Paint runs past the rim, so places outside have the normal of
// the nearest point of the rim.
glm::vec3 NormalAt(glm::vec2 at);
// The inverse, for normals that face the viewer.
glm::vec2 PlaceOf(glm::vec3 normal);

// What a painter looks for in a lit ball. All in [0, 1].
struct Shading {
  float value;      // overall lightness
  float light;      // direct light, the cosine
  float highlight;  // mirror image of the light
  float reflected;  // light that comes back from below right into the shade
};
Shading ShadingOf(glm::vec3 normal);
inline Shading ShadingAt(glm::vec2 at) { return ShadingOf(NormalAt(at)); }
// 1 − value.
inline float DarknessAt(glm::vec2 at) { return 1.0f - ShadingAt(at).value; }

}  // namespace scumble::paint
