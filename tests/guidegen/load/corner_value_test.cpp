// Hashes of corners' values: a file of a million corners is read in time only if nearly all of them differ.
#include "guidegen/load/corner_value.h"

#include <gtest/gtest.h>

#include <unordered_set>

namespace scumble {
namespace {

TEST(CornerValue, HashesOfValuesBetween0And1Differ) {
  std::unordered_set<std::size_t> uvs, colors;
  constexpr int kSide = 128;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const float u = float(x) / kSide, v = float(y) / kSide - 0.5f;
      CornerValue uv, color;
      uv.uv = glm::vec2(u, v);
      color.color = glm::vec4(u, 0.25f, v + 0.5f, 1.0f);
      uvs.insert(CornerValueHash()(uv));
      colors.insert(CornerValueHash()(color));
    }
  }
  EXPECT_GT(uvs.size(), std::size_t(kSide * kSide - 10));
  EXPECT_GT(colors.size(), std::size_t(kSide * kSide - 10));
}

TEST(CornerValue, EqualValuesHaveOneHash) {
  CornerValue zero, negative;
  zero.uv = glm::vec2(0.0f);
  negative.uv = glm::vec2(-0.0f, 0.0f);
  ASSERT_EQ(zero, negative);
  EXPECT_EQ(CornerValueHash()(zero), CornerValueHash()(negative));
}

}  // namespace
}  // namespace scumble
