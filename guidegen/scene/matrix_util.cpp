#include "guidegen/scene/matrix_util.h"

#include <cmath>

namespace scumble {

bool IsFinite(const glm::dmat4& matrix) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      if (!std::isfinite(matrix[column][row])) return false;
    }
  }
  return true;
}

std::optional<glm::dmat3> StraightenAxes(const glm::dmat4& matrix) {
  const glm::dvec3 up(matrix[1]);
  const glm::dvec3 backward(matrix[2]);
  const double up_length = glm::length(up);
  const double backward_length = glm::length(backward);
  if (!IsFinite(matrix) || !(backward_length > 0.0) || !(up_length > 0.0)) return std::nullopt;
  glm::dmat3 axes;
  axes[2] = backward / backward_length;
  const glm::dvec3 right = glm::cross(up / up_length, axes[2]);
  const double right_length = glm::length(right);
  if (!(right_length > 1e-9)) return std::nullopt;
  axes[0] = right / right_length;
  axes[1] = glm::cross(axes[2], axes[0]);
  return axes;
}

}  // namespace scumble
