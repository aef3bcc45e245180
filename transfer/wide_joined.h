// Which votes do not count because an edge stands between: found for 64 × 8 pixels at a time, and taken back.
#pragma once

#include <cstdint>
#include <vector>

#include "transfer/vote.h"
#include "transfer/wide_sums.h"
#include "transfer/wide_surface.h"
#include "transfer/wide_tile.h"

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
  // By the upper or lower quarters of the row of cells, and by row and column of the quarters that are looked at,
  // counted from the own: the pixels that may fail, by depth and by facing. From -quarters to quarters; null: none.
  const std::uint64_t* unsure;
  const std::uint8_t* doubtful;  // by row and column of quarters: whether any pixel may
  int quarters;
};

// Kept from tile to tile by a thread.
class WideJoined {
 public:
  // Takes the votes of all pixels that are not joined to the one they vote for back from `sums`, which holds all votes
  // of the tile. The definition is JoinedWindow's, to the bit.
  void Withdraw(const VoteInput& input, const WideWays& ways, const WideTile& tile, WideSurface& surface,
                const EdgeLimits& limits, WideSums& sums);

 private:
  bool MarkDoubts(const WideSurface& surface, const EdgeLimits& limits);
  unsigned Doubts(const WideSurface& surface, const EdgeLimits& limits, int column, int row, int dx, int dy) const;
  void MarkSteps(const WideSurface& surface, const EdgeLimits& limits);
  void MarkPixels(const WideTile& tile, int margin);
  bool MarkUnsure(WideSurface& surface, const EdgeLimits& limits, int cell_row, std::uint64_t active);
  void WithdrawRows(const VoteInput& input, const WideWays& ways, const WideTile& tile, WideSurface& surface,
                    const EdgeLimits& limits, int first_row, WideSums& sums);

  // By cell, two bits of doubts each: with itself and the four neighbours forward.
  std::vector<std::uint16_t> doubts_;
  BitPlane steps_[4], votes_, changes_;  // changes: pixels that are not of the chunk of the one before
  std::vector<std::uint8_t> blocked_;    // by row from -margin: a step from it is refused
  std::vector<std::uint64_t> reached_;   // by pixel of the window and row of eight
  std::vector<std::uint64_t> unsure_;    // see JoinedRows
  std::vector<std::uint8_t> doubtful_;
};

}  // namespace scumble::internal
