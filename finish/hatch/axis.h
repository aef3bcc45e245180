// Directions of strokes in the picture, and the distances between them.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>

#include "core/image/exact_math.h"
#include "finish/finish.h"

namespace scumble::internal {

inline constexpr int kMostLayers = 4;

// A direction of strokes: a unit vector along them. Its sign does not matter.
using Axis = glm::vec2;

inline Axis AxisAt(double degrees) {
  // Rows count downwards.
  return {static_cast<float>(CosDegrees(degrees)), static_cast<float>(-SinDegrees(degrees))};
}

// The axis turned by the angle of that cosine and sine.
inline Axis Turned(Axis axis, glm::vec2 by) { return {axis.x * by.x - axis.y * by.y, axis.x * by.y + axis.y * by.x}; }

// In pixels.
inline float SpacingOf(const HatchPass& pass, const FinishFrame& frame) {
  return static_cast<float>(std::max(1.0, pass.spacing * frame.scale));
}

// Layers of one spacing would meet in a pattern.
inline float WiderBy(int layer) { return 1.0f + 0.137f * static_cast<float>(layer); }

}  // namespace scumble::internal
