#include "exemplars/paint/chance.h"

namespace scumble::paint {

float SmoothNoise(glm::vec2 at, std::uint64_t stream) {
  const glm::vec2 cell = glm::floor(at);
  const glm::vec2 t = at - cell;
  const glm::vec2 s = t * t * (3.0f - 2.0f * t);
  const auto corner = [&](int dx, int dy) {
    return UnitFloat(Hash(stream, static_cast<std::int64_t>(cell.x) + dx, static_cast<std::int64_t>(cell.y) + dy));
  };
  return glm::mix(glm::mix(corner(0, 0), corner(1, 0), s.x), glm::mix(corner(0, 1), corner(1, 1), s.x), s.y);
}

float CloudNoise(glm::vec2 at, int octaves, std::uint64_t stream) {
  float sum = 0.0f;
  float total = 0.0f;
  float weight = 1.0f;
  for (int octave = 0; octave < octaves; ++octave) {
    sum += weight * SmoothNoise(at, Hash(stream, octave));
    total += weight;
    weight *= 0.5f;
    // Not quite a factor of two, so that the octaves' grids do not line up.
    at = at * 2.03f + 17.31f;
  }
  return sum / total;
}

}  // namespace scumble::paint
