// Which votes do not count because an edge stands between: found for 64 × 8 pixels at a time, and taken back.
#pragma once

#include <cstdint>
#include <vector>

#include "transfer/vote/vote.h"
#include "transfer/vote/wide/cell_bounds.h"
#include "transfer/vote/wide/run_sums.h"
#include "transfer/vote/wide/guide_tile.h"
#include "transfer/vote/wide/chunk_runs.h"
#include "transfer/vote/wide/vote_removal.h"

namespace scumble::internal {

// The ways of JoinedWindow for one radius, nearest pixels first.
class WideWays {
 public:
  explicit WideWays(int radius);

  struct Way {
    std::int16_t dx, dy;
    std::uint32_t self, before;         // in a window's rows: the pixel, and the one before it on the way
    std::int16_t holder_dx, holder_dy;  // whose forward step the last one is
    std::uint8_t step;                  // right, down left, down, down right
  };
  int radius() const { return radius_; }
  const std::vector<Way>& ways() const { return ways_; }

 private:
  int radius_;
  std::vector<Way> ways_;
};

// Eight rows of a tile, the first a multiple of eight.
struct JoinedRows {
  const WideSurface& surface;
  const EdgeLimits& limits;
  const BitPlane& votes;
  int first;
  std::uint64_t active[8];
  // By pixel of the window and row: which pixels are reached by steps; null: all.
  const std::uint64_t* reached;
  // By the upper or lower cells of these rows, and by row and column of the cells that are looked at, counted from the
  // own: the pixels that may fail, by depth and by facing. From -reach to reach; null: none.
  const std::uint64_t* unsure;
  const std::uint8_t* doubtful;  // by row and column of cells: whether any pixel may
  int reach;
};

// Kept from tile to tile by a thread.
class WideJoined {
 public:
  // Takes the votes of all pixels that are not joined to the one they vote for back from `sums`, which holds all votes
  // of the tile. The definition is JoinedWindow's, to the bit.
  void Withdraw(const VoteInput& input, const WideWays& ways, const WideTile& tile, const WideSurface& surface,
                const EdgeLimits& limits, WideSums& sums);

 private:
  bool MarkStepDoubts(const WideSurface& surface, const EdgeLimits& limits);
  void MarkSteps(const WideSurface& surface, const EdgeLimits& limits);
  void MarkPixels(const WideTile& tile, int margin);
  bool MarkUnsure(int radius, const EdgeLimits& limits, int first_row, std::uint64_t active);
  void WithdrawRows(const VoteInput& input, const WideWays& ways, const WideTile& tile, const WideSurface& surface,
                    const EdgeLimits& limits, int first_row, WideSums& sums);

  WideCells cells_;
  // By row of cells from -margin and word: pixels for which a step may be refused.
  std::vector<std::uint64_t> step_doubts_;
  BitPlane steps_[4], votes_, changes_;  // changes: pixels that are not of the chunk of the one before
  std::vector<std::uint8_t> blocked_;    // by row from -margin: a step from it is refused
  std::vector<std::uint64_t> reached_;   // by pixel of the window and row of eight
  std::vector<std::uint64_t> unsure_;    // see JoinedRows
  std::vector<std::uint8_t> doubtful_;
  WideWithdrawals withdrawals_;
};

}  // namespace scumble::internal
