// The surface in and around a tile, as far as its edges matter: guides and slopes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/image/guides.h"
#include "core/filter/region.h"
#include "transfer/vote/wide/chunk_runs.h"

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
  float crease_cosine;
  DepthGive give;
};

// Kept from tile to tile by a thread.
class WideSurface {
 public:
  static constexpr int kBand = 8;  // rows that are looked at together
  enum Plane { kDepth, kSlopeX, kSlopeY, kNormalX, kNormalY, kNormalZ, kObject, kCoverage, kPlanes };

  // Reads the guides in and around a tile.
  void Read(const GuideSet& guides, const Region& area, int radius);

  int radius() const { return radius_; }
  // The radius, rounded up to whole bands.
  int margin() const { return (radius_ + kBand - 1) / kBand * kBand; }
  // Values from column 0 of a row on; rows and columns from -margin() to kTileSide + margin(), and a vector more of
  // columns, may be read. What is not covered has depth NaN.
  const float* Row(Plane plane, int row) const { return bases_[plane] + std::ptrdiff_t(row) * strides_[plane]; }
  const BitPlane& covered() const { return covered_; }
  bool all_covered() const { return all_covered_; }  // as far as the radius reaches

 private:
  static constexpr int kPad = 16;  // columns

  float* Own(Plane plane, int row) {
    return planes_[plane].data() + std::size_t(row + margin() + 1) * stride_ + std::size_t(margin() + kPad);
  }
  void Copy(const GuideSet& guides, const Region& area);

  int radius_ = 0;
  std::size_t stride_ = 0;
  std::vector<float> planes_[kPlanes];
  // Where values are read: the own planes or, in the middle of a picture, the guides.
  const float* bases_[kPlanes] = {};
  std::ptrdiff_t strides_[kPlanes] = {};
  bool all_covered_ = false;
  BitPlane covered_;
};

}  // namespace scumble::internal
