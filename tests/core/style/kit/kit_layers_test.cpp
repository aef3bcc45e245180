// The lines and steps of light that a painter switches on, against plain geometry.
#include "core/style/kit/kit_layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <set>
#include <vector>

#include "core/image/color.h"
#include "core/image/direction.h"
#include "tests/support/sphere_guides.h"

namespace scumble {
namespace {

constexpr int kSize = 200;

struct Point {
  double x, y;  // in pixels of the template
};

// Where a point of the unit sphere lies in the template.
Point OnTemplate(glm::dvec3 n) {
  const double centre = TemplateMargin(kSize) + kSize / 2.0;
  return {centre + n.x * kSize / 2, centre - n.y * kSize / 2};
}

double Nearest(const std::vector<Point>& points, double x, double y) {
  double least = 1e9;
  for (const Point& point : points) least = std::min(least, std::hypot(point.x - x, point.y - y));
  return least;
}

enum class Hue { kRed, kBlue, kOther };
Hue HueOf(const std::uint16_t* pixel) {
  if (pixel[2] > pixel[0] && pixel[2] > pixel[1]) return Hue::kBlue;
  return pixel[1] < 16000 ? Hue::kRed : Hue::kOther;
}

// Every point well inside the disc has its pixel drawn, and every drawn pixel of that colour is near a point.
void ExpectDrawn(const Picture& picture, const std::vector<Point>& points,
                 const std::function<bool(const std::uint16_t*)>& is_line, double width) {
  const double centre = picture.width / 2.0;
  for (const Point& point : points) {
    if (std::hypot(point.x - centre, point.y - centre) > 0.95 * kSize / 2) continue;  // lines run together at the rim
    EXPECT_GT(picture.At(int(point.x), int(point.y))[3], 20000) << point.x << ", " << point.y;
  }
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const std::uint16_t* pixel = picture.At(x, y);
      if (pixel[3] < 6000 || !is_line(pixel) || std::hypot(x + 0.5 - centre, y + 0.5 - centre) > 0.95 * kSize / 2)
        continue;
      EXPECT_LT(Nearest(points, x + 0.5, y + 0.5), width / 2 + 0.9) << x << ", " << y;
    }
  }
}

// Points of the circle on the sphere that lies `degrees` from a pole, those on the front.
std::vector<Point> Circle(glm::dvec3 pole, double degrees) {
  const glm::dvec3 aside =
      glm::normalize(glm::cross(pole, std::abs(pole.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
  const glm::dvec3 across = glm::cross(pole, aside);
  const double c = std::cos(glm::radians(degrees)), s = std::sin(glm::radians(degrees));
  std::vector<Point> points;
  constexpr int kSteps = 4000;
  for (int i = 0; i < kSteps; ++i) {
    const double t = 2 * std::numbers::pi * i / kSteps;
    const glm::dvec3 n = c * pole + s * (std::cos(t) * aside + std::sin(t) * across);
    if (n.z > 0) points.push_back(OnTemplate(n));
  }
  return points;
}

TEST(GuideLayers, TheTerminatorIsWhereLightEnds) {
  for (const auto& [azimuth, elevation] : {std::pair{-40.0, 40.0}, {120.0, -10.0}, {90.0, 0.0}, {10.0, 80.0}}) {
    const Picture picture = DrawLightLines(kSize, azimuth, elevation);
    ExpectDrawn(
        picture, Circle(DirectionFromAngles(azimuth, elevation), 90), [](auto* p) { return HueOf(p) == Hue::kBlue; },
        2.4);
  }
}

TEST(GuideLayers, TheRingIsAroundTheHighlight) {
  const glm::dvec3 light = DirectionFromAngles(-40, 40);
  const glm::dvec3 mirror = glm::normalize(light + glm::dvec3(0, 0, 1));
  // A polished sphere shows the light where the view is reflected towards it.
  EXPECT_NEAR(glm::distance(2 * mirror.z * mirror - glm::dvec3(0, 0, 1), light), 0, 1e-12);
  ExpectDrawn(
      DrawLightLines(kSize, -40, 40), Circle(mirror, 6), [](auto* p) { return HueOf(p) == Hue::kRed; }, 1.8);
}

TEST(GuideLayers, EqualLightIsAtItsAngles) {
  std::vector<Point> points;
  for (const double level : {0.25, 0.5, 0.75}) {
    const auto circle = Circle(DirectionFromAngles(-40, 40), glm::degrees(std::acos(level)));
    points.insert(points.end(), circle.begin(), circle.end());
  }
  ExpectDrawn(
      DrawLightLines(kSize, -40, 40), points, [](auto* p) { return HueOf(p) == Hue::kOther; }, 1.2);
}

TEST(GuideLayers, ALampBehindHasNoHighlight) {
  const Picture picture = DrawLightLines(kSize, 180, 0);
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    if (picture.rgba[i + 3] > 0) {
      EXPECT_NE(HueOf(&picture.rgba[i]), Hue::kRed);
    }
  }
}

TEST(GuideLayers, ContoursAreAGlobes) {
  const double lean = glm::radians(25.0), step = glm::radians(15.0);
  const glm::dvec3 pole(0, std::cos(lean), std::sin(lean)), front(0, -std::sin(lean), std::cos(lean)), right(1, 0, 0);
  std::vector<Point> points;
  const auto add = [&](double latitude, double longitude) {
    const glm::dvec3 n =
        std::sin(latitude) * pole + std::cos(latitude) * (std::cos(longitude) * front + std::sin(longitude) * right);
    if (n.z > 0) points.push_back(OnTemplate(n));
  };
  for (int line = -12; line <= 12; ++line) {
    for (int i = -1000; i <= 1000; ++i) {
      if (std::abs(line) <= 5) add(line * step, i / 1000.0 * std::numbers::pi);
      add(i / 1000.0 * 5 * step, line * step);
    }
  }
  ExpectDrawn(
      DrawContourLines(kSize), points, [](auto*) { return true; }, 1.2);
}

TEST(GuideLayers, TheEdgeIsTheDisc) {
  const Picture picture = DrawEdgeLine(kSize);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double from_edge = std::hypot(x + 0.5 - picture.width / 2.0, y + 0.5 - picture.width / 2.0) - kSize / 2.0;
      if (std::abs(from_edge) < 0.1) {
        EXPECT_EQ(picture.At(x, y)[3], 65535);
      }
      if (std::abs(from_edge) > 1.1) {
        EXPECT_EQ(picture.At(x, y)[3], 0);
      }
    }
  }
}

TEST(GuideLayers, FiveTonesKeepTheOrderOfLight) {
  const KitLight light{-45, 35, SphereGuides(kSize)};
  const Picture lit = DrawLitSphere(light), tones = DrawFiveTones(light);
  std::set<int> greys;
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t i = 0; i < lit.rgba.size(); i += 4) {
    ASSERT_EQ(tones.rgba[i + 3], lit.rgba[i + 3]);
    if (lit.rgba[i + 3] == 0) continue;
    greys.insert(tones.rgba[i]);
    pairs.emplace_back(lit.rgba[i], tones.rgba[i]);
  }
  EXPECT_EQ(greys.size(), 5u);
  std::sort(pairs.begin(), pairs.end());
  for (std::size_t i = 1; i < pairs.size(); ++i) ASSERT_LE(pairs[i - 1].second, pairs[i].second);
  // Equal steps to the eye: in the encoding, not in light.
  const std::vector<int> sorted(greys.begin(), greys.end());
  for (int i = 1; i < 5; ++i)
    EXPECT_NEAR(sorted[i] - sorted[i - 1], (pairs.back().first - pairs.front().first) / 5.0, 2);
}

TEST(GuideLayers, NormalsAreTheGuides) {
  const KitLight light{-45, 35, SphereGuides(kSize)};
  const Picture picture = DrawNormalColors(light);
  const int margin = TemplateMargin(kSize);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const std::size_t i = light.guides.Index(x, y);
      const std::uint16_t* pixel = picture.At(margin + x, margin + y);
      ASSERT_EQ(pixel[3] > 0, light.guides.Plane(Layer::kCoverage)[i] > 0);
      if (pixel[3] == 0) continue;
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(pixel[c] / 65535.0 * 2 - 1, light.guides.Vec3(Layer::kNormal, i)[c], 1e-4);
    }
  }
}

}  // namespace
}  // namespace scumble
