// The flat surfaces of a picture, on a scene whose surfaces are known.
#include "measure/flat_surfaces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>

namespace scumble {
namespace {

constexpr int kReach = 4;

GuideSet Empty(int width, int height) {
  GuideSet guides(width, height);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kObject}) guides.Add(layer);
  return guides;
}

void Put(GuideSet& guides, int x, int y, glm::vec3 normal, float object) {
  const std::size_t i = guides.Index(x, y);
  guides.Plane(Layer::kCoverage)[i] = 1.0f, guides.Plane(Layer::kObject)[i] = object;
  for (int c = 0; c < 3; ++c) guides.Plane(Layer::kNormal, c)[i] = normal[c];
}

// A wall that fills the picture is flat everywhere: what lies outside does not count against it.
TEST(FlatSurfaces, OfAWallAreAllItsPixels) {
  GuideSet guides = Empty(20, 15);
  for (int y = 0; y < 15; ++y) {
    for (int x = 0; x < 20; ++x) Put(guides, x, y, {0.0f, 0.6f, 0.8f}, 1.0f);
  }
  const auto flat = FlatSurfaces(guides, kReach);
  for (std::size_t i = 0; i < flat.size(); ++i) EXPECT_EQ(flat[i], 1) << i;
}

// A cylinder's normal turns by more than half a degree over four pixels anywhere: sin(0.5°) of its radius are 0.3
// pixels.
TEST(FlatSurfaces, OfACylinderAreNone) {
  constexpr int kSize = 64;
  GuideSet guides = Empty(kSize, kSize);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const float across = (2.0f * float(x) + 1.0f - kSize) / kSize;
      Put(guides, x, y, {across, 0.0f, std::sqrt(1.0f - across * across)}, 1.0f);
    }
  }
  for (const std::uint8_t is_flat : FlatSurfaces(guides, kReach)) EXPECT_EQ(is_flat, 0);
}

// Two walls that meet in a line, of one object or of two with one normal: both are flat up to it, since flat places lie
// a reach away on either side. A strip as narrow as the reach is not flat: any chunk that begins there ends beyond.
TEST(FlatSurfaces, EndWhereTheNormalOrTheObjectChanges) {
  const glm::vec3 left(0.0f, 0.0f, 1.0f), right(0.0f, 0.6f, 0.8f);
  for (const bool by_object : {false, true}) {
    for (const int strip : {kReach, 3 * kReach}) {
      GuideSet guides = Empty(40, 30);
      for (int y = 0; y < 30; ++y) {
        for (int x = 0; x < 40; ++x) {
          const bool inside = x >= 14 && x < 14 + strip;
          Put(guides, x, y, inside && !by_object ? right : left, inside && by_object ? 2.0f : 1.0f);
        }
      }
      const auto flat = FlatSurfaces(guides, kReach);
      for (int y = 0; y < 30; ++y) {
        for (int x = 0; x < 40; ++x) {
          const bool is_strip = x >= 14 && x < 14 + strip;
          EXPECT_EQ(flat[guides.Index(x, y)], !is_strip || strip > kReach)
              << x << ", " << y << " of a strip of " << strip;
        }
      }
    }
  }
}

// A board of three reaches on nothing, which has its normal and object but covers no pixel: all of the board, its
// corners too, and no more.
TEST(FlatSurfaces, OfABoardAreItsPixelsUpToTheCorners) {
  GuideSet guides = Empty(30, 26);
  const auto on_board = [](int x, int y) { return x >= 8 && x < 20 && y >= 7 && y < 20; };
  for (int y = 0; y < 26; ++y) {
    for (int x = 0; x < 30; ++x) {
      Put(guides, x, y, {0.0f, 0.0f, 1.0f}, 1.0f);
      guides.Plane(Layer::kCoverage)[guides.Index(x, y)] = on_board(x, y) ? 1.0f : 0.0f;
    }
  }
  const auto flat = FlatSurfaces(guides, kReach);
  for (int y = 0; y < 26; ++y) {
    for (int x = 0; x < 30; ++x) EXPECT_EQ(flat[guides.Index(x, y)], on_board(x, y)) << x << ", " << y;
  }
}

TEST(FlatSurfaces, OfNothingAreNone) {
  for (const std::uint8_t is_flat : FlatSurfaces(Empty(7, 5), kReach)) EXPECT_EQ(is_flat, 0);
}

}  // namespace
}  // namespace scumble
