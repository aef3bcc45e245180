// Seeds for the SIMD form of StyleBlit (styleblit_simd.cpp): those near the pixels of one column of tiles, on one
// level. Rows of cells are made on demand and dropped when others need the room; so is a seed's candidate. Most seeds
// of fine levels are never needed.
#pragma once

#include <cstdint>
#include <vector>

#include "transfer/exemplar/paint_by_normal.h"
#include "transfer/match/match.h"
#include "transfer/match/seed_candidate.h"

namespace scumble::internal {

// Tiles of the SIMD match (styleblit_simd.h); the first begins at the picture's corner. Wide enough that many pixels
// share the seeds of coarse levels, small enough that there are tiles for all threads.
inline constexpr int kTileWidth = 512, kTileHeight = 128;
inline constexpr int kBlock = 16;  // pixels of a row that are matched at once
static_assert(kTileWidth % kBlock == 0);
// Up to this level, where a row has many seeds, the nearest ones are found pixel by pixel.
inline constexpr int kMaxSpreadLevel = 6;

// The candidate of a seed at q: a pixel p may take `offset` + p of an exemplar.
struct TileCandidate {
  enum State : std::uint8_t { kUnknown, kNone, kCandidates };
  std::int32_t offset_x = 0, offset_y = 0;  // u* - q
  State state = kUnknown;
  std::uint8_t exemplar = 0;
  bool can_vary = false;  // `variety` may change its source: see SeedFreedom
};

// The variation of a seed on a flat surface.
struct SeedFreedom {
  glm::vec3 guide_offset{0.0f};  // guide offset of the source
  SourceVariation::Tone tone;    // the wanted tone here
};

// One level's seeds of one tile. A seed's index, below kSlots · columns, is valid as long as its row of cells. For one
// thread; rows must be requested from the top down. On levels up to kMaxSpreadLevel their places are also laid out
// pixel by pixel, for vector code.
class TileSeeds {
 public:
  // Rows of cells in memory at once: the three around a pixel, rounded up to a power of two.
  static constexpr int kSlots = 4;
  // For the pixels [x0, x0 + kTileWidth) of the rows of a tile. Keeps `input`.
  void Reset(const MatchInput& input, int level, int x0);

  int level() const { return level_; }
  int columns() const { return columns_; }
  int left() const { return left_; }  // x of the first column's cells

  // Makes the cells in row `cell_row` and those above and below that are near pixels [x, x + width). Their candidates
  // are available then, and with Need their places too.
  void NeedCandidates(int cell_row, int x, int width) {
    NeedIn(filled_, cell_row, x, width, &TileSeeds::MakeCandidates);
  }
  void Need(int cell_row, int x, int width) {
    NeedCandidates(cell_row, x, width);
    NeedIn(placed_, cell_row, x, width, &TileSeeds::MakePlaces);
  }
  static int Slot(int cell_row) { return cell_row & (kSlots - 1); }
  int FirstOf(int cell_row) const { return Slot(cell_row) * columns_; }

  // By pixel from left(), for a row passed to Need: the seed of the pixel's cell, x from left(), and y from the top of
  // the cell. Only for levels up to kMaxSpreadLevel.
  const std::uint16_t* SpreadX(int cell_row) const { return spread_x_.data() + std::size_t(Slot(cell_row)) * spread_; }
  const std::uint16_t* SpreadY(int cell_row) const { return spread_y_.data() + std::size_t(Slot(cell_row)) * spread_; }

  // A seed's place in the picture.
  PixelPosition Position(int index) const {
    const int slot = index / columns_, column = index - slot * columns_, row = filled_.row[slot];
    const PixelPosition in_cell = SeedInCell(input_->seeds, level_, column_hashes_[std::size_t(column)], row);
    return {left_ + (column << level_) + in_cell.x, (row << level_) + in_cell.y};
  }

  // A seed's candidate, made on the first call.
  const TileCandidate& Candidate(int index) {
    TileCandidate& candidate = candidates_[static_cast<std::size_t>(index)];
    if (candidate.state == TileCandidate::kUnknown) Fill(index, candidate);
    return candidate;
  }
  const SeedFreedom& Variation(int index) const { return variations_[static_cast<std::size_t>(index)]; }

  // The seed nearest to pixel (x, y) among the 3 × 3 cells around its own, and the second nearest, as SeedGrid has
  // them.
  struct Two {
    int nearest, second;
    std::int64_t excess;
  };
  Two NearestTwo(int x, int y) const;

  // From x on, the nearest seed along row y, and the first x beyond with another seed: at most the cell's end. The
  // nearest seeds of a row are the lower envelope of parabolas, all of one curvature, so each has one interval.
  struct Run {
    int seed, end;
  };
  Run RunFrom(int x, int y) const;

 private:
  // The parts of rows of cells in memory, by slot. A part is 2^part_ columns: some 64 pixels.
  struct Made {
    int row[kSlots];
    std::uint64_t parts[kSlots];
    // The last request is in memory, for a row and its neighbours: the next request is nearly always equal.
    int last_row;
    std::uint64_t last_parts;
  };
  using Maker = void (TileSeeds::*)(int cell_row, std::uint64_t parts);
  void NeedIn(Made& made, int cell_row, int x, int width, Maker make) {
    const int first = ((x - left_) >> level_) - 1, last = ((x + width - 1 - left_) >> level_) + 1;
    const std::uint64_t parts = (~0ull << (first >> part_)) & (~0ull >> (63 - (last >> part_)));
    if (made.last_row == cell_row && (parts & ~made.last_parts) == 0) return;
    made.last_parts = made.last_row == cell_row ? made.last_parts | parts : parts;
    made.last_row = cell_row;
    for (int row = cell_row - 1; row <= cell_row + 1; ++row) {
      const int slot = Slot(row);
      if (made.row[slot] != row) made.row[slot] = row, made.parts[slot] = 0;
      const std::uint64_t missing = parts & ~made.parts[slot];
      if (missing == 0) continue;
      (this->*make)(row, missing);
      made.parts[slot] |= missing;
    }
  }
  template <class Visit>
  void ForEachColumn(std::uint64_t parts, const Visit& visit) const;
  void MakeCandidates(int cell_row, std::uint64_t parts);
  void MakePlaces(int cell_row, std::uint64_t parts);
  void Fill(int index, TileCandidate& candidate);

  const MatchInput* input_ = nullptr;
  const float* normal_[3] = {};
  int level_ = 0, left_ = 0, columns_ = 0, first_column_ = 0;
  int part_ = 0;
  std::size_t spread_ = 0;
  Made filled_, placed_;
  std::vector<std::uint64_t> column_hashes_;
  std::vector<PixelPosition> in_cell_;
  std::vector<TileCandidate> candidates_;
  std::vector<SeedFreedom> variations_;  // empty without variety
  std::vector<std::uint16_t> spread_x_, spread_y_;
};

}  // namespace scumble::internal
