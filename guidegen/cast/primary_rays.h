// The camera's rays through one tile: the hits of the pixels' centres, and the coverage of the pixels.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "guidegen/cast/tile_hits.h"
#include "guidegen/rays/camera_rays.h"
#include "guidegen/rays/embree_scene.h"

namespace scumble {

inline constexpr int kMaxAa = 16;

// Immutable; free to use from any thread.
class PrimaryRays {
 public:
  // For a picture of this size with aa × aa subsamples a pixel, 1 to kMaxAa. The scene and the camera outlive this.
  PrimaryRays(const EmbreeScene& scene, const CameraRays& camera, int width, int height, int aa);

  void PlaceRays(const Tile& tile, TileRays& rays) const;

  // `find_clear`: whether hits.clear_from is needed.
  void CastCentres(const Tile& tile, const TileRays& rays, bool find_clear, TileHits& hits) const;

  // A pixel whose centre misses, and the place in the picture whose ray hit an object.
  struct Moved {
    int pixel;
    glm::dvec2 at;
  };
  // Fills the coverage of a tile whose centres are cast. If a pixel's centre misses but a subsample hits, the pixel
  // takes the hit of its nearest covered subsample and is added to `moved`. A pixel whose centre hits has at least one
  // covered subsample, so that no thin object is lost. Returns the number of rays.
  std::size_t Cover(const Tile& tile, TileHits& hits, std::array<float, kTilePixels>& coverage,
                    std::vector<Moved>& moved) const;

 private:
  using Samples = std::bitset<kMaxAa * kMaxAa>;  // by rank: nearest the pixel's centre first
  using Mask = std::bitset<kTilePixels>;

  struct Offset {
    double x;
    double y;
  };

  template <class Packet>
  void CastPackets(const Tile& tile, const TileRays& rays, bool find_clear, TileHits& hits) const;
  template <class Packet>
  void FindClear(const Packet& packet, const int* valid, CastContext& context, float* clear_from) const;
  Mask FindWhole(const Tile& tile, const TileHits& hits) const;
  std::array<Samples, kTilePixels> CastSubsamples(const Tile& tile, const Mask& whole) const;
  std::size_t CastMissed(const Tile& tile, Samples samples, int pixel, TileHits& hits, std::vector<Moved>& moved) const;

  const EmbreeScene& scene_;
  const CameraRays& camera_;
  const bool backs_;             // whether camera rays may pass surfaces that block rays of light
  std::vector<Offset> offsets_;  // of subsamples, by rank
  std::vector<double> across_;   // of the rays through centres, as in TileRays, by the picture's column
  std::vector<double> up_;       // and by its row; both are padded to whole tiles
};

}  // namespace scumble
