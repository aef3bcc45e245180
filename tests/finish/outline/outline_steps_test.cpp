// Steps in depth along outlines, against bodies whose depth is known: what is one, and what is a surface that turns.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/finish/finish_fixtures.h"

namespace scumble {
namespace {

// Pixels are squares of kPixel metres five metres before the eye.
constexpr int kColumns = 160, kRows = 80;
constexpr float kPixel = 0.05f, kDistance = 5.0f;

// What is seen behind a block.
struct Behind {
  float away = 0.0f;   // pixels, behind the block's rim; 0: nothing is there
  float slope = 0.0f;  // of its depth along the picture, upwards
};

// A wall that faces the viewer. Its upper edge is round, of that radius in pixels, and climbs through the rows of
// pixels.
GuideSet RoundedWall(float radius, float climb, const Behind& behind, bool has_perspective) {
  GuideCamera camera;
  glm::dmat4& clip = camera.clip_from_view;
  const double scale = (has_perspective ? kDistance : 1.0) * 2.0 / kPixel;
  clip[0][0] = scale / kColumns, clip[1][1] = scale / kRows;
  if (has_perspective) clip[2][3] = -1.0, clip[3][3] = 0.0;
  const glm::vec2 up = glm::normalize(glm::vec2(-climb, 1.0f));
  const float r = radius * kPixel;
  GuideSet guides = GuidesOf(kColumns, kRows, [&](glm::vec2 at) {
    const glm::vec2 place = glm::vec2(at.x - kColumns / 2.0f, kRows / 2.0f - at.y) * kPixel;
    // A line of sight is (high + rises t, t). The centre of the round edge is at (0, kDistance).
    const float rises = has_perspective ? glm::dot(place, up) / kDistance : 0.0f;
    const float high = has_perspective ? 0.0f : glm::dot(place, up);
    const float front = (kDistance - r), in_front = high + rises * front;
    if (in_front <= 0.0f) return SeenPoint{true, {0, 0, 1}, front, 1.0f};
    const float a = 1.0f + rises * rises, b = high * rises - kDistance;
    const float root = b * b - a * (high * high + kDistance * kDistance - r * r);
    if (root > 0.0f) {
      const float t = (-b - std::sqrt(root)) / a;
      const glm::vec2 normal = glm::vec2(high + rises * t, kDistance - t) / r;
      return SeenPoint{true, {up * normal.x, normal.y}, t, 1.0f};
    }
    if (behind.away == 0.0f) return SeenPoint{};
    // Its depth is far + slope (height - r).
    const float far = kDistance + behind.away * kPixel;
    const float t = (far + behind.slope * (high - r)) / (1.0f - behind.slope * rises);
    const float length = std::sqrt(1.0f + behind.slope * behind.slope);
    return SeenPoint{true, {up * behind.slope / length, 1.0f / length}, t, 1.0f};
  });
  guides.camera = camera;
  return guides;
}

// By column: the ink of steps in depth alone, in pixels.
std::vector<double> InkOfSteps(const GuideSet& guides) {
  OutlinePass pass;
  for (double& width : pass.of_class) width = 0.0;
  pass.of_class[std::size_t(LineClass::kOcclusion)] = 1.0;
  pass.width = 2.0;
  const Picture drawn = Finished(StepOf(pass), &guides, Picture(guides.width(), guides.height()));
  std::vector<double> ink(std::size_t(guides.width()));
  for (std::size_t i = 0; i < guides.pixel_count(); ++i)
    ink[i % std::size_t(guides.width())] += drawn.rgba[4 * i + 3] / 65535.0;
  return ink;
}

// However few pixels the edge has, and wherever they lie, the wall has no step: its outline is the silhouette.
TEST(OutlineSteps, ARoundEdgeHasNone) {
  for (const bool has_perspective : {true, false}) {
    for (const float radius : {0.5f, 1.0f, 1.5f, 2.0f, 3.0f, 5.0f, 8.0f}) {
      for (const float climb : {0.0f, 0.03f, 0.13f, 0.7f}) {
        const std::vector<double> ink = InkOfSteps(RoundedWall(radius, climb, {}, has_perspective));
        EXPECT_EQ(std::ranges::count(ink, 0.0), kColumns) << has_perspective << ' ' << radius << ' ' << climb;
      }
    }
  }
}

// In front of more of the object it has one all along, also where that is a floor seen at a small angle.
TEST(OutlineSteps, ARoundEdgeInFrontOfItsObjectHasOne) {
  for (const bool has_perspective : {true, false}) {
    for (const float radius : {0.5f, 1.0f, 2.0f, 5.0f}) {
      // In perspective a steeper floor has its horizon within the picture.
      const float floor = has_perspective ? 1.5f : 4.0f;
      for (const Behind& behind : {Behind{8.0f, 0.0f}, Behind{16.0f, floor}, Behind{16.0f, -floor}}) {
        const float climb = 0.13f;
        const std::vector<double> ink = InkOfSteps(RoundedWall(radius, climb, behind, has_perspective));
        for (std::size_t x = 2; x + 2 < kColumns; ++x) {
          EXPECT_NEAR(ink[x], 2.0, 0.3) << has_perspective << ' ' << radius << ' ' << behind.slope << ' ' << x;
        }
      }
    }
  }
}

// The tolerance of a step at kDistance, in metres, and the share of it at which a step still goes on.
constexpr float kFullStep = 0.002f * kDistance, kWeakStep = 0.25f;

// Two faces of one object that face the viewer. The upper one lies behind, by so many full steps at that column. The
// border climbs through the rows of pixels. Depths err by up to a tenth of a full step.
template <class Steps>
GuideSet Fold(float climb, const Steps& steps_at) {
  GuideSet guides = GuidesOf(kColumns, kRows, [&](glm::vec2 at) {
    const bool is_behind = kRows / 2.0f - at.y + climb * (at.x - kColumns / 2.0f) > 0.0f;
    return SeenPoint{true, {0, 0, 1}, kDistance + (is_behind ? steps_at(at.x) * kFullStep : 0.0f), 1.0f};
  });
  std::uint32_t state = 1;
  for (float& depth : guides.Plane(Layer::kDepth)) {
    state = state * 1664525u + 1013904223u;
    depth += (static_cast<float>(state >> 8) / float(1 << 23) - 1.0f) * 0.1f * kFullStep;
  }
  return guides;
}

// A step that falls to nothing has one line, up to where it falls below a quarter of a full one.
TEST(OutlineSteps, TheLineOfAFoldThatFadesHasNoGaps) {
  constexpr float kFirst = 4.0f, kColumnsPerStep = kColumns / kFirst;
  const auto fading = [](float x) { return kFirst - x / kColumnsPerStep; };
  for (const float climb : {0.0f, 0.03f, 0.13f, 0.41f, -0.3f}) {
    const std::vector<double> ink = InkOfSteps(Fold(climb, fading));
    std::size_t end = 0;
    while (end < ink.size() && ink[end] > 0.0) ++end;
    // Both pixels beside the border err.
    EXPECT_GE(float(end), kColumnsPerStep * (kFirst - kWeakStep - 0.2f) - 2.0f) << climb;
    EXPECT_LE(float(end), kColumnsPerStep * (kFirst - kWeakStep + 0.2f) + 2.0f) << climb;
    EXPECT_EQ(std::count(ink.begin() + std::ptrdiff_t(end), ink.end(), 0.0), std::ptrdiff_t(ink.size() - end)) << climb;
    const double across = 2.0 * std::sqrt(1.0 + double(climb) * double(climb));
    for (std::size_t x = 2; x + 3 < end; ++x) EXPECT_NEAR(ink[x], across, 0.4) << climb << ' ' << x;
  }
}

// Depths as half floats lie on terraces, whose borders are no steps, wherever a line ends.
TEST(OutlineSteps, RoundingToHalfFloatsHasNoLines) {
  constexpr float kFirst = 4.0f, kColumnsPerStep = kColumns / kFirst;
  for (const float tilt : {0.1f, 0.3f, 0.6f}) {
    for (const float turn : {0.0f, 0.5f, -0.7f}) {
      GuideSet guides = GuidesOf(kColumns, kRows, [&](glm::vec2 at) {
        const float fold = at.y < kRows / 2.0f ? (kFirst - at.x / kColumnsPerStep) * kFullStep : 0.0f;
        const float slope = tilt * (at.x / kColumns + turn * at.y / kRows);
        return SeenPoint{true, {0, 0, 1}, kDistance + slope + fold, 1.0f};
      });
      for (float& depth : guides.Plane(Layer::kDepth))
        depth = std::bit_cast<float>(std::bit_cast<std::uint32_t>(depth) & ~0x1fffu);
      const std::vector<double> ink = InkOfSteps(guides);
      for (std::size_t x = 0; x < ink.size(); ++x) EXPECT_LE(ink[x], 2.5) << tilt << ' ' << turn << ' ' << x;
    }
  }
}

// One that is nowhere a full one has no line, however long it is.
TEST(OutlineSteps, WeakStepsAloneHaveNone) {
  for (const float climb : {0.0f, 0.13f, 0.41f}) {
    const std::vector<double> ink = InkOfSteps(Fold(climb, [](float) { return 0.75f; }));
    EXPECT_EQ(std::ranges::count(ink, 0.0), kColumns) << climb;
    // Nor beyond a gap of many pixels.
    const auto two = [](float x) { return x < 60.0f ? 3.0f : x < 80.0f ? 0.0f : 0.75f; };
    const std::vector<double> half = InkOfSteps(Fold(climb, two));
    EXPECT_EQ(std::count(half.begin() + 64, half.end(), 0.0), kColumns - 64) << climb;
  }
}

}  // namespace
}  // namespace scumble
