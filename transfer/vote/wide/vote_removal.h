// Votes of a tile that are taken back: gathered first, so that what they need from memory is asked for early.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "transfer/vote/vote.h"
#include "transfer/vote/wide/run_sums.h"
#include "transfer/vote/wide/chunk_runs.h"

namespace scumble::internal {

// Calls visit(i) for each set bit of a word and maybe visit(64), several at a time: how many bits there are cannot be
// foreseen, and a loop that ends with the last would mostly be mispredicted.
template <class Visit>
inline void ForEachBit(std::uint64_t bits, const Visit& visit) {
  while (bits) {
    for (int k = 0; k < 4; ++k, bits &= bits - 1) visit(std::countr_zero(bits));
  }
}

// Kept from tile to tile by a thread.
class WideWithdrawals {
 public:
  // A row of the tile, and where the last pixel stands that is voted for, seen from those that lack its vote.
  struct Place {
    std::int16_t row, dx, dy;
  };
  // For each pixel of the row whose bit is set: the votes of that pixel and of those before it in its row, of the same
  // chunk, down to the one since[column] columns further, are to be taken back. `since` has kTileSide + 1 values.
  void End(std::uint64_t bits, Place place, const std::int16_t* since) {
    if (!bits) return;
    const std::size_t count = std::size_t(std::popcount(bits));
    if (runs_.size() < count_ + kTileSide + 4) runs_.resize(2 * runs_.size() + kTileSide + 4);
    Run* run = runs_.data() + count_;
    ForEachBit(bits, [&](int x) {
      *run++ = {place.row, static_cast<std::int16_t>(x), place.dx, place.dy,
                static_cast<std::int32_t>(place.dx + 1 - since[x])};
    });
    count_ += count;
  }
  // Takes them back, and forgets them.
  void Apply(const VoteInput& input, const WideTile& tile, WideSums& sums);

 private:
  struct Run {
    std::int16_t row, column, dx, dy;
    std::int32_t votes;
  };
  std::vector<Run> runs_;
  std::size_t count_ = 0;
};

}  // namespace scumble::internal
