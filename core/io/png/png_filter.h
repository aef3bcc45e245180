// PNG's filters (PNG specification, third edition, section 9): the bytes that a file holds in place of a row's own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace scumble::internal {

inline constexpr std::uint8_t kNoFilter = 0, kPaeth = 4;

// Paeth's filter of a row: each byte less the one to its left, above it or above that one, whichever is nearest to
// left + above − upper left. `above` is all 0 for the first row. `pixel` bytes make a pixel. No two of the three
// overlap.
inline void FilterPaeth(const std::uint8_t* row, const std::uint8_t* above, std::size_t bytes, std::size_t pixel,
                        std::uint8_t* out) {
  const auto nearest = [](int a, int b, int c) {
    const int to_a = std::abs(b - c), to_b = std::abs(a - c), to_c = std::abs(a + b - 2 * c);
    return to_a <= to_b && to_a <= to_c ? a : to_b <= to_c ? b : c;
  };
  for (std::size_t i = 0; i < pixel && i < bytes; ++i) out[i] = static_cast<std::uint8_t>(row[i] - above[i]);
  for (std::size_t i = pixel; i < bytes; ++i) {
    out[i] = static_cast<std::uint8_t>(row[i] - nearest(row[i - pixel], above[i], above[i - pixel]));
  }
}

}  // namespace scumble::internal
