// The exact nearest patch of an exemplar, without looking at all of them.
//
// Positions are kept in tiles of 8 × 8 with a few numbers each that bound distances from below: projections of the
// patch onto orthonormal patterns, whose differences add up to no more than the patches' own squared distance, and the
// length of what the projections leave, which by the triangle inequality may be added; the guides of the middle stand
// for themselves, normals less what is free of them. A tile's box of these numbers bounds all of its positions. Tiles
// are visited by rising bound until that exceeds the best distance found: branch and bound [Fukunaga & Narendra 1975],
// with projections as in [Hel-Or & Hel-Or 2005]. All bounds are lowered by what rounding could have raised them, so
// that what comes out is the minimum over all positions, to the bit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace scumble::internal {

inline constexpr int kPatchRadius = 2;
inline constexpr int kPatchPlaces = 25;
inline constexpr int kPatchColors = 3;

// Planes with a margin of kPatchRadius on every side, where the mask is 0: the colours first, 0 … 65535, then the
// guides.
struct PatchPlanes {
  int width = 0;
  int height = 0;
  std::vector<std::vector<float>> planes;
  std::vector<std::uint8_t> mask;
  // By place, 0 … 2: how far apart the first three guides, which are normals, may be without cost; of the two places
  // compared the one that grants more. Empty: 0.
  std::vector<float> free;

  PatchPlanes(int w, int h, std::size_t plane_count);
  std::ptrdiff_t stride() const { return width + 2 * kPatchRadius; }
  std::ptrdiff_t Index(int x, int y) const { return (y + kPatchRadius) * stride() + x + kPatchRadius; }
};

// The patch around a pixel of the target, and what it is to find.
struct PatchQuery {
  struct Offset {
    int x = 0, y = 0;
  };
  std::vector<Offset> offsets;                          // that count, in row order
  std::array<std::vector<float>, kPatchColors> colors;  // one for each offset
  std::vector<float> guides;                            // of the middle
  double free = 0.0;                                    // likewise
  int core = 0;        // the largest radius, at most the search's, whose places all count
  double whole = 1.0;  // 25 / offsets, by which colour counts
};

struct PatchMatch {
  int exemplar = -1, x = 0, y = 0;
  double color = 0.0;  // squared differences of the places that count, as 0 … 1, times `whole`
  double guide =
      0.0;  // of the middle: the square of the distance of the normals beyond `free`, and those of the others
};

class PatchSearch {
 public:
  // `exemplars` must outlive the search and have alike many planes. `guide_weight` is at least 0. `largest_guide`
  // bounds the absolute values of the guides of exemplars and targets.
  PatchSearch(std::span<const PatchPlanes> exemplars, double guide_weight, double largest_guide);

  // 2, 1 or 0: the largest for which some exemplar has a position all round which everything is usable; −1: none is
  // usable.
  int radius() const { return radius_; }

  // Pixel (x, y) of the target must be in its mask.
  PatchQuery QueryAt(const PatchPlanes& target, int x, int y) const;

  struct Place {
    int exemplar = 0, x = 0, y = 0;
  };
  // The position where color + guide_weight · guide is least, of equals the first by exemplar, y and x. `guesses` are
  // looked at first; those that do not fit are passed over. Safe to call from several threads.
  PatchMatch Nearest(const PatchQuery& query, std::span<const Place> guesses) const;

 private:
  static constexpr int kTileSide = 8;
  static constexpr int kTilePlaces = kTileSide * kTileSide;

  // One pattern of a (2r + 1)² patch, as a product.
  struct Pattern {
    std::array<double, 2 * kPatchRadius + 1> across{}, down{};
  };
  // All positions with a usable surrounding of one radius.
  struct Level {
    int radius = 0;
    std::vector<Pattern> patterns;  // the first is flat
    int numbers = 0;                // of each position
    std::size_t tiles = 0;
    std::vector<std::array<std::int32_t, 3>> places;  // by tile: exemplar, y, x
    std::vector<std::size_t> first;                   // by tile: into places; one more at the end
    std::vector<float> values;                        // by tile, number, place
    std::vector<float> low, high;                     // by number, tile
  };
  struct Best;

  Level MakeLevel(int radius) const;
  void AddTile(Level& level, int exemplar, int tile_x, int tile_y) const;
  template <class Color, class Guide>
  void Project(const Level& level, const Color& color, const Guide& guide, float* numbers) const;
  template <class Distance>
  void AddBounds(const Level& level, double free, std::span<float> bounds, const Distance& distance) const;
  bool Fits(const PatchPlanes& exemplar, const PatchQuery& query, int x, int y) const;
  void Try(const PatchQuery& query, const Place& place, Best& best) const;
  void SearchTile(const Level& level, std::size_t tile, const float* wanted, const PatchQuery& query, Best& best) const;

  std::span<const PatchPlanes> exemplars_;
  std::size_t guides_ = 0;
  double guide_weight_ = 0.0;
  double most_free_ = 0.0;  // of all places of all exemplars
  float slack_ = 0.0f;      // by which each difference of two numbers may be too large
  int radius_ = -1;
  std::vector<Level> levels_;  // by radius
};

}  // namespace scumble::internal
