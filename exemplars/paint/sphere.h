// The sphere that fills the picture, and the key light on it.
#pragma once

#include <glm/glm.hpp>

#include "exemplars/paint/engine/canvas.h"

namespace scumble::paint {

inline constexpr float kRadius = kSide / 2.0f;
// Azimuth −40°, elevation 40° in view space: upper left, over the viewer's shoulder.
inline constexpr glm::vec3 kKeyLight{-0.4924039f, 0.6427876f, 0.5868241f};

// Distance from the centre in radii: 1 on the rim.
float RimDistance(glm::vec2 at);

// The view-space normal at a place in the picture. Paint runs past the rim, so places outside have the normal of the
// nearest point of the rim.
glm::vec3 NormalAt(glm::vec2 at);
// The inverse, for normals that face the viewer.
glm::vec2 PlaceOf(glm::vec3 normal);

// The light that a sphere is painted for.
enum class Light {
  kKey,      // the key light in full
  kGrazing,  // the same light, weaker, more from the front and softer: half-tones
  kSky,      // without it: light of the sky from above and of the ground from below
  kCrevice,  // without the sky too: under objects and between them, where only the ground's reflection arrives
};

// The unit direction towards the light. For the sky nearly straight up, leaning to the key light's side; in a crevice
// from below, where the reflection comes from.
glm::vec3 Towards(Light light);

// The shading of a lit sphere. All in [0, 1].
struct Shading {
  float value;      // overall lightness, on one scale for every light
  float light;      // the cosine to the light: 0 … 1 over the whole sphere under the sky and in
                    // a crevice
  float highlight;  // mirror image of the light
  float reflected;  // light reflected from below right into the shade
};
Shading ShadingOf(glm::vec3 normal, Light light = Light::kKey);
inline Shading ShadingAt(glm::vec2 at, Light light = Light::kKey) { return ShadingOf(NormalAt(at), light); }
// 1 − value.
inline float DarknessAt(glm::vec2 at, Light light = Light::kKey) { return 1.0f - ShadingAt(at, light).value; }

}  // namespace scumble::paint
