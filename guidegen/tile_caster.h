// One tile of the picture: rays, hits, layers. Internal to cast_guides.cpp.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <vector>

#include "guidegen/cast_guides.h"
#include "guidegen/embree_scene.h"
#include "guidegen/guidegen.h"
#include "guidegen/light_paths.h"
#include "guidegen/light_sampling.h"

namespace scumble {

inline constexpr int kTileSide = 16;
inline constexpr int kTilePixels = kTileSide * kTileSide;
inline constexpr int kMaxAa = 16;

// A rectangle of at most kTileSide × kTileSide pixels.
struct Tile {
  int x0 = 0;
  int y0 = 0;
  int width = 0;
  int height = 0;
};

// Casts tiles into a GuideSet. Shared by all threads; tiles do not overlap, so nothing is locked.
class TileCaster {
 public:
  // All four outlive the caster. The set's layers are filled with their background values.
  TileCaster(const EmbreeScene& scene, const View& view, const GuidegenOptions& options, GuideSet& guides);

  // Adds what was cast to `counts`, and to `pixels`, unless null, the covered ones for their light paths.
  void Cast(const Tile& tile, RayCounts& counts, std::vector<PathPixel>* pixels = nullptr) const;

 private:
  struct Hit {
    std::uint32_t object = kNothing;
    std::uint32_t primitive = 0;
    float u = 0.0f;
    float v = 0.0f;
    double x = 0.0;  // where in the picture the ray went through
    double y = 0.0;
  };
  static constexpr std::uint32_t kNothing = ~0u;
  using Hits = std::array<Hit, kTilePixels>;
  using Samples = std::bitset<kMaxAa * kMaxAa>;  // by rank: nearest the pixel's centre first

  struct Offset {
    double x;
    double y;
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
  };

  using Mask = std::bitset<kTilePixels>;

  void CastCentres(const Tile& tile, Hits& hits) const;
  Mask FindWhole(const Tile& tile, const Hits& hits) const;
  std::array<Samples, kTilePixels> CastSubsamples(const Tile& tile, const Mask& whole) const;
  std::size_t CastMissed(const Tile& tile, Samples samples, int pixel, Hit& hit) const;
  void Cover(const Tile& tile, Hits& hits, RayCounts& counts) const;
  // How far the place that was hit moves in the picture until the next frame, pixels; 0 where it is not seen then.
  glm::dvec2 MotionOf(const Hit& hit, const glm::dvec2& barycentric) const;
  SurfacePoint Write(std::size_t index, const Hit& hit) const;
  void Light(const Tile& tile, const Hits& hits, const std::vector<SurfacePoint>& points, RayCounts& counts) const;
  std::size_t Index(const Tile& tile, int pixel) const {
    return std::size_t(tile.y0 + pixel / kTileSide) * width_ + tile.x0 + pixel % kTileSide;
  }

  const EmbreeScene& scene_;
  const View& view_;
  const GuidegenOptions& options_;
  std::size_t width_;
  const LightSet lights_;
  std::vector<Offset> offsets_;  // of subsamples, by rank
  Planes planes_;
};

}  // namespace scumble
