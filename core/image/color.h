// sRGB encoding (IEC 61966-2-1) and Rec.709 luminance.
#pragma once

#include <cstdint>

namespace scumble {

// Encoded → linear; 1 is white, values outside [0, 1] are continued by the same formula, NaN stays NaN.
float SrgbToLinear(float encoded);

// 16-bit encoded → linear in [0, 1], from a table of 65,536 floats that is the same on
// every machine.
float Srgb16ToLinear(std::uint16_t encoded);
// Linear → 16-bit encoded, clamped to [0, 1], rounded to nearest; NaN becomes 0.
// Srgb16FromLinear(Srgb16ToLinear(v)) == v for every v.
std::uint16_t Srgb16FromLinear(float linear);

// The tables behind these, for code that asks often.
struct Srgb16Tables {
  const float* decoded;  // of each code
  // Where codes i - 1 and i meet, for i of 0 … 65537; the first is -infinity, the last two infinity.
  const float* border;

  // Srgb16FromLinear(linear), quick where `guess` is right or one off. Without branches, since that is a matter of chance.
  std::uint16_t Encode(float linear, std::uint16_t guess) const {
    const int code = guess - (linear < border[guess]) + (border[guess + 1] <= linear);
    return border[code] <= linear && linear < border[code + 1] ? static_cast<std::uint16_t>(code) : Srgb16FromLinear(linear);
  }
};
const Srgb16Tables& Srgb16();

// Luminance of linear Rec.709 RGB.
constexpr float Luminance(float r, float g, float b) { return 0.2126f * r + 0.7152f * g + 0.0722f * b; }

}  // namespace scumble
