#include "core/image/exact_math.h"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>

namespace scumble {

namespace {

// The series of sine and cosine, exact to the last bits of a double for angles up to a quarter of π.
double Series(double angle, double first, int next) {
  double term = first, sum = 0.0;
  for (int n = next; n < next + 16; n += 2) sum += term *= -angle * angle / (n * (n + 1));
  return first + sum;
}

}  // namespace

double SinPi(double x) {
  x -= 2.0 * std::floor(0.5 * x + 0.5);  // [-1, 1)
  if (x > 0.5)
    x = 1.0 - x;
  else if (x < -0.5)
    x = -1.0 - x;  // [-1/2, 1/2]
  if (!(std::fabs(x) > 0.25)) return Series(std::numbers::pi * x, std::numbers::pi * x, 2);
  return std::copysign(Series(std::numbers::pi * (0.5 - std::fabs(x)), 1.0, 1), x);
}

// Reduced before the quarter turn is added, which would round a large x.
double CosPi(double x) { return SinPi(std::fmod(x, 2.0) + 0.5); }

double SinDegrees(double degrees) { return SinPi(degrees / 180.0); }

double CosDegrees(double degrees) { return CosPi(degrees / 180.0); }

// 2^x = 2^n · e^(f ln 2) with n whole and |f| at most a half.
double Exp2(double x) {
  if (std::isnan(x)) return x;
  if (x > 1100.0) return std::numeric_limits<double>::infinity();
  if (x < -1200.0) return 0.0;
  const double whole = std::floor(x + 0.5), power = (x - whole) * std::numbers::ln2;
  double term = 1.0, sum = 0.0;
  for (int n = 1; n <= 16; ++n) sum += term *= power / n;
  return std::ldexp(1.0 + sum, static_cast<int>(whole));
}

// x = 2^n · m with m around 1; ln m = 2 (t + t³/3 + t⁵/5 + …) with t = (m - 1) / (m + 1).
double Log2(double x) {
  if (std::isnan(x) || x < 0.0) return std::numeric_limits<double>::quiet_NaN();
  if (x == 0.0) return -std::numeric_limits<double>::infinity();
  if (std::isinf(x)) return x;
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);  // [1/2, 1)
  if (mantissa < std::numbers::sqrt2 / 2.0) mantissa *= 2.0, --exponent;
  const double t = (mantissa - 1.0) / (mantissa + 1.0), square = t * t;
  double power = t, sum = 0.0;
  for (int n = 3; n <= 27; n += 2) sum += (power *= square) / n;
  return exponent + 2.0 * (t + sum) / std::numbers::ln2;
}

double RoundToDigits(double x, int digits) {
  const double size = std::fabs(x);
  if (!(size > 1e-280 && size < 1e280)) return x;
  const auto power_of_ten = [](int n) {  // exact up to 10^22
    double power = 1.0;
    for (; n > 0; --n) power *= 10.0;
    return power;
  };
  int exponent = 0;
  while (size >= power_of_ten(exponent + 1)) ++exponent;
  while (size * power_of_ten(-exponent) < 1.0) --exponent;
  const int places = digits - 1 - exponent;  // that are kept after the point
  const double scale = power_of_ten(std::abs(places)), scaled = places < 0 ? size / scale : size * scale;
  // What the rounding of `scaled` took away decides at a half.
  const double rest = places < 0 ? std::fma(-scaled, scale, size) : std::fma(size, scale, -scaled);
  double whole = std::floor(scaled);
  const double part = scaled - whole;
  if (part > 0.5 || (part == 0.5 && (rest > 0.0 || (rest == 0.0 && std::fmod(whole, 2.0) == 1.0)))) whole += 1.0;
  return std::copysign(places < 0 ? whole * scale : whole / scale, x);
}

}  // namespace scumble
