// Sums of the votes of a tile: of each chunk, how many of its pixels are in a pixel's window, times the chunk's texel
// there.
#pragma once

#include <hwy/aligned_allocator.h>

#include <cstdint>
#include <vector>

#include "scumble/picture.h"
#include "transfer/exemplar/prepared_exemplar.h"
#include "transfer/exemplar/usable_rows.h"
#include "transfer/vote/wide/chunk_runs.h"

namespace scumble::internal {

// A tile and where its sums go; those for opaque paint or the others.
struct Work {
  const WideTile& tile;
  const PreparedExemplar& exemplar;
  const UsableRows& usable;
  std::uint32_t* sums;
  std::uint64_t* weighted;
  std::uint32_t* votes;
};

// By row and column of the tile. Sums of at most 65535 votes fit.
class WideSums {
 public:
  static constexpr int kStride = kTileSide + 4;  // rows are written four pixels at a time

  // All votes of the tile's chunks; texels that are not usable have none.
  void Sum(const WideTile& tile, const PreparedExemplar& exemplar, const UsableRows& usable);

  // Takes `count` votes of the pixel (x, y) of the tile for `texel` back.
  void Withdraw(int x, int y, const std::uint16_t* texel, std::uint32_t count) {
    const std::size_t i = std::size_t(y) * kStride + x;
    if (!weights_count_) {
      for (int c = 0; c < 4; ++c) sums_[4 * i + c] -= count * texel[c];
      return;
    }
    const std::uint64_t weight = std::uint64_t{count} * texel[3];
    for (int c = 0; c < 3; ++c) weighted_[4 * i + c] -= weight * texel[c];
    weighted_[4 * i + 3] -= weight;
    votes_[i] -= count;
  }

  // The mean of the votes for every active pixel of the tile, straight alpha.
  void Write(const WideTile& tile, Picture& out);

 private:
  void WriteWeighted(std::uint64_t active, std::size_t first, std::uint16_t* out) const;

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
