// The hyperbolic tangent, for loops over many values.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/image/exact_math.h"

namespace scumble::internal {

// 2^-x within 3e-7, relative; beyond 100 as at 100. x is 0 or more.
inline float PowerOfHalf(float x) {
  const float y = x < 100.0f ? -x : -100.0f;
  const int whole = static_cast<int>(y - 0.5f);
  const float f = y - static_cast<float>(whole);  // within a half of 0: the series of 2^f
  float p = 1.5403530e-4f * f + 1.3333558e-3f;
  p = p * f + 9.6181291e-3f;
  p = p * f + 5.5504109e-2f;
  p = p * f + 2.4022651e-1f;
  p = p * f + 6.9314718e-1f;
  p = p * f + 1.0f;
  return p * std::bit_cast<float>(static_cast<std::uint32_t>(whole + 127) << 23);
}

// tanh x within 3e-7. For loops that SCUMBLE_WIDE_LOOPS compiles: no branches, the same bits everywhere.
inline float FastTanh(float x) {
  const float e = PowerOfHalf(std::fabs(x) * float(2.0 * kLog2OfE)), t = (1.0f - e) / (1.0f + e);
  return x < 0.0f ? -t : t;
}

}  // namespace scumble::internal
