#include "core/io/exr/half_float.h"

#include <algorithm>
#include <cmath>

namespace scumble::internal {

Imath::half ToHalf(float value) {
  constexpr float kLargest = 65504.0f;
  return std::isfinite(value) ? Imath::half(std::clamp(value, -kLargest, kLargest)) : Imath::half(value);
}

}  // namespace scumble::internal
