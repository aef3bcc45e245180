// core/image/color_math-inl.h for single floats.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace scumble::scalar {

using Lane = float;
using Choice = bool;
struct LaneColor {
  float r, g, b;
};

inline bool Less(float a, float b) { return a < b; }
inline bool Both(bool a, bool b) { return a && b; }
inline bool All(bool choice) { return choice; }
inline float Select(bool choice, float yes, float no) { return choice ? yes : no; }
inline float Min(float a, float b) { return a < b ? a : b; }
inline float Max(float a, float b) { return a > b ? a : b; }
inline float Sqrt(float x) { return std::sqrt(x); }
inline float BitsAsNumber(float x) { return static_cast<float>(std::bit_cast<std::int32_t>(x)); }
inline float NumberAsBits(float n) { return std::bit_cast<float>(std::bit_cast<std::uint32_t>(n) << 9); }

#include "core/image/color_math-inl.h"

// Rounds a code of 0 … 65535 to the nearest whole number, halves to the even one. The lowest bits of a sum above 2^23
// are the whole number.
inline std::uint16_t Rounded(float code) {
  return static_cast<std::uint16_t>(std::bit_cast<std::uint32_t>(code + 8388608.0f));
}

}  // namespace scumble::scalar
