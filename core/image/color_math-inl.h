// The cube root, sRGB's curve and Oklab, for one number or for a vector of them: the definitions that all tints share.
//
// Each function is a fixed sequence of IEEE 754 sums, products, quotients and square roots of floats, without fused
// operations. A scalar and every vector instruction set therefore give the same bits.
//
// This file is text to be included inside a namespace that has
//   Lane                        a float, or a vector of floats; floats convert to it; + - * /
//   Choice                      the result of comparing Lanes, one truth value each
//   LaneColor                   {Lane r, g, b}
//   Less(a, b), Both(choice, choice), All(choice), Select(choice, yes, no), Min(a, b), Max(a, b), Sqrt(x)
//   BitsAsNumber(x)             the integer that x's bits are, as the nearest float
//   NumberAsBits(n)             the float whose bits are 512 · (n - 2^23), for whole n of 2^23 … 2^24
// core/image/scalar_lane.h has them for float, core/filter/vector_lane-inl.h for vectors.

// x^(1/3) within 1.9e-7 of the true root, relative, for 2^-126 … 3.4e38. 0 gives 0; values between 0 and 2^-126 give a
// result between 0 and 2^-42. All others are undefined.
inline Lane CubeRoot(Lane x) {
  // A float's bits are nearly its logarithm: a third of them, negated, make x^(-1/3) within 3.5 %.
  const Lane guess = NumberAsBits(BitsAsNumber(x) * (-1.0f / (3.0f * 512.0f)) + (1419900032.0f / 512.0f + 8388608.0f));
  const Lane root = x * (guess * guess);
  // (1 - off)^(-2/3), where 1 - off = x · guess³; minimax for |off| < 0.1023, error 1.5e-8.
  const Lane off = 1.0f - root * guess;
  Lane p = 0.42913750f * off + 0.45900902f;
  p = p * off + 0.49379545f;
  p = p * off + 0.55553061f;
  p = p * off + 0.66666669f;
  p = p * off + 1.0f;
  return root * p;
}

// x^(5/12), where CubeRoot is defined; within 3.3e-7, relative.
inline Lane FiveTwelfths(Lane x) {
  const Lane root = CubeRoot(x);
  return root * Sqrt(Sqrt(root));
}

// sRGB's curve (IEC 61966-2-1) in 16-bit codes: a code c from kKink on means ((c + kOffset) / kSpan)^2.4, one below it
// c / kSteepness.
constexpr float kWhite = 65535.0f;
constexpr float kOffset = 0.055f * kWhite;
constexpr float kSpan = 1.055f * kWhite;
constexpr float kKink = 0.04045f * kWhite;
constexpr float kLinearKink = 0.04045f / 12.92f;
constexpr float kSteepness = 12.92f * kWhite;

// The linear value of a code of 0 … 65535, fractions allowed, within 1.1e-6, relative, or 0.03 of a code. 0 gives 0,
// 65535 gives 1.
inline Lane LinearFromCode(Lane code) {
  // x^2.4 is x · s^2.8, where s = sqrt(x); minimax, relative error 6.2e-7.
  const Lane x = code * (1.0f / kSpan) + kOffset / kSpan, s = Sqrt(x);
  Lane p = -0.0169314202f * s + 0.088533625f;
  p = p * s - 0.236001745f;
  p = p * s + 1.06493771f;
  p = p * s + 0.109186351f;
  p = p * s - 0.0102918698f;
  p = (p * s + 0.000567316194f) * x;
  return Select(Less(code, kKink), code * (1.0f / kSteepness), p);
}

// The code of a linear value of 0 … 1, not rounded, within 0.03 of the true one.
inline Lane CodeFromLinear(Lane linear) {
  return Select(Less(linear, kLinearKink), linear * kSteepness, FiveTwelfths(linear) * kSpan - kOffset);
}

// CodeFromLinear of any linear value but NaN, clamped to 0 … 65535.
inline Lane ClampedCode(Lane linear) { return CodeFromLinear(Min(Max(linear, 0.0f), 1.0f)); }

inline LaneColor Each(Lane (*f)(Lane), LaneColor c) { return {f(c.r), f(c.g), f(c.b)}; }

inline Lane WeightedSum(float r, float g, float b, LaneColor c) { return r * c.r + g * c.g + b * c.b; }

// Oklab (Björn Ottosson 2020, https://bottosson.github.io/posts/oklab/) has three steps: linear Rec.709 to the
// responses of three cones, their cube roots, and from these to lightness L and the opponent colours a and b. The first
// and the last are matrices.
inline LaneColor ConesFromLinear(LaneColor rgb) {
  return {WeightedSum(0.4122214708f, 0.5363325363f, 0.0514459929f, rgb),
          WeightedSum(0.2119034982f, 0.6806995451f, 0.1073969566f, rgb),
          WeightedSum(0.0883024619f, 0.2817188376f, 0.6299787005f, rgb)};
}

inline Lane LightnessFromRoots(LaneColor roots) {
  return WeightedSum(0.2104542553f, 0.7936177850f, -0.0040720468f, roots);
}

inline LaneColor OklabFromRoots(LaneColor roots) {
  return {LightnessFromRoots(roots), WeightedSum(1.9779984951f, -2.4285922050f, 0.4505937099f, roots),
          WeightedSum(0.0259040371f, 0.7827717662f, -0.8086757660f, roots)};
}

inline LaneColor RootsFromOklab(LaneColor lab) {
  return {WeightedSum(1.0f, 0.3963377774f, 0.2158037573f, lab), WeightedSum(1.0f, -0.1055613458f, -0.0638541728f, lab),
          WeightedSum(1.0f, -0.0894841775f, -1.2914855480f, lab)};
}

inline LaneColor LinearFromRoots(LaneColor roots) {
  const LaneColor cones{roots.r * roots.r * roots.r, roots.g * roots.g * roots.g, roots.b * roots.b * roots.b};
  return {WeightedSum(4.0767416621f, -3.3077115913f, 0.2309699292f, cones),
          WeightedSum(-1.2684380046f, 2.6097574011f, -0.3413193965f, cones),
          WeightedSum(-0.0041960863f, -0.7034186147f, 1.7076147010f, cones)};
}
