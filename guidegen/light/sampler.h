// Random numbers for light paths: Owen-scrambled Sobol points, hashed for each pixel.
//
// Burley, "Practical Hash-based Owen Scrambling", JCGT 2020; direction numbers: Joe & Kuo 2008. Each set of four
// dimensions is a Sobol sequence of its own, shuffled and scrambled by its number (padding). The first 2^k samples of
// any set are a (0, k, 2)-net in its first two dimensions.
#pragma once

#include <array>
#include <cstdint>

namespace scumble {

// Four numbers in [0, 1).
using Quad = std::array<double, 4>;

// The samples of one pixel. Equal (seed, stream, pixel, index, set) give equal numbers on every machine. Streams
// separate purposes that must not share numbers; seeds give the same picture with different noise.
class Sampler {
 public:
  explicit Sampler(std::uint32_t pixel, std::uint32_t stream = 0, std::uint64_t seed = 0);

  Quad Draw(std::uint32_t index, std::uint32_t set) const;

 private:
  std::uint64_t key_;
};

// One coordinate of the unscrambled sequence, dimension 0 … 3, as a 32-bit fraction.
std::uint32_t Sobol(std::uint32_t index, int dimension);

}  // namespace scumble
