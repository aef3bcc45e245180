#include "image/color.h"

#include <cmath>
#include <vector>

namespace scumble {
namespace {

// The formulas run in double, so that the tables below do not depend on a libm's last bit.
double Decode(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }
double Encode(double v) { return v <= 0.0031308 ? v * 12.92 : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055; }

const std::vector<float>& DecodeTable() {
  static const std::vector<float> table = [] {
    std::vector<float> values(65536);
    for (int i = 0; i < 65536; ++i) values[i] = static_cast<float>(Decode(i / 65535.0));
    return values;
  }();
  return table;
}

}  // namespace

float SrgbToLinear(float encoded) { return static_cast<float>(Decode(encoded)); }
float LinearToSrgb(float linear) { return static_cast<float>(Encode(linear)); }

float Srgb16ToLinear(std::uint16_t encoded) { return DecodeTable()[encoded]; }

std::uint16_t Srgb16FromLinear(float linear) {
  if (!(linear > 0.0f)) return 0;
  if (linear >= 1.0f) return 65535;
  return static_cast<std::uint16_t>(std::floor(Encode(linear) * 65535.0 + 0.5));
}

}  // namespace scumble
