// Smooth noise, hashed: the same for the same place whoever asks.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "core/image/guides.h"
#include "finish/area/float_plane.h"

namespace scumble::internal {

// Value noise, -1 … 1, with a lattice of cells of size 1; any real place.
float Noise(std::uint64_t seed, glm::vec2 at);
// The same in space. Places beyond a thousand million cells, and those that are no numbers, are 0.
float Noise(std::uint64_t seed, glm::vec3 at);

// How far a pixel of the picture reaches on the surface that it shows, in units of the layer pref. It is one number an
// object, the median of |∂pref/∂x| / depth, times the pixel's depth.
class SurfaceScale {
 public:
  // The guides hold coverage, object, depth and pref, and must outlive this.
  explicit SurfaceScale(const GuideSet& guides);

  const GuideSet& guides() const { return *guides_; }
  // 0 where nothing is, and on objects whose pref is the same everywhere.
  float At(std::size_t pixel) const { return reach_[pixel]; }

 private:
  const GuideSet* guides_;
  FloatPlane reach_;
};

// Noise over a whole picture, or over its surfaces, with waves of a given length in pixels.
//
// On surfaces it is a function of the place on the object (layer pref), so that it goes where the surface goes. Waves
// keep their length in the picture: two octaves of noise are blended by depth ("Dynamic solid textures for real-time
// coherent stylization", Bénard, Bousseau, Thollot 2009). Where the surface's scale is 0 it is noise of the picture.
class NoiseField {
 public:
  // `surface`: null for noise of the picture; it must outlive this.
  NoiseField(std::uint64_t seed, double wave, const SurfaceScale* surface, int width, int height);

  float At(int x, int y) const;

 private:
  // What is the same for all pixels of a column.
  struct Column {
    int cell;     // of the lattice
    float share;  // of the next one
  };
  float InPicture(int x, int y) const;

  std::uint64_t seed_;
  float wave_, per_wave_;
  int width_, columns_;
  std::vector<float> lattice_;  // of the picture's noise
  std::vector<Column> column_;  // by x
  const SurfaceScale* surface_;
};

}  // namespace scumble::internal
