// FindSurfacePoint for all centres of a tile at once, with the machine's vector width.
#pragma once

#include <array>
#include <cstdint>

#include "guidegen/cast/tile_hits.h"
#include "guidegen/surface/triangle_cache.h"

namespace scumble {

// By TilePixel, the values of the layers of these names; background where there is no hit.
struct TileGuides {
  alignas(64) std::array<float, kTilePixels> depth;
  alignas(64) std::array<float, kTilePixels> object;
  alignas(64) std::array<float, kTilePixels> material;
  alignas(64) std::array<std::array<float, kTilePixels>, 3> normal;
  // Pixels that the vector code leaves to the plain code. Their guides are not set.
  std::array<std::uint8_t, kTilePixels> left_over;
  int left_over_count = 0;
};

// By TilePixel, as in SurfacePoint; undefined where there is no hit.
struct TilePoints {
  alignas(64) std::array<std::array<double, kTilePixels>, 2> barycentric;
  alignas(64) std::array<std::array<double, kTilePixels>, 3> position;
  alignas(64) std::array<std::array<double, kTilePixels>, 3> facing;
  alignas(64) std::array<std::array<double, kTilePixels>, 3> normal;
  alignas(64) std::array<double, kTilePixels> largest_coordinate;
  // The vector code has no pixels where these differ.
  std::array<bool, kTilePixels> has_smooth_normal;
  std::array<glm::dvec3, kTilePixels> smooth_normal;

  SurfacePoint At(int pixel) const;  // without rest position and max_ray_offset
  void Set(int pixel, const SurfacePoint& point);
};

// Equal to FindSurfacePoint in every bit, on every machine. With `bends_normals`, pixels whose shading normal may have
// to be bent are left over. `points` may be null.
void FindTileSurface(const TileHits& hits, const TileRays& rays, TriangleCache& triangles, bool bends_normals,
                     TileGuides& guides, TilePoints* points);

}  // namespace scumble
