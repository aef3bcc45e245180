// Sines, cosines and powers of two with the same bits on every machine: additions, products and quotients of doubles in
// a fixed order. A libm's results differ from one processor or release to the next. Used wherever the result decides on
// pictures. Functions that IEEE 754 defines exactly (sqrt, floor, fmod, ldexp) need no counterpart here.
#pragma once

namespace scumble {

// sin(π x) and cos(π x), within 4e-16 of the true value for |x| up to 1e6, whole and half numbers exact. NaN and
// infinity give NaN.
double SinPi(double x);
double CosPi(double x);

// SinPi and CosPi of an angle in degrees. Multiples of 90 are exact.
double SinDegrees(double degrees);
double CosDegrees(double degrees);

// 2^x within 4e-16 of the true value, relative, where the result is a normal number; whole x exact. Overflows to
// infinity, underflows to 0; NaN gives NaN.
double Exp2(double x);

// log2(x) within 4e-16 of the true value, relative to the larger of it and 1/64; powers of two exact. 0 gives
// -infinity, negative numbers and NaN give NaN.
double Log2(double x);

// The number nearest to x that has so many significant decimal digits, 1 … 15; ties as printf has them. From 1e-7 to
// 1e22 it is the very double of that decimal, as strtod gives it; others, down to 1e-280 and up to 1e280, are within
// 1e-14 of it, relative. Beyond these x stays.
double RoundToDigits(double x, int digits);

// e^x is Exp2(x * kLog2OfE).
inline constexpr double kLog2OfE = 1.4426950408889634;

}  // namespace scumble
