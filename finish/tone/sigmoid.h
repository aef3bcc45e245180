// An odd sigmoid, for loops over many values.
#pragma once

namespace scumble::internal {

// From -1 to 1 with slope 1 at 0. It is the Padé approximant of tanh with degrees 3 and 2, which reaches 1 at 3 with
// slope 0, and stays there. Within 0.024 of tanh. No branches, and the same bits everywhere (SCUMBLE_WIDE_LOOPS).
inline float Sigmoid(float x) {
  const float within = x < -3.0f ? -3.0f : x > 3.0f ? 3.0f : x, square = within * within;
  return within * (27.0f + square) / (27.0f + 9.0f * square);
}

}  // namespace scumble::internal
