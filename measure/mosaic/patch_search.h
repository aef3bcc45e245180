// The exact nearest patch of an exemplar by branch and bound [Fukunaga & Narendra 1975], with projections as in [Hel-Or
// & Hel-Or 2005].
//
// Positions are stored in tiles of 8 × 8 with a few numbers each that bound distances from below. These are projections
// of the patch onto orthonormal patterns, the length of the remainder, and the guides of the middle, normals less their
// free distance. A tile's box of these numbers bounds all of its positions. Tiles are visited by rising bound until it
// exceeds the best distance. All bounds are lowered by the largest rounding error, so that the result is the minimum
// over all positions, to the bit. docs/numerics.md ("Derivations") shows why the numbers are bounds.
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
  // By place, 0 … 2: the distance of the first three guides, which are normals, that costs nothing; the larger value of
  // the two places counts. Empty: 0.
  std::vector<float> free;

  PatchPlanes(int w, int h, std::size_t plane_count);
  std::ptrdiff_t stride() const { return width + 2 * kPatchRadius; }
  std::ptrdiff_t Index(int x, int y) const { return (y + kPatchRadius) * stride() + x + kPatchRadius; }
};

// The patch around a pixel of the target, as a query.
struct PatchQuery {
  struct Offset {
    int x = 0, y = 0;
  };
  std::vector<Offset> offsets;                          // of valid places, in row order
  std::array<std::vector<float>, kPatchColors> colors;  // one for each offset
  std::vector<float> guides;                            // of the middle
  double free = 0.0;                                    // likewise
  int core = 0;        // the largest radius, at most the search's, whose places are all valid
  double whole = 1.0;  // 25 / offsets, the factor of colour
};

struct PatchMatch {
  int exemplar = -1, x = 0, y = 0;
  double color = 0.0;  // squared differences of the valid places, as 0 … 1, times `whole`
  double guide =
      0.0;  // of the middle: the square of the distance of the normals beyond `free`, and those of the others
};

class PatchSearch {
 public:
  // `exemplars` must outlive the search and have equal numbers of planes. `guide_weight` is at least 0. `largest_guide`
  // bounds the absolute values of the guides of exemplars and targets.
  PatchSearch(std::span<const PatchPlanes> exemplars, double guide_weight, double largest_guide);

  // 2, 1 or 0: the largest radius for which some exemplar has a position with a completely usable surrounding; −1: none
  // is usable.
  int radius() const { return radius_; }

  // Pixel (x, y) of the target must be in its mask.
  PatchQuery QueryAt(const PatchPlanes& target, int x, int y) const;

  struct Place {
    int exemplar = 0, x = 0, y = 0;
  };
  // The position where color + guide_weight · guide is least, of equals the first by exemplar, y and x. `guesses` are
  // tried first; those that do not fit are skipped. Safe to call from several threads.
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
  float slack_ = 0.0f;      // the largest error of the difference of two numbers
  int radius_ = -1;
  std::vector<Level> levels_;  // by radius
};

}  // namespace scumble::internal
