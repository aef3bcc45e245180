#include "guidegen/light/sampler.h"

#include "core/image/hash.h"

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

constexpr std::uint32_t ReverseBits(std::uint32_t x) {
  x = (x >> 16) | (x << 16);
  x = ((x & 0xFF00FF00u) >> 8) | ((x & 0x00FF00FFu) << 8);
  x = ((x & 0xF0F0F0F0u) >> 4) | ((x & 0x0F0F0F0Fu) << 4);
  x = ((x & 0xCCCCCCCCu) >> 2) | ((x & 0x33333333u) << 2);
  return ((x & 0xAAAAAAAAu) >> 1) | ((x & 0x55555555u) << 1);
}

// All four coordinates, bit-reversed, by the bytes of the bit-reversed index. Between two scrambles no reversal is
// needed, and a point takes four look-ups instead of 128 tests of a bit.
using ReversedPoint = std::array<std::uint32_t, 4>;
using ByteTables = std::array<std::array<ReversedPoint, 256>, 4>;

constexpr ByteTables MakeByteTables() {
  const Directions directions = MakeDirections();
  ByteTables tables{};
  for (int byte = 0; byte < 4; ++byte) {
    for (int value = 1; value < 256; ++value) {
      const int lowest = value & -value;
      ReversedPoint& point = tables[byte][value];
      point = tables[byte][value ^ lowest];
      int bit = 31 - 8 * byte;
      for (int v = lowest; v > 1; v >>= 1) --bit;
      for (int dimension = 0; dimension < 4; ++dimension) point[dimension] ^= ReverseBits(directions[dimension][bit]);
    }
  }
  return tables;
}

constexpr ByteTables kByteTables = MakeByteTables();

ReversedPoint ReversedSobol(std::uint32_t reversed_index) {
  ReversedPoint point{};
  for (int byte = 0; byte < 4; ++byte) {
    const ReversedPoint& part = kByteTables[std::size_t(byte)][reversed_index >> (8 * byte) & 0xFFu];
    for (int dimension = 0; dimension < 4; ++dimension) point[std::size_t(dimension)] ^= part[std::size_t(dimension)];
  }
  return point;
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

}  // namespace

std::uint32_t Sobol(std::uint32_t index, int dimension) {
  return ReverseBits(ReversedSobol(ReverseBits(index))[std::size_t(dimension)]);
}

Sampler::Sampler(std::uint32_t pixel, std::uint32_t stream, std::uint64_t seed)
    : key_(seed == 0 ? Hash(stream, pixel) : Hash(stream, pixel, seed)) {}

Quad Sampler::Draw(std::uint32_t index, std::uint32_t set) const {
  const std::uint64_t key = Mix64(key_ ^ Mix64(set));
  const std::uint64_t first = Mix64(key);
  const std::uint64_t second = Mix64(first);
  const std::array<std::uint32_t, 4> seeds = {std::uint32_t(first), std::uint32_t(first >> 32), std::uint32_t(second),
                                              std::uint32_t(second >> 32)};
  const ReversedPoint point = ReversedSobol(LaineKarras(ReverseBits(index), std::uint32_t(key)));
  Quad quad;
  for (std::size_t i = 0; i < 4; ++i) quad[i] = ReverseBits(LaineKarras(point[i], seeds[i])) * 0x1.0p-32;
  return quad;
}

}  // namespace scumble
