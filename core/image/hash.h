// Stateless random numbers: each is a hash of its purpose. So the result does not depend on the order of work, the
// number of threads or how a sequence was cut.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace scumble {

// The finaliser of SplitMix64 (Steele, Lea & Flood 2014): a bijection of 64-bit integers with full avalanche.
constexpr std::uint64_t Mix64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

// Hash of any number of integers; the order of the arguments matters.
template <class... Integers>
constexpr std::uint64_t Hash(Integers... values) {
  std::uint64_t state = 0x6a09e667f3bcc908ull;
  ((state = Mix64(state ^ static_cast<std::uint64_t>(values))), ...);
  return state;
}

// Continues another hash: HashOn(Hash(a, b), c) is Hash(a, b, c).
template <class Integer>
constexpr std::uint64_t HashOn(std::uint64_t state, Integer value) {
  return Mix64(state ^ static_cast<std::uint64_t>(value));
}

// The upper 24 bits as a float in [0, 1): exact, and never rounded up to 1.
constexpr float UnitFloat(std::uint64_t hash) { return static_cast<float>(hash >> 40) * 0x1.0p-24f; }

// FNV-1a of a text, finished with Mix64.
constexpr std::uint64_t HashText(std::string_view text) {
  std::uint64_t state = 0xcbf29ce484222325ull;
  for (char c : text) state = (state ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  return Mix64(state);
}

// The hash of values as they lie in memory, eight bytes at a time, because pictures are large.
template <class T>
std::uint64_t HashBytes(std::span<const T> values) {
  const auto bytes = std::as_bytes(values);
  std::uint64_t state = bytes.size();
  for (std::size_t i = 0; i < bytes.size(); i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, std::min<std::size_t>(8, bytes.size() - i));
    state = (state ^ word) * 0x9e3779b97f4a7c15ull;
    state ^= state >> 32;
  }
  return Mix64(state);
}

}  // namespace scumble
