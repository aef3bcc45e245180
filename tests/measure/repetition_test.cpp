// Repetition and seams of pictures with a known answer.
#include "measure/repetition.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "bench/wall_measures.h"
#include "core/image/hash.h"

namespace scumble {
namespace {

// Each pixel a grey of its own, coming back every `tile_x` × `tile_y` pixels; 0: never.
Picture TiledNoise(int size, int tile_x, int tile_y) {
  Picture picture(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const auto grey = static_cast<std::uint16_t>(Hash(tile_x ? x % tile_x : x, tile_y ? y % tile_y : y) & 0xffff);
      std::uint16_t* pixel = picture.At(x, y);
      pixel[0] = pixel[1] = pixel[2] = grey, pixel[3] = 65535;
    }
  }
  return picture;
}

TEST(Autocorrelation, ATiledPicturePeaksAtItsTile) {
  const AutocorrelationPeak peak = HighestAutocorrelation(TiledNoise(96, 20, 300), {0, 0, 96, 96});
  EXPECT_NEAR(peak.value, 1.0, 1e-6);
  EXPECT_EQ(std::abs(peak.dx) % 20, 0);
  EXPECT_EQ(peak.dy, 0);
  const AutocorrelationPeak tall = HighestAutocorrelation(TiledNoise(96, 300, 31), {3, 1, 90, 90});
  EXPECT_NEAR(tall.value, 1.0, 1e-6);
  EXPECT_EQ(tall.dx, 0);
  EXPECT_EQ(tall.dy, 31);
}

TEST(Autocorrelation, ARandomPictureHasNoPeakAndAFlatOneNone) {
  EXPECT_LT(HighestAutocorrelation(TiledNoise(96, 0, 0), {0, 0, 96, 96}).value, 0.12);
  Picture flat(64, 64);
  EXPECT_EQ(HighestAutocorrelation(flat, {0, 0, 64, 64}).value, 0.0);
  EXPECT_EQ(HighestAutocorrelation(flat, {0, 0, 4, 4}).value, 0.0) << "no shift is left";
}

// Squares of `side` pixels of one grey each, and on them noise that never comes back, or does so every `tile` pixels.
Picture Patches(int size, int side, int tile) {
  Picture picture(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const std::uint64_t patch = Hash(x / side, y / side, 1) % 15000, grain = Hash(tile ? x % tile : x, y) % 6000;
      std::uint16_t* pixel = picture.At(x, y);
      pixel[0] = pixel[1] = pixel[2] = static_cast<std::uint16_t>(15000 + patch + grain), pixel[3] = 65535;
    }
  }
  return picture;
}

TEST(Autocorrelation, SubtractingABlurLeavesRepeatedStrokesAndDropsPatchesOfTone) {
  const PictureRegion all{0, 0, 128, 128};
  AutocorrelationOptions high;
  high.subtract_sigma = 2.0;
  const Picture patches = Patches(128, 40, 0);
  EXPECT_GT(HighestAutocorrelation(patches, all).value, 0.6) << "patches alone look like repetition";
  EXPECT_LT(HighestAutocorrelation(patches, all, high).value, 0.25);
  // Repeated white noise keeps its peak: both copies lose the same blur, but at the rim.
  const AutocorrelationPeak tiled = HighestAutocorrelation(TiledNoise(128, 20, 300), all, high);
  EXPECT_GT(tiled.value, 0.99);
  EXPECT_EQ(std::abs(tiled.dx) % 20, 0);
  EXPECT_LT(HighestAutocorrelation(TiledNoise(128, 0, 0), all, high).value, 0.1);
  Picture flat(64, 64);
  EXPECT_EQ(HighestAutocorrelation(flat, {0, 0, 64, 64}, high).value, 0.0);
}

TEST(ToneSpread, IsTheDeviationOfTheBlurredLightness) {
  // Two halves, of L = 0 and 1: the deviation is 1/2, less at the border, where the blur mixes them.
  Picture halves(200, 100);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 200; ++x) {
      std::uint16_t* pixel = halves.At(x, y);
      pixel[0] = pixel[1] = pixel[2] = x < 100 ? 0 : 65535, pixel[3] = 65535;
    }
  }
  EXPECT_NEAR(ToneSpread(halves, {0, 0, 200, 100}, 0.0), 0.5, 1e-4);
  // A step under a Gaussian is the normal distribution Φ(x / σ); the mean of 1/4 − (Φ − 1/2)² over all x is σ / √π.
  EXPECT_NEAR(ToneSpread(halves, {0, 0, 200, 100}, 8.0), std::sqrt(0.25 - 8.0 / std::sqrt(3.14159265) / 200.0), 2e-3);
  // White noise keeps 1 / (2 σ √π) of its deviation.
  const PictureRegion all{0, 0, 256, 256};
  const double noise = ToneSpread(TiledNoise(256, 0, 0), all, 0.0);
  EXPECT_NEAR(ToneSpread(TiledNoise(256, 0, 0), all, 3.0) / noise, 1.0 / (2.0 * 3.0 * std::sqrt(3.14159265)), 0.012);
  EXPECT_EQ(ToneSpread(Picture(50, 50), {5, 5, 40, 40}, 4.0), 0.0);
}

// Chunks of `side` pixels; the source of each is given by `from`, in an exemplar of noise.
struct Wall {
  static constexpr int kSize = 64;
  std::vector<std::int16_t> x, y;
  std::vector<std::uint8_t> covered = std::vector<std::uint8_t>(kSize * kSize, 1);

  Wall(int side, bool same_place) {
    for (int v = 0; v < kSize; ++v) {
      for (int u = 0; u < kSize; ++u) {
        x.push_back(static_cast<std::int16_t>(same_place ? u % side : u));
        y.push_back(static_cast<std::int16_t>(same_place ? v % side : v));
      }
    }
  }
  SourcePlanes Planes() const { return {kSize, kSize, x, y, covered, {}}; }
};

TEST(SourceRepetition, CountsHowOftenASourceShows) {
  EXPECT_DOUBLE_EQ(SourceRepetition(Wall(64, true).Planes()), 1.0);
  EXPECT_DOUBLE_EQ(SourceRepetition(Wall(16, true).Planes()), 16.0);
  EXPECT_DOUBLE_EQ(SourceRepetition(Wall(16, false).Planes()), 1.0);
  Wall none(16, true);
  none.covered.assign(none.covered.size(), 0);
  EXPECT_EQ(SourceRepetition(none.Planes()), 0.0);
}

// A flat wall, of one object.
GuideSet FlatGuides() {
  GuideSet guides(Wall::kSize, Wall::kSize);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject}) guides.Add(layer);
  for (float& z : guides.Plane(Layer::kNormal, 2)) z = 1.0f;
  for (float& object : guides.Plane(Layer::kObject)) object = 1.0f;
  return guides;
}

TEST(Seams, AreTheExcessAlongBorders) {
  const Wall wall(16, true);
  const GuideSet guides = FlatGuides();
  // White noise: neighbours differ as much inside as across.
  const SeamStrength noise = MeasureSeams(TiledNoise(64, 0, 0), wall.Planes(), guides);
  EXPECT_EQ(noise.border_pairs, 2u * 3 * 64);
  EXPECT_NEAR(noise.excess, 0.0, 0.1);
  // A ramp inside each tile that jumps back at its end: 15 steps across against 1 inside, along rows only.
  Picture ramp(64, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      std::uint16_t* pixel = ramp.At(x, y);
      pixel[0] = pixel[1] = pixel[2] = static_cast<std::uint16_t>(20000 + 500 * (x % 16)), pixel[3] = 65535;
    }
  }
  const SeamStrength seams = MeasureSeams(ramp, wall.Planes(), guides);
  EXPECT_NEAR(seams.along_borders / seams.inside, 15.0, 0.8);
  EXPECT_NEAR(seams.excess, seams.along_borders / seams.inside - 1.0, 1e-12);
  EXPECT_EQ(MeasureSeams(ramp, Wall(64, true).Planes(), guides).excess, 0.0) << "one chunk has no borders";
}

// The tiles' borders at rows and columns of 16, 32 and 48 are the surface's own: an object ends there, or it turns.
TEST(Seams, AreNotWhereTheSurfaceItselfEndsOrTurns) {
  const Wall wall(16, true);
  const Picture noise = TiledNoise(64, 0, 0);
  GuideSet objects = FlatGuides(), folded = FlatGuides(), gentle = FlatGuides();
  for (int y = 0; y < Wall::kSize; ++y) {
    for (int x = 0; x < Wall::kSize; ++x) {
      const std::size_t i = objects.Index(x, y);
      objects.Plane(Layer::kObject)[i] = static_cast<float>(1 + x / 16);
      const bool odd = (x / 16) % 2;
      folded.Plane(Layer::kNormal, 0)[i] = odd ? 0.28f : 0.0f, folded.Plane(Layer::kNormal, 2)[i] = odd ? 0.96f : 1.0f;
      gentle.Plane(Layer::kNormal, 0)[i] = odd ? 0.25f : 0.0f;
      gentle.Plane(Layer::kNormal, 2)[i] = odd ? 0.96824584f : 1.0f;
    }
  }
  EXPECT_EQ(MeasureSeams(noise, wall.Planes(), objects).border_pairs, 3u * 64);
  EXPECT_EQ(MeasureSeams(noise, wall.Planes(), folded).border_pairs, 3u * 64) << "16 degrees";
  EXPECT_EQ(MeasureSeams(noise, wall.Planes(), gentle).border_pairs, 2u * 3 * 64) << "14.5 degrees";
}

}  // namespace
}  // namespace scumble
