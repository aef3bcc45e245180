#include "core/image/oklab.h"

#include <bit>
#include <cmath>
#include <cstdint>

namespace scumble {
namespace {

// By Newton's method from a guess on the exponent: additions, products and quotients are the same on every processor,
// where a libm's cbrt need not be. Three steps reach float's precision.
float CubeRoot(float value) {
  const float size = std::fabs(value);
  if (!(size > 1e-30f)) return 0.0f;
  double root = std::bit_cast<float>(std::bit_cast<std::uint32_t>(size) / 3u + 0x2a5137a0u);
  for (int step = 0; step < 3; ++step) root = (2.0 * root + size / (root * root)) / 3.0;
  return std::copysign(static_cast<float>(root), value);
}

}  // namespace

glm::vec3 OklabFromLinear(glm::vec3 c) {
  const float l = CubeRoot(0.4122214708f * c.r + 0.5363325363f * c.g + 0.0514459929f * c.b);
  const float m = CubeRoot(0.2119034982f * c.r + 0.6806995451f * c.g + 0.1073969566f * c.b);
  const float s = CubeRoot(0.0883024619f * c.r + 0.2817188376f * c.g + 0.6299787005f * c.b);
  return {0.2104542553f * l + 0.7936177850f * m - 0.0040720468f * s,
          1.9779984951f * l - 2.4285922050f * m + 0.4505937099f * s,
          0.0259040371f * l + 0.7827717662f * m - 0.8086757660f * s};
}

glm::vec3 LinearFromOklab(glm::vec3 lab) {
  const float l = lab.x + 0.3963377774f * lab.y + 0.2158037573f * lab.z;
  const float m = lab.x - 0.1055613458f * lab.y - 0.0638541728f * lab.z;
  const float s = lab.x - 0.0894841775f * lab.y - 1.2914855480f * lab.z;
  const float l3 = l * l * l, m3 = m * m * m, s3 = s * s * s;
  return {4.0767416621f * l3 - 3.3077115913f * m3 + 0.2309699292f * s3,
          -1.2684380046f * l3 + 2.6097574011f * m3 - 0.3413193965f * s3,
          -0.0041960863f * l3 - 0.7034186147f * m3 + 1.7076147010f * s3};
}

}  // namespace scumble
