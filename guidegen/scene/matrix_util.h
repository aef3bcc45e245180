// Checks of placing matrices, for loaders and the ray caster.
#pragma once

#include <glm/glm.hpp>
#include <optional>

namespace scumble {

bool IsFinite(const glm::dmat4& matrix);

// Right-handed unit axes of a camera's or a light's matrix, without its scale and shear: the third axis stays exactly,
// the second as far as possible. Empty where the matrix is not finite, or where those two are zero or parallel.
std::optional<glm::dmat3> StraightenAxes(const glm::dmat4& matrix);

}  // namespace scumble
