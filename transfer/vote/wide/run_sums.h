// Sums of the votes of a tile. For each chunk: the number of its pixels in a pixel's support region (or, for plain
// voting, in its window) and within the chunk's reach, times the chunk's texel there.
//
// In a chunk the texel moves along with the pixel, so all of a chunk's votes on a pixel are for one texel. They are
// counted as in Zhang, Lu, Lafruit (2009): along rows the pixels of the chunk on each horizontal arm, then sums of
// these down each column. A vertical arm takes the difference of two such sums.
#pragma once

#include <hwy/aligned_allocator.h>

#include <cstdint>
#include <vector>

#include "scumble/picture.h"
#include "transfer/exemplar/usable_rows.h"
#include "transfer/prepared_exemplar.h"
#include "transfer/vote/wide/chunk_runs.h"
#include "transfer/vote/wide/wide_arms.h"

namespace scumble::internal {

// A tile and its sums; those for opaque paint or the others.
struct Work {
  const WideTile& tile;
  const WideArms& arms;
  const PreparedExemplar& exemplar;
  const UsableRows& usable;
  std::uint16_t* counted;  // see WideSums
  std::uint32_t* sums;
  std::uint64_t* weighted;
  std::uint32_t* votes;
};

// By row and column of the tile. Sums of at most 65535 votes fit.
class WideSums {
 public:
  static constexpr int kStride = kTileSide + 4;  // rows are written four pixels at a time

  // Counts of a row, with one more vector on either side; and of all rows that a chunk may have.
  static constexpr int kCountedStride = kTileSide + 64;
  static std::size_t CountedSize(int radius) {
    return std::size_t(kCountedStride) * std::size_t(kTileSide + 2 * radius + 2) + 64;
  }

  // All votes of the tile's chunks; unusable texels have none.
  void Sum(const WideTile& tile, const WideArms& arms, const PreparedExemplar& exemplar, const UsableRows& usable);

  // The mean of the votes for every active pixel of the tile, straight alpha.
  void Write(const WideTile& tile, Picture& out);

 private:
  void WriteWeighted(std::uint64_t active, std::size_t first, std::uint16_t* out) const;

  // By row of a chunk, the number of its pixels so far on the columns' horizontal arms; see PrefixRows.
  std::vector<std::uint16_t> counted_;
  // Where all texels are opaque: Σ count · texel in four channels, of which alpha is 65535 times the votes.
  hwy::AlignedFreeUniquePtr<std::uint32_t[]> sums_;
  // Where they are not: Σ count · alpha · colour, and Σ count · alpha; Σ count.
  std::vector<std::uint64_t> weighted_;
  std::vector<std::uint32_t> votes_;
  bool weights_count_ = false;
  bool opaque_ = true;            // all texels of the last tile
  std::vector<double> inverses_;  // 1 / (2 n)
};

}  // namespace scumble::internal
