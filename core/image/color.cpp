#include "core/image/color.h"

#include <algorithm>
#include <bit>
#include <limits>
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

// Encoding starts from a guess: the upper bits of a float, of its exponent and the first of its mantissa, say which of
// kBins it is in; a bin holds at most 200 codes, nearly evenly spread.
constexpr int kBinShift = 16;                       // 128 bins an octave
constexpr std::uint32_t kFirstBin = 0x35000000u >> kBinShift;  // of 2^-21, below where code 1 begins
constexpr std::uint32_t kBins = (0x3f800000u >> kBinShift) - kFirstBin;

// decoded[i] is what code i means; border[i] is where codes i - 1 and i meet; what is beyond the first
// and the last is theirs.
struct Tables {
  std::vector<float> decoded = std::vector<float>(kCodes);
  std::vector<float> border = std::vector<float>(kCodes + 2, std::numeric_limits<float>::infinity());
  std::vector<std::uint16_t> bin = std::vector<std::uint16_t>(kBins + 1);  // the code of each bin's first float
  Tables() {
    for (int i = 0; i < kCodes; ++i) {
      decoded[i] = static_cast<float>(Decode(i / 65535.0));
      border[i] = i == 0 ? -border[kCodes] : static_cast<float>(Decode((i - 0.5) / 65535.0));
    }
    int code = 0;
    for (std::uint32_t b = 0; b <= kBins; ++b) {
      const float first = std::bit_cast<float>((kFirstBin + b) << kBinShift);
      while (code + 1 < kCodes && border[code + 1] <= first) ++code;
      bin[b] = static_cast<std::uint16_t>(code);
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
  if (linear >= 1.0f) return kCodes - 1;
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(linear), bin = (bits >> kBinShift) - kFirstBin;
  if (bin >= kBins) return 0;  // below the first, by wrapping
  const Tables& tables = SrgbTables();
  const std::uint32_t first = tables.bin[bin], codes = tables.bin[bin + 1] - first;
  std::uint32_t code = first + (codes * (bits & ((1u << kBinShift) - 1)) >> kBinShift);
  while (tables.border[code] > linear) --code;
  while (code + 1 < kCodes && tables.border[code + 1] <= linear) ++code;
  return static_cast<std::uint16_t>(code);
}

const Srgb16Tables& Srgb16() {
  static const Srgb16Tables tables{SrgbTables().decoded.data(), SrgbTables().border.data()};
  return tables;
}

}  // namespace scumble
