#include "image/color.h"

#include <algorithm>
#include <vector>

namespace scumble {
namespace {

// v^(1/5) for v > 0, by Newton's method from above: additions, products and quotients are the same on every
// processor, where a libm's pow is not.
double FifthRoot(double v) {
  double root = std::max(1.0, v);
  for (;;) {
    const double square = root * root;
    const double next = root - (square * square * root - v) / (5.0 * square * square);
    if (!(next < root)) return root;
    root = next;
  }
}

// x^2.4 = x² · (x²)^(1/5)
double Power24(double x) { return x * x * FifthRoot(x * x); }

// IEC 61966-2-1.
double Decode(double v) { return v <= 0.04045 ? v / 12.92 : Power24((v + 0.055) / 1.055); }

constexpr int kCodes = 65536;

// decoded[i] is what code i means; border[i] is where codes i - 1 and i meet.
struct Tables {
  std::vector<float> decoded = std::vector<float>(kCodes);
  std::vector<float> border = std::vector<float>(kCodes);
  Tables() {
    for (int i = 0; i < kCodes; ++i) {
      decoded[i] = static_cast<float>(Decode(i / 65535.0));
      border[i] = i == 0 ? 0.0f : static_cast<float>(Decode((i - 0.5) / 65535.0));
    }
  }
};

const Tables& SrgbTables() {
  static const Tables tables;
  return tables;
}

}  // namespace

float SrgbToLinear(float encoded) { return static_cast<float>(Decode(encoded)); }

float Srgb16ToLinear(std::uint16_t encoded) { return SrgbTables().decoded[encoded]; }

std::uint16_t Srgb16FromLinear(float linear) {
  if (!(linear > 0.0f)) return 0;
  const std::vector<float>& border = SrgbTables().border;
  return static_cast<std::uint16_t>(std::upper_bound(border.begin(), border.end(), linear) - border.begin() - 1);
}

}  // namespace scumble
