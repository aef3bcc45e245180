// sRGB encoding (IEC 61966-2-1) and Rec.709 luminance.
#pragma once

#include <cstdint>

namespace scumble {

// Encoded → linear; 1 is white, values outside [0, 1] are continued by the same formula, NaN stays NaN.
float SrgbToLinear(float encoded);

// 16-bit encoded → linear in [0, 1], from a table of 65,536 floats that is the same on
// every machine.
float Srgb16ToLinear(std::uint16_t encoded);
// That table.
const float* Srgb16Linear();
// Linear → 16-bit encoded, clamped to [0, 1], rounded to nearest; NaN becomes 0.
// Srgb16FromLinear(Srgb16ToLinear(v)) == v for every v.
std::uint16_t Srgb16FromLinear(float linear);

// The same, quicker where `guess` is right or one off.
std::uint16_t Srgb16FromLinear(float linear, std::uint16_t guess);

// Luminance of linear Rec.709 RGB.
constexpr float Luminance(float r, float g, float b) { return 0.2126f * r + 0.7152f * g + 0.0722f * b; }

}  // namespace scumble
