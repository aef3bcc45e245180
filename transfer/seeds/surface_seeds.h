// Seeds that live on surfaces: those of StyleBlit's hierarchy (transfer/seeds/seeds.h), spread through an object's rest
// space (layer `pref`) instead of over the screen. So chunks of paint move with their surface, and a frame needs no
// other frame. The reasons are in docs/numerics.md, "Seeds on surfaces".
//
//   - Rest space has a grid of cubes for every power of two, its edge 2^e. Each cube holds one point, hashed from
//     (seed, time step, object, e, cube). Each grid is moved by a hash of (seed, object, e).
//   - A pixel belongs to the nearest point of the 27 cubes around it, its surface cell.
//   - A cell's seed q is its pixel nearest to the point, ties to the lowest (y, x). It follows the
//     surface as closely as pixels can.
//   - A pixel's octave is κ = log2(pref units a pixel): the median over the object of (distance of pref to the next
//     pixel / depth), times the pixel's own depth.
//   - The cell's place in StyleBlit's hierarchy is level = e - floor(κ(q) + h), h in [0, 1) hashed from its cube. The
//     cell takes part where 1 <= level < levels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/image/guides.h"
#include "transfer/seeds/seeds.h"

namespace scumble::internal {

// κ of a pixel without an octave: it has no seed.
inline constexpr float kNoOctave = -1e9f;

// κ per pixel. kNoOctave where the pixel is inactive, where pref is not finite, or where the object has no two
// neighbouring pixels at different places. Here log2 is linear between powers of two, so that it is equal on every
// machine. Guides must hold pref, depth and object ids. Guides without a depth above 0, or of an orthographic camera,
// count as all at one distance. O(active pixels), in the caller's oneTBB arena.
std::vector<float> SurfaceOctaves(const GuideSet& guides, std::span<const std::uint8_t> active);

// The surface cell of a place.
struct SurfaceCell {
  std::uint64_t key = 0;  // of (seed, time step, object, e, cube), as good as unique; never 0
  float squared = 0.0f;   // distance from its point, in edges
};

// The surface cells of one object and one e. Caches the cubes around the last place, which is most likely near the
// next: one for each thread.
class SurfaceGrid {
 public:
  SurfaceGrid() = default;
  SurfaceGrid(const SeedRules& rules, std::uint32_t object, int exponent);

  bool Is(std::uint32_t object, int exponent) const { return object_ == object && exponent_ == exponent; }

  // Ties to the first cube, x before y before z. Places farther than 2^50 edges from the origin have none: key 0.
  SurfaceCell Nearest(const glm::vec3& place);

 private:
  void MoveTo(const std::int64_t (&cube)[3]);
  void Fill(int neighbour);

  std::uint32_t object_ = 0;
  int exponent_ = 0;
  double per_edge_ = 0.0;
  double shift_[3] = {};
  float jitter_ = 0.0f;
  std::uint64_t prefix_ = 0;
  bool placed_ = false;
  std::int64_t cube_[3] = {};
  std::uint32_t filled_ = 0;  // one bit for each of the 27
  std::uint64_t key_[27] = {};
  float point_[27][3] = {};  // from the middle cube's lowest corner, in edges
};

// [0, 1), for a decision that is made once a cell; `purpose` makes such numbers independent.
float CellChance(std::uint64_t key, int purpose);

}  // namespace scumble::internal
