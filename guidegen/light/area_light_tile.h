// How many samples the direct light of each pixel takes, and its rays, cast in packets.
//
// Without an allowed error every pixel takes the same number. With one, each term of a pixel's light (area_light.h)
// begins with kLeastLightSamples and doubles them until its estimated error is small enough. A pixel's decisions depend
// on its own samples and on the first samples of the pixels around it. These are in one tile of the picture's fixed
// grid, so neither threads nor the order of work change a bit.
//
// Few samples are wrong where a lamp is partly hidden, by an object or by the surface's own horizon. A pixel there may
// see all of its first samples lit by chance, so the neighbours' samples count too. If the window around a pixel has
// both lit and blocked samples of a lamp, the pixel counts as in the penumbra. Then samples that are all equal are no
// proof. Pixels at a tile's border, which know fewer neighbours, begin with twice as many.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "guidegen/light/area_light.h"
#include "guidegen/rays/progress_gate.h"

namespace scumble {

// The sampler's stream for luminance and shadow: different from that of the light paths.
inline constexpr std::uint32_t kAreaLightStream = 1;

struct AreaLightSettings {
  int samples = 64;    // of each term; with an error the most there may be
  double error = 0.0;  // as GuidegenOptions::light_error; 0: all take `samples`
  std::uint64_t seed = 0;
};

// How many pixels have which estimated error of their light, as a share of what the lamps they see would bring. Whole
// numbers, so that the order of work changes nothing.
class LightErrors {
 public:
  void Add(double error);
  LightErrors& operator+=(const LightErrors& other);
  // Nine of ten pixels have no larger error; 0 without pixels.
  double OfMost() const;

 private:
  static constexpr double kStep = 1e-3;
  std::array<std::uint32_t, 1001> pixels_{};  // by the error's steps; the last has 1 and more
};

// A covered pixel of one tile. `column` and `row` are its place in the tile, 0 … 15.
struct AreaLightPixel {
  int column = 0;
  int row = 0;
  const SurfacePoint* point = nullptr;
  std::uint32_t index = 0;   // in the picture
  double other_light = 0.0;  // luminance of lights without extent, shadows included: errors are judged beside it
  AreaLighting light;        // the result
};

// Buffers for one thread's tiles. They never change the result. Borrows the scene and the lights.
class AreaLightTile {
 public:
  static constexpr int kTileSide = 16;  // pixels

  AreaLightTile(const EmbreeScene& scene, const LightSet& lights, const AreaLightSettings& settings);

  // Lights the pixels of a tile. False if the caller cancelled; the results are then incomplete.
  bool Run(std::span<AreaLightPixel> pixels, ProgressGate& gate, RayCounts& rays);

  // Of all pixels so far whose lamps shine; none without an allowed error.
  const LightErrors& errors() const { return errors_; }

 private:
  // A term of one pixel: sums over its samples.
  struct Term {
    AreaLighting sum;
    double squares = 0.0;  // of the light without occluders
    int samples = 0;
    int wanted = 0;
    bool dark_sample = false;  // a sample brought nothing, occluders or not
    bool on_horizon = false;   // its samples and the neighbours' bring light and none, whatever is in the way
    bool in_penumbra = false;  // the pixel's own samples or its neighbours' say so
    bool IsLit() const { return sum.reached > 0.0; }
    bool MayShine() const { return sum.unoccluded > 0.0; }
    bool IsBlocked() const { return sum.unoccluded > sum.reached; }
    bool Goes() const { return samples < wanted; }
  };
  struct Pixel {
    PointLighting lighting;
    Sampler sampler{0};
  };

  std::span<Term> TermsOf(std::size_t pixel) { return std::span(terms_).subspan(pixel * term_count_, term_count_); }
  void Begin(std::span<const AreaLightPixel> pixels);
  bool Advance(std::span<AreaLightPixel> pixels, std::size_t begin, ProgressGate& gate, RayCounts& rays);
  void AddBlock(AreaLightPixel& pixel, std::size_t number, std::size_t place);
  void FindPenumbra(std::span<const AreaLightPixel> pixels);
  bool Choose(std::span<AreaLightPixel> pixels, ProgressGate& gate, RayCounts& rays);
  // The estimated variance of a pixel's light, by term and in all, and the light that it is judged beside.
  struct Doubt;
  Doubt DoubtOf(const AreaLightPixel& pixel, std::size_t number);
  void Refine(const AreaLightPixel& pixel, std::size_t number);
  double SquaredError(const Term& term, bool is_smooth) const;

  const EmbreeScene& scene_;
  const LightSet& lights_;
  const AreaLightSettings settings_;
  const bool fixed_;
  const std::vector<int> light_terms_;
  const std::size_t term_count_;  // the last is that of directions
  std::vector<Pixel> pixels_;
  std::vector<Term> terms_;  // by pixel and term
  LightErrors errors_;
  std::vector<AreaLighting> block_;  // samples of one block of pixels, by pixel, term and sample
};

}  // namespace scumble
