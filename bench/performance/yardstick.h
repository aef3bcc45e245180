// The yardstick that the engine's speed is measured against: the parallel StyleBlit of Sýkora et al. (Computer Graphics
// Forum 38, 2019, section 3.2 and its pseudo-code; votes by section 3.3) written down directly from the paper: one
// pixel after the other, one thread, scalar, in float. Built with -O3 -march=native for this file alone.
//
// It has none of our optimisations, and no step is slower than in the paper:
//   - seeds come from a table of jitter, like the authors'; it is made outside the clock where jitter is frozen;
//   - background is skipped, unlike in the authors' demo;
//   - u* of a seed is the sphere's formula and no search, and squares of distances are compared instead of roots;
//   - on level 0 a pixel is its own seed, so it takes its own u* without looking for the nearest of nine;
//   - buffers are kept from frame to frame.
// It follows the engine's rules (DESIGN §6: hashed seeds, ties, the rim), so both must give the same picture, bit for
// bit. It is independent: no code of the engine is built with that file's flags.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace scumble::bench {

// Borrowed planes of width × height floats, rows from the top; normals are unit vectors where coverage is above 0.
struct YardstickGuides {
  int width = 0;
  int height = 0;
  const float* coverage = nullptr;
  const float* normal_x = nullptr;
  const float* normal_y = nullptr;
  const float* normal_z = nullptr;
};

// Borrowed opaque paint of a sphere that fills size × size texels of RGBA, 16 bits each.
struct YardstickExemplar {
  int size = 0;
  double rim = 0.0;  // texels at the painted edge that are never used
  const std::uint16_t* rgba = nullptr;
};

struct YardstickSettings {
  int levels = 7;
  float threshold = 0.125f;
  std::uint64_t seed = 0;
};

// The source of a pixel's paint; x is kNoSource on background.
struct YardstickSource {
  static constexpr std::int16_t kNoSource = -1;
  std::int16_t x = kNoSource;
  std::int16_t y = 0;
};

// For frames of one size. Not to be shared between threads.
class Yardstick {
 public:
  Yardstick(int width, int height, const YardstickExemplar& exemplar, const YardstickSettings& settings);

  // Makes the table of jitter for a time step. Call it before the first frame, and again when jitter is renewed.
  void RenewJitter(std::int64_t time_step);

  // Match, then vote at radius 1. Writes all of `rgba`: 4 · width · height values, sRGB-encoded as the paint is,
  // straight alpha; background is 0.
  void Paint(const YardstickGuides& guides, std::uint16_t* rgba);

  const std::vector<YardstickSource>& sources() const { return sources_; }  // of the last frame

 private:
  struct Pixel {
    int x = 0;
    int y = 0;
  };
  struct Normal {
    float x = 0.0f, y = 0.0f, z = 0.0f;
  };
  struct Place {
    float x = 0.0f;
    float y = 0.0f;
  };
  // Jitter of one level's cells, one more around the picture's.
  struct JitterTable {
    int columns = 0;
    int rows = 0;
    std::vector<Place> cells;
  };

  Place SeedPoint(Place p, float h, const JitterTable& table) const;
  Place NearestSeed(Place p, int level) const;
  bool Usable(Pixel u) const;
  Normal OnDisc(Normal n) const;  // only x and y are
  Normal ComparedAt(const YardstickGuides& guides, std::size_t i) const;
  Pixel BestSource(Normal n) const;
  Pixel NearestUsable(float nx, float ny, Pixel from) const;
  Pixel MatchPixel(const YardstickGuides& guides, Pixel p) const;
  void VotePixel(Pixel p, std::uint16_t* rgb) const;

  int width_;
  int height_;
  YardstickExemplar exemplar_;
  YardstickSettings settings_;
  std::int64_t usable_squared_ = 0;  // squared usable radius in half texels
  float usable_radius_ = 0.0f;       // the same as a share of the sphere's
  std::vector<JitterTable> jitter_;  // by level
  std::vector<YardstickSource> sources_;
};

}  // namespace scumble::bench
