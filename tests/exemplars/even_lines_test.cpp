// The paint program's evenly spaced lines, against distances measured one by one.
#include "exemplars/paint/engine/even_lines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace scumble::paint {
namespace {

constexpr float kSpacing = 20.0f;

Flow Level() {
  return [](glm::vec2) { return glm::vec2(1.0f, 0.0f); };
}

TEST(EvenLines, ParallelOnesFillTheSheetAtTheirSpacing) {
  Chance chance(5, 1);
  const std::vector<Stroke> lines = PlanEvenLines(chance, Level(), [](glm::vec2) { return kSpacing; });
  std::vector<float> heights;
  for (const Stroke& line : lines) {
    heights.push_back(line.front().at.y);
    // From one margin to the other: there is no obstacle.
    EXPECT_LT(line.front().at.x, -80.0f);
    EXPECT_GT(line.back().at.x, kSide + 80.0f);
  }
  std::sort(heights.begin(), heights.end());
  ASSERT_GT(heights.size(), 30u);
  EXPECT_LT(heights.front(), kSpacing - 90.0f);
  EXPECT_GT(heights.back(), kSide + 90.0f - kSpacing);
  for (std::size_t i = 1; i < heights.size(); ++i) {
    EXPECT_GE(heights[i] - heights[i - 1], 0.97f * kSpacing);
    // Twice the spacing would be room for one more.
    EXPECT_LT(heights[i] - heights[i - 1], 1.97f * kSpacing);
  }
}

// The least distance between points of different lines.
float Nearest(const std::vector<Stroke>& lines) {
  float nearest = kSide;
  for (std::size_t a = 0; a < lines.size(); ++a) {
    for (std::size_t b = a + 1; b < lines.size(); ++b) {
      for (const StrokePoint& p : lines[a]) {
        for (const StrokePoint& q : lines[b]) nearest = std::min(nearest, glm::distance(p.at, q.at));
      }
    }
  }
  return nearest;
}

TEST(EvenLines, EndBeforeTheyMeet) {
  // All run towards one point, and so towards one another.
  const glm::vec2 goal(500.0f, -300.0f);
  const Flow flow = [=](glm::vec2 at) { return (goal - at) / glm::distance(goal, at); };
  const Touch spacing = [](glm::vec2 at) { return at.y > 200.0f && at.y < 700.0f ? 30.0f : 0.0f; };
  for (const float closest : {0.4f, 0.8f}) {
    Chance chance(5, 2);
    const std::vector<Stroke> lines = PlanEvenLines(chance, flow, spacing, {.closest = closest});
    ASSERT_GT(lines.size(), 20u);
    EXPECT_GE(Nearest(lines), closest * 30.0f);
    EXPECT_LT(Nearest(lines), closest * 30.0f + 4.0f) << "they might have gone on";
    for (const Stroke& line : lines) {
      for (const StrokePoint& point : line) EXPECT_GT(spacing(point.at), 0.0f);
    }
  }
}

TEST(EvenLines, AFlowInCirclesEnds) {
  const Flow flow = [](glm::vec2 at) {
    const glm::vec2 arm = at - 512.0f;
    return glm::vec2(-arm.y, arm.x) / std::max(glm::length(arm), 1e-3f);
  };
  Chance chance(5, 3);
  const auto lines = PlanEvenLines(
      chance, flow, [](glm::vec2 at) { return glm::distance(at, glm::vec2(512.0f)) < 300.0f ? 50.0f : 0.0f; });
  EXPECT_GE(lines.size(), 3u);
}

}  // namespace
}  // namespace scumble::paint
