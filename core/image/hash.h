// Stateless random numbers: each is a hash of its purpose. So the result does not depend on the order of work, the
// number of threads or how a sequence was cut.
#pragma once

#include <algorithm>
#include <cmath>
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

inline constexpr double kMostJitterFps = 1000.0;

// Which draw a frame has, of jitter_fps draws a second: floor(frame · jitter_fps / fps) in integers, fps = numerator /
// denominator, so equal for a frame however a range is cut. 0 for jitter_fps 0 (frozen), the frame itself for -1.
// jitter_fps is rounded to thousandths.
inline std::int64_t JitterStep(double jitter_fps, std::int64_t frame, std::int64_t fps_numerator,
                               std::int64_t fps_denominator) {
  if (jitter_fps == 0.0) return 0;
  if (jitter_fps < 0.0) return frame;
  // 128 bits: frame numbers that contain a date, times a rate in thousandths, exceed 64.
  __extension__ using Int128 = __int128;
  const Int128 numerator = static_cast<Int128>(frame) * std::llround(jitter_fps * 1000.0) * fps_denominator;
  const Int128 denominator = static_cast<Int128>(fps_numerator) * 1000;
  const Int128 quotient = numerator / denominator;
  return static_cast<std::int64_t>(numerator % denominator < 0 ? quotient - 1 : quotient);
}

}  // namespace scumble
