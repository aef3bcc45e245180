// The layer `outline` against brute force.
#include "core/filter/outline_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <vector>

namespace scumble {
namespace {

GuideSet EmptyGuides(int width, int height) {
  GuideSet guides(width, height);
  for (const Layer layer : {Layer::kCoverage, Layer::kNormal, Layer::kDepth, Layer::kObject}) guides.Add(layer);
  return guides;
}

void PutDisc(glm::vec2 centre, float radius, float depth, float object, GuideSet& guides) {
  for (int y = 0; y < guides.height(); ++y) {
    for (int x = 0; x < guides.width(); ++x) {
      const std::size_t i = guides.Index(x, y);
      const bool hidden = guides.Plane(Layer::kCoverage)[i] > 0.0f && guides.Plane(Layer::kDepth)[i] < depth;
      if (glm::length(glm::vec2(float(x) + 0.5f, float(y) + 0.5f) - centre) > radius || hidden) continue;
      guides.Plane(Layer::kCoverage)[i] = 1.0f, guides.Plane(Layer::kNormal, 2)[i] = 1.0f;
      guides.Plane(Layer::kDepth)[i] = depth, guides.Plane(Layer::kObject)[i] = object;
    }
  }
}

std::vector<float> DistancesOf(GuideSet guides) {
  internal::FillOutlineDistance({0, 0, guides.width(), guides.height()}, guides);
  const auto plane = guides.Plane(Layer::kOutline);
  return {plane.begin(), plane.end()};
}

TEST(OutlineDistance, IsThatToTheRimOfADisc) {
  GuideSet guides = EmptyGuides(120, 100);
  PutDisc({60, 50}, 40.0f, 5.0f, 1.0f, guides);
  const std::vector<float> distances = DistancesOf(guides);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 120; ++x) {
      const float to_rim = 40.0f - glm::length(glm::vec2(float(x) + 0.5f, float(y) + 0.5f) - glm::vec2(60, 50));
      const float expected = guides.Plane(Layer::kCoverage)[guides.Index(x, y)] > 0.0f ? to_rim : 0.0f;
      ASSERT_NEAR(distances[guides.Index(x, y)], expected, 1.1f) << x << ' ' << y;
    }
  }
}

// Of its own object, and where it is the nearer of two.
TEST(OutlineDistance, EqualsBruteForce) {
  GuideSet guides = EmptyGuides(90, 70);
  PutDisc({45, 40}, 60.0f, 9.0f, 1.0f, guides);
  PutDisc({30, 30}, 17.0f, 5.0f, 2.0f, guides);
  PutDisc({52, 38}, 14.0f, 4.0f, 3.0f, guides);
  PutDisc({80, 60}, 14.0f, 6.0f, 2.0f, guides);
  const std::vector<float> distances = DistancesOf(guides);
  const auto object = guides.Plane(Layer::kObject), depth = guides.Plane(Layer::kDepth);
  const auto is_border = [&](int x, int y) {
    for (const auto& [dx, dy] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
      if (x + dx < 0 || y + dy < 0 || x + dx >= 90 || y + dy >= 70) continue;
      const std::size_t p = guides.Index(x, y), q = guides.Index(x + dx, y + dy);
      if (object[p] != object[q] && (object[q] == 0.0f || depth[p] <= depth[q])) return true;
    }
    return false;
  };
  double off = 0.0;
  for (int y = 0; y < 70; ++y) {
    for (int x = 0; x < 90; ++x) {
      const std::size_t p = guides.Index(x, y);
      if (object[p] != 2.0f && object[p] != 3.0f) continue;
      float nearest = internal::kMostOutlineDistance;
      for (int v = 0; v < 70; ++v) {
        for (int u = 0; u < 90; ++u) {
          if (object[guides.Index(u, v)] == object[p] && is_border(u, v))
            nearest = std::min(nearest, std::hypot(float(x - u), float(y - v)) + 0.5f);
        }
      }
      ASSERT_NEAR(distances[p], nearest, 0.3f) << x << ' ' << y;
      off = std::max(off, double(std::fabs(distances[p] - nearest)));
    }
  }
  EXPECT_LT(off, 0.3);
}

TEST(OutlineDistance, TheObjectBehindHasNoOutlineThere) {
  GuideSet guides = EmptyGuides(80, 60);
  PutDisc({40, 30}, 100.0f, 9.0f, 1.0f, guides);  // fills the picture
  PutDisc({40, 30}, 10.0f, 5.0f, 2.0f, guides);
  const std::vector<float> distances = DistancesOf(guides);
  EXPECT_EQ(distances[guides.Index(55, 30)], internal::kMostOutlineDistance);
  EXPECT_EQ(distances[guides.Index(0, 0)], internal::kMostOutlineDistance) << "the picture's edge is none";
  EXPECT_NEAR(distances[guides.Index(40, 30)], 10.0f, 1.0f);
}

TEST(OutlineDistance, StepsInDepthCountOnTheNearerSide) {
  GuideSet guides = EmptyGuides(60, 20);
  PutDisc({30, 10}, 100.0f, 9.0f, 1.0f, guides);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) guides.Plane(Layer::kDepth)[guides.Index(x, y)] = 5.0f;
  }
  const std::vector<float> distances = DistancesOf(guides);
  EXPECT_EQ(distances[guides.Index(19, 10)], 0.5f);
  EXPECT_EQ(distances[guides.Index(9, 10)], 10.5f);
}

TEST(OutlineDistance, EmptyAndSmall) {
  EXPECT_EQ(DistancesOf(EmptyGuides(7, 5)), std::vector<float>(35, 0.0f));
  GuideSet one = EmptyGuides(1, 1);
  PutDisc({0.5f, 0.5f}, 1.0f, 5.0f, 1.0f, one);
  EXPECT_EQ(DistancesOf(one), std::vector<float>{internal::kMostOutlineDistance});
}

}  // namespace
}  // namespace scumble
