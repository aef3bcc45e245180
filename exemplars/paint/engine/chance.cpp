#include "exemplars/paint/engine/chance.h"

namespace scumble::paint {

NoisePlace NoisePlace::Finer(glm::vec2 factor) const {
  if (repeat.x <= 0.0f) return {at * factor};
  const glm::vec2 finer = glm::max(glm::round(repeat * factor), 1.0f);
  return {at * (finer / repeat), finer};
}

float SmoothNoise(const NoisePlace& place, std::uint64_t stream) {
  const glm::vec2 cell = glm::floor(place.at);
  const glm::vec2 t = place.at - cell;
  const glm::vec2 s = t * t * (3.0f - 2.0f * t);
  const auto corner = [&](int dx, int dy) {
    glm::vec2 at = cell + glm::vec2(dx, dy);
    if (place.repeat.x > 0.0f) at = glm::mod(at, place.repeat);
    return UnitFloat(Hash(stream, static_cast<std::int64_t>(at.x), static_cast<std::int64_t>(at.y)));
  };
  return glm::mix(glm::mix(corner(0, 0), corner(1, 0), s.x), glm::mix(corner(0, 1), corner(1, 1), s.x), s.y);
}

float CloudNoise(const NoisePlace& place, int octaves, std::uint64_t stream) {
  NoisePlace octave_place = place;
  float sum = 0.0f;
  float total = 0.0f;
  float weight = 1.0f;
  for (int octave = 0; octave < octaves; ++octave) {
    sum += weight * SmoothNoise(octave_place, Hash(stream, octave));
    total += weight;
    weight *= 0.5f;
    // Not quite a factor of two, so that the octaves' grids do not line up.
    octave_place = octave_place.Finer(glm::vec2(2.03f));
    octave_place.at += 17.31f;
  }
  return sum / total;
}

}  // namespace scumble::paint
