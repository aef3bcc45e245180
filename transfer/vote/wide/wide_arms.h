// The arms of support_regions.h for one tile of a wide window, from masks of open steps.
#pragma once

#include <cstdint>
#include <vector>

#include "transfer/vote/bit_mask_rows.h"
#include "transfer/vote/edge/open_steps.h"
#include "transfer/vote/vote.h"
#include "transfer/vote/wide/chunk_runs.h"

namespace scumble::internal {

// Bounds of the normals of active pixels: where they rule a turn out, no two normals are compared.
struct NormalBounds {
  float low[3], high[3];
  float least_squared;  // length
};

// Rows and columns count from the tile's corner. Pixels beyond the picture end no arm. Kept from tile to tile by a
// thread.
class WideArms {
 public:
  // Whole windows, for plain voting.
  void SetWhole(int radius);
  // Reads the arms of the active pixels in and around `area`, at most kTileSide wide and high. Needs input.edges.
  void Read(const VoteInput& input, const Region& area);

  int radius() const { return radius_; }
  // The horizontal arm of (x, row) is columns [Low(row)[x], High(row)[x]); of rows from -radius to before the tile's
  // height + radius. A vector more of columns may be read.
  const std::int16_t* Low(int row) const { return Ends(row); }
  const std::int16_t* High(int row) const { return Ends(row) + kStride; }
  // The active pixels of row y of the tile whose vertical arm is shorter than the radius on either side. Only for these
  // Up and Down give the number of rows.
  std::uint64_t Short(int y) const { return short_[y]; }
  int Up(int x, int y) const { return up_[y][x]; }
  int Down(int x, int y) const { return down_[y][x]; }

 private:
  static constexpr int kStride = kTileSide + 32;
  static constexpr int kCellColumns = 16, kCellRows = 8;

  const std::int16_t* Ends(int row) const { return ends_.data() + ends_of_row_[std::size_t(row + radius_)]; }
  void MarkActiveAndSteps(const VoteInput& input, const Region& area);
  void MarkTurns(const VoteInput& input);
  void ReadRow(const VoteInput& input, const Region& area, int y);
  void ReadColumns(const VoteInput& input, const Region& area);

  int radius_ = 0;
  // Ends of the arms of a row, low and high; the first row is that of whole windows.
  std::vector<std::int16_t> ends_;
  std::vector<std::size_t> ends_of_row_;  // their offsets
  std::uint64_t short_[kTileSide] = {};
  std::uint8_t up_[kTileSide][kTileSide], down_[kTileSide][kTileSide];

  // Of one tile.
  MaskedTile marked_;
  Region seen_;  // the part of the picture that the arms can reach
  BitMaskRows active_, wanted_;
  OpenSteps steps_;
  std::vector<NormalBounds> bounds_;      // by cell
  BitMaskRows turns_right_, turns_down_;  // by row of cells: from these pixels on an arm may turn too far
  std::vector<std::uint64_t>
      columns_;  // by length k and row: bit x is set if the pixel is on one arm with that k rows below
};

}  // namespace scumble::internal
