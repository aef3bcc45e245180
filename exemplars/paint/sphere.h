// The sphere that fills the picture, and how the key light falls on it.
#pragma once

#include <glm/glm.hpp>

#include "exemplars/paint/engine/canvas.h"

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

// What a ball is painted for.
enum class Light {
  kKey,      // the key light in full
  kGrazing,  // the same light, weaker, more from the front and softer: half-tones
  kSky,      // none of it: what the sky gives from above and the ground from below
  kCrevice,  // not even the sky: under things and between them, where only the ground's bounce comes
};

// The unit direction towards the light; for the sky nearly straight up, leaning to the key light's side, and in a
// crevice from below, where the bounce comes from.
glm::vec3 Towards(Light light);

// What a painter looks for in a lit ball. All in [0, 1].
struct Shading {
  float value;  // overall lightness, the same scale in every light
  float light;  // how far it faces the light that there is: the cosine, 0 … 1 over the whole ball under the sky and in
                // a crevice
  float highlight;  // mirror image of the light
  float reflected;  // light that comes back from below right into the shade
};
Shading ShadingOf(glm::vec3 normal, Light light = Light::kKey);
inline Shading ShadingAt(glm::vec2 at, Light light = Light::kKey) { return ShadingOf(NormalAt(at), light); }
// 1 − value.
inline float DarknessAt(glm::vec2 at, Light light = Light::kKey) { return 1.0f - ShadingAt(at, light).value; }

}  // namespace scumble::paint
