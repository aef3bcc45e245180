// Oklab (Björn Ottosson, 2020): lightness L, 0 black to 1 white, and the opponent colours a and b, so that equal steps
// look equal. https://bottosson.github.io/posts/oklab/
#pragma once

#include <glm/glm.hpp>

namespace scumble {

// Linear Rec.709 ⇄ (L, a, b). Any finite colour; arithmetic is the same on every machine.
glm::vec3 OklabFromLinear(glm::vec3 rgb);
glm::vec3 LinearFromOklab(glm::vec3 lab);

}  // namespace scumble
