// The camera's packets of rays, and the pixels of a tile.
#pragma once

#include "guidegen/cast/tile_hits.h"
#include "guidegen/rays/camera_rays.h"
#include "guidegen/rays/occlusion_batch.h"

namespace scumble {

inline Segment SeenBy(const CameraRays& camera, const ViewRay& ray) {
  return {ray.origin, ray.direction, camera.near_depth(), camera.far_depth()};
}

// Calls `visit(pixel)` for each pixel of the tile, row by row.
template <class Visit>
void ForEachPixel(const Tile& tile, const Visit& visit) {
  for (int row = 0; row < tile.height; ++row) {
    for (int column = 0; column < tile.width; ++column) visit(TilePixel(column, row));
  }
}

}  // namespace scumble
