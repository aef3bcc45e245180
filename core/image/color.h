// sRGB encoding (IEC 61966-2-1) and Rec.709 luminance.
#pragma once

#include <cstdint>

namespace scumble {

// Encoded → linear; 1 is white. The same formula continues outside [0, 1]; NaN stays NaN. Within 1.2e-6, relative, of
// the standard.
float SrgbToLinear(float encoded);

// 16-bit encoded ⇄ linear in [0, 1], by core/image/color_math-inl.h: the same bits on every machine. Decoding is within
// 1.2e-6, relative, of the standard, or 0.03 of a code. Encoding clamps and rounds to the nearest code, within 0.53 of
// the standard's; NaN becomes 0. Srgb16FromLinear(Srgb16ToLinear(v)) == v for every v.
float Srgb16ToLinear(std::uint16_t encoded);
std::uint16_t Srgb16FromLinear(float linear);

// Luminance of linear Rec.709 RGB.
constexpr float Luminance(float r, float g, float b) { return 0.2126f * r + 0.7152f * g + 0.0722f * b; }

}  // namespace scumble
