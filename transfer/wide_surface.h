// The surface in and around a tile, as far as its edges matter: guides, slopes, and bounds of both over small cells.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "image/guides.h"
#include "transfer/region.h"
#include "transfer/wide_tile.h"

namespace scumble::internal {

// Of 64 bits, those from `begin` to before `end`, which may lie outside.
inline std::uint64_t BitsBetween(int begin, int end) {
  begin = std::clamp(begin, 0, 64), end = std::clamp(end, 0, 64);
  if (begin >= end) return 0;
  return ~std::uint64_t{0} >> (64 - (end - begin)) << begin;
}

// Rows of bits from `margin` rows and columns before a tile to as many behind it, laid out word by word, so that one
// word of several rows is read at once.
class BitPlane {
 public:
  void Reset(int margin);  // all 0
  // 64 columns from `column` on are or-ed; what lies beyond the margin is lost.
  void Put(int row, int column, std::uint64_t bits);

  // 64 columns from `column` on, at most one before the margin.
  std::uint64_t Read(int row, int column) const {
    const int at = column + margin_, shift = at & 63;
    const std::uint64_t* low = words_.data() + std::size_t(at >> 6) * rows_ + std::size_t(row + margin_);
    return low[0] >> shift | low[rows_] << 1 << (63 - shift);
  }
  // The same of eight rows.
  void Read8(int row, int column, std::uint64_t* bits) const {
    const int at = column + margin_, shift = at & 63;
    const std::uint64_t* low = words_.data() + std::size_t(at >> 6) * rows_ + std::size_t(row + margin_);
    const std::uint64_t* high = low + rows_;
    for (int k = 0; k < 8; ++k) bits[k] = low[k] >> shift | high[k] << 1 << (63 - shift);
  }

 private:
  int margin_ = 0, rows_ = 0;
  std::vector<std::uint64_t> words_;
};

// What votes may not cross, as EdgeTest has it.
struct EdgeLimits {
  float crease_cosine, depth_tolerance;
};

// Kept from tile to tile by a thread.
class WideSurface {
 public:
  static constexpr int kCell = 8;  // pixels on each side
  static constexpr int kQuarter = kCell / 2;
  static constexpr int kCells = kTileSide / kCell;  // of a tile, on each side
  enum Plane { kDepth, kSlopeX, kSlopeY, kNormalX, kNormalY, kNormalZ, kObject, kCoverage, kPlanes };

  // Reads the guides in and around a tile.
  void Read(const GuideSet& guides, const Region& area, int radius);

  int radius() const { return radius_; }
  int reach() const { return reach_; }  // cells that the radius reaches on each side
  int margin() const { return kCell * reach_; }
  // Values from column 0 of a row on; rows and columns from -margin() to kTileSide + margin(), and a vector more of
  // columns, may be read. What is not covered has depth NaN.
  const float* Row(Plane plane, int row) const { return bases_[plane] + std::ptrdiff_t(row) * strides_[plane]; }
  const BitPlane& covered() const { return covered_; }
  bool all_covered() const { return all_covered_; }  // as far as the radius reaches

  // What may make some covered pixel of that cell fail the edge test with a covered one of the cell (dx, dy) cells
  // further; without the bit of a cause, surely none fails by it. Columns and rows of cells, from -reach() to kCells +
  // reach().
  enum Doubt : unsigned { kDepthDoubt = 1, kFacingDoubt = 2 };  // facing: normals, and objects
  unsigned Doubts(const EdgeLimits& limits, int column, int row, int dx, int dy) const {
    return Doubts(limits, CellAt(column, row), CellAt(column + dx, row + dy), kCell, dx, dy);
  }
  // The same of a quarter of a cell and another. Columns and rows of quarters; both cells are then looked at more
  // closely.
  unsigned QuarterDoubts(const EdgeLimits& limits, int column, int row, int dx, int dy);

  // Bounds over the covered pixels of a cell. Depth is a plane through the centre, give or take `bend`; slopes are the
  // plane's, give or take `turn_x` and `turn_y`.
  struct Cell {
    bool empty = true, odd = false;  // odd: several objects, or values without an order
    float object = 0, depth = 0, slope_x = 0, slope_y = 0, bend = 0, turn_x = 0, turn_y = 0;
    float least_depth = 0, most_depth = 0, least_slope_x = 0, least_slope_y = 0;
    float least_normal[3] = {}, most_normal[3] = {}, least_length2 = 0;
  };

 private:
  static constexpr int kPad = 16;  // columns

  float* Own(Plane plane, int row) {
    return planes_[plane].data() + std::size_t(row + margin() + 1) * stride_ + std::size_t(margin() + kPad);
  }
  void Copy(const GuideSet& guides, const Region& area);
  void PlanesAt(int x, int y, const float** planes) const {
    for (int k = 0; k < kPlanes; ++k) planes[k] = Row(Plane(k), y) + x;
  }
  const Cell& CellAt(int column, int row) const {
    return cells_[std::size_t(row + reach_) * (kCells + 2 * reach_) + std::size_t(column + reach_)];
  }
  unsigned Doubts(const EdgeLimits& limits, const Cell& p, const Cell& q, int size, int dx, int dy) const;
  const Cell& QuarterAt(int column, int row);

  int radius_ = 0, reach_ = 0;
  std::size_t stride_ = 0;
  std::vector<float> planes_[kPlanes];
  // Where values are read: the own planes or, in the middle of a picture, the guides.
  const float* bases_[kPlanes] = {};
  std::ptrdiff_t strides_[kPlanes] = {};
  bool all_covered_ = false;
  BitPlane covered_;
  std::vector<Cell> cells_, quarters_;
  std::vector<std::uint8_t> quartered_;  // by cell: its quarters are known
};

}  // namespace scumble::internal
