#include "finish/area/noise.h"

#include <cmath>

#include "core/image/hash.h"

namespace scumble::internal {

float Noise(std::uint64_t seed, glm::vec2 at) {
  const float floor_x = std::floor(at.x), floor_y = std::floor(at.y);
  const auto x = static_cast<std::int64_t>(floor_x), y = static_cast<std::int64_t>(floor_y);
  const float u = at.x - floor_x, v = at.y - floor_y;
  const float su = u * u * (3.0f - 2.0f * u), sv = v * v * (3.0f - 2.0f * v);
  const auto value = [&](std::int64_t dx, std::int64_t dy) {
    return 2.0f * UnitFloat(Hash(seed, x + dx, y + dy)) - 1.0f;
  };
  const float above = value(0, 0) + (value(1, 0) - value(0, 0)) * su;
  const float below = value(0, 1) + (value(1, 1) - value(0, 1)) * su;
  return above + (below - above) * sv;
}

}  // namespace scumble::internal
