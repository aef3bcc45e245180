// The quick parts of outlines against plain ones: which pairs of pixels have a border, and what strokes cover.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/image/hash.h"
#include "finish/outline/border_map.h"
#include "finish/outline/strokes.h"
#include "tests/finish/finish_fixtures.h"

namespace scumble {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinite = std::numeric_limits<float>::infinity();

// Mostly one flat surface; here and there another object, a step, a crease, a hole, a value that is none.
GuideSet PatchyGuides(int width, int height) {
  GuideSet guides = FlatGuides(width, height);
  for (const Layer layer : {Layer::kMaterial, Layer::kAlbedo}) {
    if (guides.Has(layer)) continue;
    guides.Add(layer);
    for (int c = 0; c < ChannelCount(layer); ++c) std::ranges::fill(guides.Plane(layer, c), 0.5f);
  }
  for (std::size_t i = 0; i < guides.pixel_count(); ++i) {
    const std::uint64_t chance = Hash(7, i);
    const float unit = UnitFloat(Hash(8, i));
    switch (chance % 40) {
      case 0:
        guides.Plane(Layer::kCoverage)[i] = unit < 0.5f ? 0.0f : unit;
        break;
      case 1:
        guides.Plane(Layer::kDepth)[i] = 5.0f + 0.04f * unit;
        break;
      case 2:
        guides.Plane(Layer::kDepth)[i] = unit < 0.5f ? kInfinite : kNan;
        break;
      case 3:
        guides.Plane(Layer::kObject)[i] = std::floor(3.0f * unit);
        break;
      case 4:
        guides.Plane(Layer::kMaterial)[i] = std::floor(3.0f * unit);
        break;
      case 5:
        guides.Plane(Layer::kShadow)[i] = unit < 0.1f ? kNan : unit;
        break;
      case 6:
        guides.Plane(Layer::kNormal, 0)[i] = std::sqrt(unit);
        guides.Plane(Layer::kNormal, 2)[i] = std::sqrt(1.0f - unit);
        break;
      case 7:
        guides.Plane(Layer::kNormal, 1)[i] = kNan;
        break;
      default:
        break;
    }
  }
  return guides;
}

// Where base colours count, each pair is looked at; of one colour they make no lines.
TEST(BorderMap, PairsThatArePassedOverHaveNoBorder) {
  for (const glm::ivec2 size : {glm::ivec2(131, 67), glm::ivec2(1, 40), glm::ivec2(40, 1), glm::ivec2(1, 1)}) {
    const GuideSet guides = PatchyGuides(size.x, size.y);
    const auto shadow = guides.Plane(Layer::kShadow);
    for (const double others : {0.0, 1.0}) {
      OutlinePass pass;
      for (const LineClass line : {LineClass::kMaterial, LineClass::kShadow}) pass.of_class[std::size_t(line)] = others;
      pass.of_class[std::size_t(LineClass::kTexture)] = 0.0;
      OutlinePass all = pass;
      all.of_class[std::size_t(LineClass::kTexture)] = 1.0;
      const internal::BorderMap quick = internal::FindBorders(pass, guides, 1.0, {}, shadow),
                                plain = internal::FindBorders(all, guides, 1.0, {}, shadow);
      EXPECT_EQ(quick.right, plain.right) << size.x << ' ' << others;
      EXPECT_EQ(quick.below, plain.below) << size.x << ' ' << others;
      if (size.x > 100) {
        EXPECT_GT(std::ranges::count_if(quick.right, [](int border) { return border != 0; }), 300);
        EXPECT_GT(std::ranges::count(quick.right, 0), 5000);
      }
    }
  }
}

float ShareOfPiece(const internal::StrokePiece& piece, glm::vec2 at) {
  const glm::vec2 along = piece.to - piece.from;
  const float squared = glm::dot(along, along);
  const float t = squared > 0.0f ? std::clamp(glm::dot(at - piece.from, along) / squared, 0.0f, 1.0f) : 0.0f;
  const float thick = piece.from_width + (piece.to_width - piece.from_width) * t;
  const float inside = std::max(thick, 1.0f) / 2.0f + 0.5f - glm::length(at - piece.from - along * t);
  return std::clamp(inside, 0.0f, 1.0f) * std::min(thick, 1.0f);
}

TEST(Strokes, CoverWhatTheNearestPointOfEachPieceSays) {
  for (const glm::ivec2 size : {glm::ivec2(61, 47), glm::ivec2(5, 90), glm::ivec2(64, 3)}) {
    std::vector<internal::StrokePiece> pieces;
    for (std::uint32_t i = 0; i < 60; ++i) {
      const auto chance = [&](int k) { return UnitFloat(Hash(3, i, k)); };
      const glm::vec2 from = glm::vec2(chance(0), chance(1)) * glm::vec2(size) * 1.4f - glm::vec2(size) * 0.2f;
      glm::vec2 step = 24.0f * (glm::vec2(chance(2), chance(3)) - 0.5f);
      if (i % 7 == 0) step.x = 0.0f;
      if (i % 7 == 1) step.y = 0.0f;
      if (i % 7 == 2) step = glm::vec2(0.0f);
      if (i % 7 == 3) step.y *= 1e-4f;
      const float most = i % 3 == 0 ? 14.0f : 2.0f;
      pieces.push_back({from, from + step, most * chance(4), most * chance(5), i});
    }
    const internal::StrokeCover cover = internal::CoverOf(pieces, size.x, size.y, true);
    EXPECT_EQ(internal::CoverOf(pieces, size.x, size.y, false).share, cover.share);
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        const glm::vec2 at(float(x) + 0.5f, float(y) + 0.5f);
        float most = 0.0f;
        for (const auto& piece : pieces) most = std::max(most, ShareOfPiece(piece, at));
        const std::size_t i = std::size_t(y * size.x + x);
        EXPECT_NEAR(cover.share[i], most, 2e-5f) << x << ' ' << y;
        if (!(most > 0.01f)) continue;
        EXPECT_NEAR(ShareOfPiece(pieces[cover.owner[i]], at), most, 2e-5f) << x << ' ' << y;
      }
    }
  }
}

}  // namespace
}  // namespace scumble
