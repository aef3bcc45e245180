// The camera's rays through one tile: the hits of the pixels' centres, and the coverage of the pixels.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
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
  // Another surface than that of a pixel's centre, as Fragments has them.
  struct Beside {
    int pixel;
    glm::dvec2 at;  // the place in the picture of its subsample that is nearest to their mean
    std::uint32_t object;
    std::uint32_t primitive;
    float coverage;
    std::uint16_t cells;  // as in Fragments
  };
  // What the rays through subsamples met, by pixel and rank. Memory for Cover, of one thread.
  struct SubsampleHits {
    std::vector<std::uint32_t> object, primitive;
  };
  // Fills the coverage of a tile whose centres are cast. If a pixel's centre misses but a subsample hits, the pixel
  // takes the hit of its nearest covered subsample and is added to `moved`. A pixel whose centre hits has at least one
  // covered subsample, so that no thin object is lost. Adds the other surfaces of pixels to `beside`, those with the
  // largest coverage, pixel by pixel. Returns the number of rays.
  std::size_t Cover(const Tile& tile, TileHits& hits, std::array<float, kTilePixels>& coverage,
                    std::vector<Moved>& moved, SubsampleHits& seen, std::vector<Beside>& beside) const;

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
  std::array<Samples, kTilePixels> FindSubsamples(const Tile& tile, const Mask& whole, SubsampleHits& seen) const;
  void FindBeside(const Tile& tile, int pixel, const TileHits& hits, const Samples& covered, const SubsampleHits& seen,
                  float coverage, std::vector<Beside>& beside) const;
  std::size_t CastMissed(const Tile& tile, Samples samples, int pixel, TileHits& hits, std::vector<Moved>& moved) const;

  const EmbreeScene& scene_;
  const CameraRays& camera_;
  const bool backs_;             // whether camera rays may pass surfaces that block rays of light
  std::vector<Offset> offsets_;  // of subsamples, by rank
  // By Embree's id of an object, its surface: objects with one name and material are one. In the order of ids.
  std::vector<std::uint32_t> surfaces_;
  bool one_surface_ = true;
  std::vector<double> across_;  // of the rays through centres, as in TileRays, by the picture's column
  std::vector<double> up_;      // and by its row; both are padded to whole tiles
};

}  // namespace scumble
