// What loaders and the ray caster both ask of a placing matrix.
#pragma once

#include <glm/glm.hpp>
#include <optional>

namespace scumble {

bool IsFinite(const glm::dmat4& matrix);

// Right-handed unit axes of a camera's or a light's matrix, without its scale and shear: the third is kept exactly, the
// second as far as it goes. Nothing where the matrix is not finite, or where those two are zero or parallel.
std::optional<glm::dmat3> StraightenAxes(const glm::dmat4& matrix);

}  // namespace scumble
