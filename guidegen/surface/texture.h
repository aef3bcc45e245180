// Values of textures, by glTF's samplers.
#pragma once

#include <glm/glm.hpp>

#include "guidegen/scene.h"
#include "scumble/picture.h"

namespace scumble {

// Linear colour and alpha, bilinear unless `use` says nearest. Coordinates that are not finite read as 0.
glm::vec4 SampleColor(const Picture& picture, const TextureUse& use, glm::vec2 uv);
// The stored values in [0, 1], not decoded: for normal maps.
glm::vec4 SampleRaw(const Picture& picture, const TextureUse& use, glm::vec2 uv);

}  // namespace scumble
