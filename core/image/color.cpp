#include "core/image/color.h"

#include "core/image/exact_math.h"
#include "core/image/scalar_lane.h"

namespace scumble {

float SrgbToLinear(float encoded) {
  if (!(encoded > 1.0f)) return scalar::LinearFromCode(encoded * scalar::kWhite);
  return static_cast<float>(Exp2(2.4 * Log2((encoded + 0.055) / 1.055)));
}

float Srgb16ToLinear(std::uint16_t encoded) { return scalar::LinearFromCode(encoded); }

std::uint16_t Srgb16FromLinear(float linear) { return scalar::Rounded(scalar::ClampedCode(linear)); }

}  // namespace scumble
