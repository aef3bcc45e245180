#include "guidegen/sampler.h"

#include "image/hash.h"

namespace scumble {
namespace {

// Joe and Kuo's first dimensions: degree s, coefficients a, initial numbers m. The first one is van der Corput's.
struct Primitive {
  int degree;
  unsigned coefficients;
  std::array<std::uint32_t, 3> initial;
};
constexpr std::array<Primitive, 3> kPrimitives = {{{1, 0, {1, 0, 0}}, {2, 1, {1, 3, 0}}, {3, 1, {1, 3, 1}}}};

using Directions = std::array<std::array<std::uint32_t, 32>, 4>;

constexpr Directions MakeDirections() {
  Directions all{};
  for (int bit = 0; bit < 32; ++bit) all[0][bit] = 1u << (31 - bit);
  for (int dimension = 1; dimension < 4; ++dimension) {
    const Primitive& primitive = kPrimitives[dimension - 1];
    const int s = primitive.degree;
    auto& v = all[dimension];
    for (int bit = 0; bit < 32; ++bit) {
      if (bit < s) {
        v[bit] = primitive.initial[bit] << (31 - bit);
        continue;
      }
      v[bit] = v[bit - s] ^ (v[bit - s] >> s);
      for (int k = 1; k < s; ++k) {
        if ((primitive.coefficients >> (s - 1 - k) & 1) != 0) v[bit] ^= v[bit - k];
      }
    }
  }
  return all;
}

constexpr Directions kDirections = MakeDirections();

constexpr std::uint32_t ReverseBits(std::uint32_t x) {
  x = (x >> 16) | (x << 16);
  x = ((x & 0xFF00FF00u) >> 8) | ((x & 0x00FF00FFu) << 8);
  x = ((x & 0xF0F0F0F0u) >> 4) | ((x & 0x0F0F0F0Fu) << 4);
  x = ((x & 0xCCCCCCCCu) >> 2) | ((x & 0x33333333u) << 2);
  return ((x & 0xAAAAAAAAu) >> 1) | ((x & 0x55555555u) << 1);
}

// A hash in which no bit depends on higher ones; between two reversals it is a nested uniform scramble.
constexpr std::uint32_t LaineKarras(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3D20ADEAu;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526C56u;
  x ^= x * 0x53A22864u;
  return x;
}

constexpr std::uint32_t OwenScramble(std::uint32_t x, std::uint32_t seed) {
  return ReverseBits(LaineKarras(ReverseBits(x), seed));
}

}  // namespace

std::uint32_t Sobol(std::uint32_t index, int dimension) {
  std::uint32_t x = 0;
  for (int bit = 0; index != 0; index >>= 1, ++bit) {
    if ((index & 1u) != 0) x ^= kDirections[std::size_t(dimension)][std::size_t(bit)];
  }
  return x;
}

Sampler::Sampler(std::uint32_t pixel, std::uint32_t seed) : key_(Hash(seed, pixel)) {}

Quad Sampler::Draw(std::uint32_t index, std::uint32_t set) const {
  const std::uint32_t key = std::uint32_t(Hash(key_, set));
  const std::uint32_t shuffled = OwenScramble(index, key);
  Quad quad;
  for (int dimension = 0; dimension < 4; ++dimension) {
    const std::uint32_t seed = std::uint32_t(Hash(key, dimension));
    quad[std::size_t(dimension)] = OwenScramble(Sobol(shuffled, dimension), seed) * 0x1.0p-32;
  }
  return quad;
}

}  // namespace scumble
