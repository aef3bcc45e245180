// Bounds over small cells of a surface: which pairs of cells hold no pixels that an edge could part.
#pragma once

#include <cstdint>
#include <vector>

#include "transfer/vote/wide/guide_tile.h"

namespace scumble::internal {

// Bounds of cells side by side from the first on, and of those (dx, dy) cells further.
struct CellPairs {
  const float *p, *q;
  std::size_t plane;  // from a bound to the next
  int dx, dy, radius;
  bool facing;  // whether any may fail by facing
};

// Kept from tile to tile by a thread.
class WideCells {
 public:
  static constexpr int kSide = 4;                    // pixels
  static constexpr int kAcross = kTileSide / kSide;  // cells of a tile, on each side

  // Bounds of all cells of the surface, its margin included, for these limits.
  void Read(const WideSurface& surface, const EdgeLimits& limits);

  // What may make some covered pixel of a cell fail the edge test with a covered one of the cell (dx, dy) cells
  // further, for kAcross cells from `column` on, the lowest bit the first; without the bit of a cause, surely none
  // fails by it. Columns and rows count from the tile's corner; what lies beyond the margin fails nothing.
  struct Bits {
    std::uint32_t depth = 0, facing = 0;  // facing: normals, and objects
  };
  Bits Doubts(const EdgeLimits& limits, int column, int row, int dx, int dy) const;

  // Planes of bounds over the covered pixels of each cell. Depth is a plane through the centre, give or take kBend;
  // slopes are the plane's, give or take kTurnX and kTurnY.
  enum Bound {
    kDepth,
    kBend,
    kSlopeX,
    kSlopeY,
    kTurnX,
    kTurnY,
    kLeastSlopeX,
    kLeastSlopeY,  // how steep it is everywhere, 0 where slopes change their sign
    kLeastDepth,
    kFarthest,
    kSteepest,  // depth; |depth|, and |slopes| together, at most
    kLeastNormal,
    kMostNormal = kLeastNormal + 3,
    kLeastLength2 = kMostNormal + 3,  // of normals
    kObject,                          // NaN: several, or some value has no order; then kBend is NaN too
    kSeen,                            // above 0: pixels are covered
    kBounds
  };

 private:
  static constexpr int kPad = 16;  // cells on either side of a row, which cover nothing

  int margin_ = 0, radius_ = 0;  // cells; pixels
  std::size_t stride_ = 0, plane_ = 0;
  bool facing_ = true;
  std::vector<float> bounds_;  // plane by plane
};

}  // namespace scumble::internal
