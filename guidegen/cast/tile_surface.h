// FindSurfacePoint for all centres of a tile at once, as wide as the machine's vectors are.
#pragma once

#include <array>
#include <cstdint>

#include "guidegen/cast/tile_hits.h"
#include "guidegen/surface/triangle_cache.h"

namespace scumble {

// By TilePixel, as the layers of these names hold it; background where nothing was met.
struct TileGuides {
  alignas(64) std::array<float, kTilePixels> depth;
  alignas(64) std::array<float, kTilePixels> object;
  alignas(64) std::array<float, kTilePixels> material;
  alignas(64) std::array<std::array<float, kTilePixels>, 3> normal;
  // Pixels that the vector code cannot do. Their guides are not set; the plain code does them.
  std::array<std::uint8_t, kTilePixels> left_over;
  int left_over_count = 0;
};

// By TilePixel, as SurfacePoint has it; anything where nothing was met.
struct TilePoints {
  alignas(64) std::array<std::array<double, kTilePixels>, 2> barycentric;
  alignas(64) std::array<std::array<double, kTilePixels>, 3> position;
  alignas(64) std::array<std::array<double, kTilePixels>, 3> facing;
  alignas(64) std::array<std::array<double, kTilePixels>, 3> normal;
  alignas(64) std::array<double, kTilePixels> largest_coordinate;

  SurfacePoint At(int pixel) const;  // without rest position and max_ray_offset
  void Set(int pixel, const SurfacePoint& point);
};

// Every bit as FindSurfacePoint has it, on every machine. `points` may be null.
void FindTileSurface(const TileHits& hits, const TileRays& rays, TriangleCache& triangles, TileGuides& guides,
                     TilePoints* points);

}  // namespace scumble
