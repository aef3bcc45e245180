// Smooth noise, hashed: the same for the same place whoever asks.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "finish/finish.h"

namespace scumble::internal {

// Value noise, -1 … 1, with a lattice of cells of size 1; any real place.
float Noise(std::uint64_t seed, glm::vec2 at);
// The same in space. Places beyond a thousand million cells, and those that are no numbers, are 0.
float Noise(std::uint64_t seed, glm::vec3 at);

// Noise over a whole picture, or over its surfaces, with waves of a given length in pixels.
//
// On surfaces it is a function of the place on the object (layer pref), so that it goes where the surface goes. Waves
// keep their length in the picture: two octaves of noise are blended by depth ("Dynamic solid textures for real-time
// coherent stylization", Bénard, Bousseau, Thollot 2009). How large an object's units are in the picture is one number
// an object, the median of |∂pref/∂x| / depth. Where that is 0 and where nothing is, it is noise of the picture.
class NoiseField {
 public:
  // `stick`: on surfaces; the frame's guides then hold coverage, object, depth and pref.
  NoiseField(std::uint64_t seed, double wave, bool stick, const FinishFrame& frame, int width, int height);

  float At(int x, int y) const;

 private:
  float InPicture(glm::vec2 at) const;

  std::uint64_t seed_;
  float per_wave_;
  int width_, columns_;
  std::vector<float> lattice_;        // of the picture's noise
  const GuideSet* guides_ = nullptr;  // null: of the picture alone
  std::vector<float> wave_;           // by pixel, in units of pref; 0: there is none
};

}  // namespace scumble::internal
