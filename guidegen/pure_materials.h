// Materials that two renderers interpret alike.
#pragma once

#include <string>
#include <vector>

#include "guidegen/scene.h"

namespace scumble {

// Replaces every glTF metallic-roughness material by a pure one, as blender_scripts/render_guides.py does with
// Principled under `--materials pure`. Lambert where the metalness is below 0.5 or comes from a texture, else GGX
// without Fresnel, with the original base colour and roughness. Emission, normal map and alpha stay. Returns the names
// of the replaced materials that instances use, in the order of the file.
std::vector<std::string> UsePureMaterials(Scene& scene);

}  // namespace scumble
