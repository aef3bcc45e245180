// Bitmask rows, one bit a pixel: one operation reads 64 pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace scumble::internal {

// The rows and words of a mask; both may reach beyond the picture.
struct MaskedTile {
  int first_row = 0, rows = 0;
  int first_word = 0, words = 0;
};

// The bits of rows [first_row, first_row + rows) and of `words` words from `first_word` on, which may be -1: bit i of
// word w is column 64·w + i of the picture. One more word on either side gives every word neighbours.
class BitMaskRows {
 public:
  static constexpr std::uint64_t kAll = ~std::uint64_t{0};

  // Sets every bit to `fill`, 0 or kAll.
  void Reset(int first_row, int rows, int first_word, int words, std::uint64_t fill) {
    first_row_ = first_row, first_word_ = first_word - 1, stride_ = words + 2;
    bits_.assign(std::size_t(rows) * stride_, fill);
  }
  void Reset(const MaskedTile& tile, std::uint64_t fill) {
    Reset(tile.first_row, tile.rows, tile.first_word, tile.words, fill);
  }
  // Words from `first_word` on.
  std::uint64_t* Row(int row) { return bits_.data() + Offset(row) + 1; }
  const std::uint64_t* Row(int row) const { return bits_.data() + Offset(row) + 1; }
  std::uint64_t& At(int row, int word) { return bits_[Offset(row) + (word - first_word_)]; }
  std::uint64_t At(int row, int word) const { return bits_[Offset(row) + (word - first_word_)]; }
  // Bit i: the bit of column 64·word + i + dx, |dx| < 64.
  std::uint64_t Shifted(int row, int word, int dx) const {
    const std::uint64_t* at = bits_.data() + Offset(row) + (word - first_word_);
    if (dx == 0) return *at;
    return dx > 0 ? at[0] >> dx | at[1] << (64 - dx) : at[0] << -dx | at[-1] >> (64 + dx);
  }
  // Bit i: the bit of column `column` + i. The columns must be within the words, and one word more on either side.
  std::uint64_t From(int row, int column) const { return Shifted(row, column >> 6, column & 63); }

 private:
  std::size_t Offset(int row) const { return std::size_t(row - first_row_) * stride_; }
  int first_row_ = 0, first_word_ = 0;
  std::size_t stride_ = 0;
  std::vector<std::uint64_t> bits_;
};

// Bits [begin, end) of a word, clamped to it.
inline std::uint64_t BitRange(int begin, int end) {
  const auto below = [](int i) { return i <= 0 ? 0 : i >= 64 ? BitMaskRows::kAll : (std::uint64_t{1} << i) - 1; };
  return below(end) & ~below(begin);
}

}  // namespace scumble::internal
