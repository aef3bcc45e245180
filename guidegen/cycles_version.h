// What surfaces mean in the Cycles of a version of Blender, where versions differ (docs/materials.md compares them):
//
// - Cycles 3 turns every shading normal that would reflect the eye's ray into the surface, Cycles 4 that of specular
//   lobes alone (surface/shading_normal.h).
// - A tangent normal map's strength mixes normals in Cycles 3, and scales the map's value in Cycles 4
//   (surface/normal_map.h).
// - Cycles 3 loses the light that bounces on between the facets of a rough diffuse surface, Cycles 4 gives it back
//   (surface/bsdf.h).
// - GGX's masking and shadowing are separable in Cycles 3, and correlated by height in Cycles 4 (surface/bsdf.h).
//
// Scenes without a version are shaded as by Cycles 3. Lamps say themselves what they mean (Light::spot_cosine).
#pragma once

#include <string_view>

#include "guidegen/scene.h"

namespace scumble {

// Whether that is a version from 4.0 on: "4.3.2". False for text that is no version.
bool IsCycles4(std::string_view version);

// Has all materials of the scene shaded as by that version. Returns whether any was not yet.
bool ShadeAsCycles(std::string_view version, Scene& scene);

}  // namespace scumble
