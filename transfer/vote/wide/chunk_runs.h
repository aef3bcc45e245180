// One tile of a picture with votes of a large radius, and the chunks in and around it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/filter/region.h"
#include "transfer/source_field.h"
#include "transfer/vote/vote.h"

namespace scumble::internal {

// A tile is one machine word wide, so that a row of it is one word of bits.
inline constexpr int kTileSide = 64;

// Up to this radius the sums of a window's votes fit.
inline constexpr int kWidestRadius = 127;

// Pixels [begin, end) of one row, all of one chunk. Columns and rows count from the tile's corner; those of the
// surroundings may be negative.
struct ChunkRun {
  std::int16_t row, begin, end;
};

// All runs in and around a tile that have one exemplar, one offset, and one reach.
struct Chunk {
  int shift_x = 0, shift_y = 0, exemplar = 0;  // texel = column and row in the tile + shift
  int reach = 0;                               // VoteReach
  std::uint32_t first = 0, count = 0;          // of WideTile::runs, from the top down
};

// One thread's memory, kept from tile to tile. O(pixels of the tile grown by the radius).
class WideTile {
 public:
  // Finds the chunks in and around `area`, at most kTileSide wide and high and inside the region of `input`. False: no
  // pixel of it is active.
  bool Read(const VoteInput& input, const Region& area);

  const Region& area() const { return area_; }
  int radius() const { return radius_; }
  int Window() const { return (2 * radius_ + 1) * (2 * radius_ + 1); }  // pixels
  const std::vector<Chunk>& chunks() const { return chunks_; }
  const std::vector<ChunkRun>& runs() const { return runs_; }

  // The active pixels of a row of the tile.
  std::uint64_t ActiveWord(int y) const {
    const int left = area_.x0 - surround_.x0, width = area_.x1 - area_.x0;
    const std::uint64_t word = WordAt(Votes(y + area_.y0 - surround_.y0), left);
    return width < 64 ? word & ((std::uint64_t{1} << width) - 1) : word;
  }
  // 64 bits from one of them on.
  static std::uint64_t WordAt(const std::uint64_t* bits, int at) {
    const std::uint64_t* word = bits + (at >> 6);
    const int shift = at & 63;
    return shift ? word[0] >> shift | word[1] << (64 - shift) : word[0];
  }

 private:
  // Bits of one row of the surroundings, the lowest its first column: pixels that vote, and pixels that begin a run or
  // follow the end of one. Two words more than the columns need, both 0.
  const std::uint64_t* Votes(int row) const { return votes_.data() + std::size_t(row) * words_; }
  const std::uint64_t* Changes(int row) const { return changes_.data() + std::size_t(row) * words_; }
  struct FoundRun {
    ChunkRun run;
    std::uint32_t chunk;
  };
  // Open addressing; an entry of an older stamp is empty.
  struct Entry {
    std::uint64_t key;
    std::uint32_t chunk, stamp;
  };

  void ReadRow(const SourceField& field, int row);
  void AddRun(const SourceField& field, int row, int begin, int end);
  std::uint32_t FindChunk(int shift_x, int shift_y, int exemplar, int reach);
  void GrowTable();

  Region area_, surround_;
  int radius_ = 0, words_ = 0;
  std::vector<Chunk> chunks_;
  std::vector<ChunkRun> runs_;
  std::vector<std::uint64_t> votes_, changes_;
  std::vector<FoundRun> found_;
  std::vector<Entry> table_;
  std::uint32_t stamp_ = 0;
};

}  // namespace scumble::internal
