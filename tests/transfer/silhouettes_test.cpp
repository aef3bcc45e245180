// The distance field of outlines, against an exhaustive search.
#include "transfer/rim/silhouettes.h"

#include <cmath>
#include <tuple>

#include "core/image/color.h"
#include "core/image/oklab.h"
#include "core/painting/bare_paper.h"
#include "tests/support/transfer_fixtures.h"

namespace scumble {
namespace {

using namespace testing;
using internal::OutlinePixel;
using internal::Silhouettes;

// Overlapping discs, some hardly before others, in two styles of which the second keeps exact silhouettes.
GuideSet Discs(int width, int height) {
  GuideSet guides = MakeGuides(width, height, [](int, int) { return glm::vec3(0.0f); });
  for (int n = 0; n < 24; ++n) {
    const std::uint64_t hash = Hash(n, 7);
    const double cx = UnitFloat(hash) * width, cy = UnitFloat(Mix64(hash)) * height,
                 radius = 6 + 40 * UnitFloat(Hash(n, 9));
    const float depth = 8.0f + 0.07f * static_cast<float>(Hash(n, 3) % 40);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const std::size_t i = guides.Index(x, y);
        if (std::hypot(x + 0.5 - cx, y + 0.5 - cy) > radius || depth > guides.Plane(Layer::kDepth)[i]) continue;
        guides.Plane(Layer::kCoverage)[i] = 1.0f, guides.Plane(Layer::kNormal, 2)[i] = 1.0f;
        guides.Plane(Layer::kDepth)[i] = depth, guides.Plane(Layer::kObject)[i] = static_cast<float>(n + 1);
      }
    }
  }
  return guides;
}

TEST(Silhouettes, TheNearestOutlineIsTheOneThatASearchOfAllFinds) {
  const GuideSet guides = Discs(260, 200);
  std::vector<std::uint16_t> style(guides.pixel_count());
  for (std::size_t i = 0; i < style.size(); ++i)
    style[i] = static_cast<int>(guides.Plane(Layer::kObject)[i]) % 4 == 3 ? 1 : 0;
  const int bands[] = {6, 0};
  const Silhouettes silhouettes({guides, style, bands, {0, 0, 260, 200}, 20});
  ASSERT_GT(silhouettes.outline().size(), 500u);
  int found = 0;
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 260; ++x) {
      std::int32_t best = Silhouettes::kNone;
      std::tuple<int, int, int> least;
      for (std::size_t k = 0; k < silhouettes.outline().size(); ++k) {
        const OutlinePixel& at = silhouettes.outline()[k];
        if (!silhouettes.Concerns(at, x, y)) continue;
        const std::tuple key((at.x - x) * (at.x - x) + (at.y - y) * (at.y - y), at.x, at.y);
        if (best == Silhouettes::kNone || key < least) best = static_cast<std::int32_t>(k), least = key;
      }
      ASSERT_EQ(silhouettes.Nearest(x, y), best) << x << ", " << y;
      found += best != Silhouettes::kNone;
    }
  }
  EXPECT_GT(found, 2000);
}

TEST(Silhouettes, APartKnowsWhatTheWholeKnows) {
  const GuideSet guides = Discs(260, 200);
  const int bands[] = {6};
  const Silhouettes whole({guides, {}, bands, {0, 0, 260, 200}, 30}), part({guides, {}, bands, {70, 60, 150, 130}, 30});
  for (int y = 60; y < 130; ++y) {
    for (int x = 70; x < 150; ++x) {
      const std::int32_t a = whole.Nearest(x, y), b = part.Nearest(x, y);
      ASSERT_EQ(a == Silhouettes::kNone, b == Silhouettes::kNone) << x << ", " << y;
      if (a == Silhouettes::kNone) continue;
      const OutlinePixel &p = whole.outline()[std::size_t(a)], &q = part.outline()[std::size_t(b)];
      ASSERT_TRUE(p.x == q.x && p.y == q.y && p.point == q.point && p.outward == q.outward && p.width == q.width);
    }
  }
}

// On a disc the point of the outline is on the circle and outward is along the radius, closer than pixels are.
TEST(Silhouettes, PointsAndDirectionsAreThoseOfACircle) {
  const double radius = 70.3;
  const GuideSet guides = MakeGuides(200, 200, [=](int x, int y) {
    return std::hypot(x + 0.5 - 100, y + 0.5 - 100) < radius ? glm::vec3(0, 0, 1) : glm::vec3(0.0f);
  });
  const int bands[] = {8};
  const Silhouettes silhouettes({guides, {}, bands, {0, 0, 200, 200}, 0});
  for (const OutlinePixel& pixel : silhouettes.outline()) {
    const double dx = pixel.point.x - 100, dy = pixel.point.y - 100, r = std::hypot(dx, dy);
    EXPECT_NEAR(r, radius, 0.4);
    EXPECT_GT((pixel.outward.x * dx + pixel.outward.y * dy) / r, std::cos(0.06));
    EXPECT_TRUE(pixel.open);
    EXPECT_EQ(pixel.width, 1.0f);
  }
}

// Lifted paint over its paper is the picture again, and paper is nothing.
TEST(BarePaper, LiftedPaintOverItsPaperIsThePicture) {
  const BarePaper paper = BarePaper::OfColor({0.7f, 0.6f, 0.45f});
  int compared = 0;
  for (int n = 0; n < 2000; ++n) {
    std::uint16_t texel[4] = {std::uint16_t(Hash(n, 0)), std::uint16_t(Hash(n, 1)), std::uint16_t(Hash(n, 2)), 65535};
    const std::uint16_t before[3] = {texel[0], texel[1], texel[2]};
    LiftPaint(paper, texel);
    const glm::vec3 off =
        OklabFromLinear({Srgb16ToLinear(before[0]), Srgb16ToLinear(before[1]), Srgb16ToLinear(before[2])}) -
        OklabFromLinear(paper.color);
    const float alpha = static_cast<float>(texel[3]) / 65535.0f;
    for (int c = 0; c < 3; ++c) {
      const float linear = Srgb16ToLinear(texel[c]) * alpha + paper.color[c] * (1.0f - alpha);
      if (glm::length(off) > 0.15f) {
        EXPECT_NEAR(linear, Srgb16ToLinear(before[c]), 0.002f) << n;
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 1000);
  std::uint16_t bare[4] = {Srgb16FromLinear(0.69f), Srgb16FromLinear(0.6f), Srgb16FromLinear(0.46f), 65535};
  LiftPaint(paper, bare);
  EXPECT_EQ(bare[3], 0);
}

}  // namespace
}  // namespace scumble
