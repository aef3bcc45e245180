// Repeatable random numbers and smooth noise for a hand's irregularity.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "core/image/hash.h"

namespace scumble::paint {

// A stream of random numbers, each a hash of (seed, stream, count): the same on every machine. Each pass of a picture
// has its own stream, so that no pass changes the numbers of the next.
class Chance {
 public:
  Chance(std::uint64_t seed, std::uint64_t stream) : key_(Hash(seed, stream)) {}

  float Uniform(float low = 0.0f, float high = 1.0f) { return low + (high - low) * UnitFloat(Hash(key_, count_++)); }
  // Bell-shaped with the given standard deviation, never beyond 3.5 of them: the sum of four uniform numbers.
  float Bell(float deviation = 1.0f) {
    float sum = Uniform();
    for (int i = 0; i < 3; ++i) sum += Uniform();
    return (sum - 2.0f) * 1.7320508f * deviation;
  }
  glm::vec3 Bell3(float deviation) {
    const float x = Bell(deviation);
    const float y = Bell(deviation);
    return {x, y, Bell(deviation)};
  }
  // A key for noise or for another stream.
  std::uint64_t Draw() { return Hash(key_, count_++); }
  bool Happens(float probability) { return Uniform() < probability; }
  // A whole number in [low, high].
  int Whole(int low, int high) {
    return low + static_cast<int>(Hash(key_, count_++) % static_cast<std::uint64_t>(high - low + 1));
  }

 private:
  std::uint64_t key_;
  std::uint64_t count_ = 0;
};

// A place in a field of noise, counted in features. On a tile the field repeats after a whole number of them.
struct NoisePlace {
  glm::vec2 at;
  glm::vec2 repeat{0.0f};  // 0: never

  // The same place where features are smaller by that factor; on a tile, approximately.
  NoisePlace Finer(glm::vec2 factor) const;
};

// Value noise in [0, 1] with features of about one unit.
float SmoothNoise(const NoisePlace& place, std::uint64_t stream);
inline float SmoothNoise(glm::vec2 at, std::uint64_t stream) { return SmoothNoise(NoisePlace{at}, stream); }
// Octaves of it, each half as strong and twice as fine; in [0, 1].
float CloudNoise(const NoisePlace& place, int octaves, std::uint64_t stream);
inline float CloudNoise(glm::vec2 at, int octaves, std::uint64_t stream) {
  return CloudNoise(NoisePlace{at}, octaves, stream);
}

// 0 below `from`, 1 above `to`, smooth between; falls instead when from > to.
inline float Ramp(float from, float to, float x) {
  const float t = glm::clamp((x - from) / (to - from), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

}  // namespace scumble::paint
