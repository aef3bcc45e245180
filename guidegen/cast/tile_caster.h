// One tile of the picture: rays, hits, layers. Internal to cast_guides.cpp.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "guidegen/cast/cast_fragments.h"
#include "guidegen/cast/cast_guides.h"
#include "guidegen/cast/point_values.h"
#include "guidegen/cast/primary_rays.h"
#include "guidegen/cast/tile_hits.h"
#include "guidegen/cast/tile_surface.h"
#include "guidegen/guidegen.h"
#include "guidegen/light/area_light_tile.h"
#include "guidegen/light/light_sampling.h"
#include "guidegen/light/path_tracer.h"
#include "guidegen/rays/embree_scene.h"
#include "guidegen/rays/progress_gate.h"
#include "guidegen/surface/triangle_cache.h"

namespace scumble {

// Casts tiles into a GuideSet. Shared by all threads; tiles do not overlap, so nothing is locked.
class TileCaster {
 public:
  // All four outlive the caster. It writes every pixel of the set's layers, background included.
  TileCaster(const EmbreeScene& scene, const View& view, const GuidegenOptions& options, GuideSet& guides);

  // What a thread keeps from tile to tile. Buffers never change the result.
  class Scratch {
   public:
    explicit Scratch(const TileCaster& caster);

    FoundFragments fragments;  // of all tiles that the thread has cast
    const LightErrors& light_errors() const { return area_light_tile.errors(); }  // likewise

   private:
    friend class TileCaster;
    struct OfTile {
      TileHits hits;
      TileRays rays;
      alignas(64) std::array<float, kTilePixels> coverage;
      TileGuides guides;
      TilePoints points;
      std::vector<SurfacePoint> lit;
      std::vector<AreaLightPixel> area_lit;
      std::vector<PrimaryRays::Moved> moved;
    };
    TriangleCache triangles;
    AreaLightTile area_light_tile;
    PrimaryRays::SubsampleHits seen;
    std::vector<PrimaryRays::Beside> beside;
    std::vector<OfTile> tiles;
  };

  // One thread's share of the work: the gate for cancellation, and the rays that it has cast.
  struct Share {
    ProgressGate& gate;
    RayCounts rays;
  };

  // Casts 1 to kStripTiles tiles that stand side by side, from left to right. Adds the counts to `share`. Unless
  // `pixels` is empty, adds the covered pixels of tile i to pixels[i] for their light paths. Other threads see the
  // values after PublishTiles(). If the gate is cancelled, the tiles may stay incomplete.
  void Cast(std::span<const Tile> tiles, Scratch& scratch, Share& share,
            std::span<std::vector<PathPixel>> pixels = {}) const;

 private:
  using TileScratch = Scratch::OfTile;

  // A layer that is wanted; background is the value of pixels without a hit.
  struct Plane {
    float* values;
    float background;
  };
  struct Planes {
    float* coverage = nullptr;
    float* depth = nullptr;
    float* object = nullptr;
    float* material = nullptr;
    float* luminance = nullptr;
    float* shadow = nullptr;
    std::array<float*, 3> normal{};
    std::array<float*, 3> position{};
    std::array<float*, 3> pref{};
    std::array<float*, 3> albedo{};
    std::array<float*, 2> motion{};
    float* cosine = nullptr;  // where there is a key lamp
    std::array<float*, 2> uv{};
    std::vector<Plane> others;  // layers that are not written as whole tiles
  };

  void WritePlain(int pixel, const glm::dvec2& at, TileScratch& scratch) const;
  void WriteOthers(const Tile& tile, int pixel, const glm::dvec2& at, TileScratch& scratch) const;
  void WriteWhole(std::span<const Tile> tiles, const Scratch& scratch) const;
  void Fill(const Tile& tile, Scratch& buffers, TileScratch& scratch, Share& share,
            std::vector<PathPixel>* pixels) const;
  void Light(const Tile& tile, AreaLightTile& area_light_tile, TileScratch& scratch, Share& share) const;
  // The luminance that a surface itself sends out.
  double EmissionOf(std::uint32_t object, std::uint32_t primitive, const glm::dvec2& barycentric) const;
  glm::dvec2 Centre(const Tile& tile, int pixel) const {
    return {tile.x0 + TileColumn(pixel) + 0.5, tile.y0 + TileRow(pixel) + 0.5};
  }
  std::size_t Index(const Tile& tile, int pixel) const {
    return std::size_t(tile.y0 + TileRow(pixel)) * width_ + tile.x0 + TileColumn(pixel);
  }

  const EmbreeScene& scene_;
  const View& view_;
  const GuidegenOptions& options_;
  std::size_t width_;
  bool past_caches_;
  const PrimaryRays primary_;
  const PointValues point_values_;
  const FragmentCaster fragment_caster_;
  const LightSet lights_;
  const std::vector<ObjectRecord> object_records_;
  Planes planes_;
  bool lit_ = false;     // luminance or shadow is wanted, and something emits
  bool points_ = false;  // whether any layer needs more than TileGuides
};

}  // namespace scumble
