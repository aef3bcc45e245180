// Numbers that many tests need.
#pragma once

#include <limits>
#include <numbers>

namespace scumble {

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();
inline constexpr float kDenormal = std::numeric_limits<float>::denorm_min();
inline constexpr double kFloatRounding = 0x1.0p-24;  // the largest relative error of a rounding to float
inline constexpr double kPi = std::numbers::pi;

}  // namespace scumble
