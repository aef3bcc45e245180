#include "core/style/kit/kit_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/glm.hpp>
#include <numbers>
#include <vector>

#include "core/image/check.h"
#include "core/image/direction.h"

namespace scumble {
namespace {

using Color = std::array<std::uint16_t, 3>;
constexpr Color Rgb(int r, int g, int b) {
  return {static_cast<std::uint16_t>(r * 257), static_cast<std::uint16_t>(g * 257),
          static_cast<std::uint16_t>(b * 257)};
}
constexpr Color kBlue = Rgb(30, 90, 220), kOrange = Rgb(235, 130, 20), kRed = Rgb(220, 30, 40),
                kGreen = Rgb(20, 140, 90), kViolet = Rgb(150, 50, 190);

// Thin enough not to disturb, thick enough to be seen when the whole template fits a screen.
double LineWidth(int size) { return std::max(1.2, size / 450.0); }

// The coverage of a pixel by a line at `distance` pixels from its centre.
double Covered(double distance, double width) { return std::clamp(0.5 + width / 2 - distance, 0.0, 1.0); }

// Where two lines meet, the stronger one shows: their sum would make blots.
void Draw(Picture& picture, int x, int y, const Color& color, double opacity) {
  const auto alpha = static_cast<std::uint16_t>(std::lround(opacity * 65535.0));
  std::uint16_t* pixel = picture.At(x, y);
  if (alpha <= pixel[3]) return;
  std::copy(color.begin(), color.end(), pixel);
  pixel[3] = alpha;
}

struct ContourLine {
  std::function<double(glm::dvec3)> value;  // of a point on the unit sphere; the line is where it is 0
  Color color;
  double width;
  std::function<bool(glm::dvec3)> where = {};  // parts of the sphere that have the line; empty: all
};

// Draws lines on the front of the sphere. A pixel's distance from a line follows from the value there and in the pixels
// around.
void DrawOnSphere(Picture& picture, int size, const std::vector<ContourLine>& lines) {
  const int margin = TemplateMargin(size);
  const double step = 2.0 / size;
  const auto on_sphere = [](double u, double v) {
    return glm::dvec3(u, v, std::sqrt(std::max(0.0, 1.0 - u * u - v * v)));
  };
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double u = (x + 0.5) * step - 1.0, v = 1.0 - (y + 0.5) * step;
      if (u * u + v * v >= 1.0) continue;
      const glm::dvec3 here = on_sphere(u, v);
      for (const ContourLine& line : lines) {
        if (line.where && !line.where(here)) continue;
        const double value = line.value(here);
        const double du = line.value(on_sphere(u + step / 2, v)) - line.value(on_sphere(u - step / 2, v));
        const double dv = line.value(on_sphere(u, v + step / 2)) - line.value(on_sphere(u, v - step / 2));
        const double change = std::hypot(du, dv);  // a pixel
        if (change > 0.0)
          Draw(picture, margin + x, margin + y, line.color, Covered(std::abs(value) / change, line.width));
      }
    }
  }
}

Picture Empty(int size) {
  const int side = size + 2 * TemplateMargin(size);
  return Picture(side, side);
}

// Puts the result of `color` for each covered pixel of the guides onto the template.
Picture DrawCovered(const KitLight& light, const std::function<Color(std::size_t)>& color) {
  const GuideSet& guides = light.guides;
  SCUMBLE_CHECK_EQ(guides.width(), guides.height());
  const int size = guides.width(), margin = TemplateMargin(size);
  Picture picture = Empty(size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const std::size_t i = guides.Index(x, y);
      if (guides.Plane(Layer::kCoverage)[i] > 0.0f) Draw(picture, margin + x, margin + y, color(i), 1.0);
    }
  }
  return picture;
}

}  // namespace

Picture DrawEdgeLine(int size) {
  Picture picture = Empty(size);
  const double centre = picture.width / 2.0, width = LineWidth(size);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double distance = std::hypot(x + 0.5 - centre, y + 0.5 - centre) - size / 2.0;
      Draw(picture, x, y, kViolet, Covered(std::abs(distance), width));
    }
  }
  return picture;
}

Picture DrawLightLines(int size, double azimuth, double elevation) {
  const glm::dvec3 light = DirectionFromAngles(azimuth, elevation), half = light + glm::dvec3(0, 0, 1);
  const double thin = LineWidth(size);
  std::vector<ContourLine> lines;
  for (const double level : {0.25, 0.5, 0.75}) {
    lines.push_back({[=](glm::dvec3 n) { return glm::dot(n, light) - level; }, kOrange, thin});
  }
  lines.push_back({[=](glm::dvec3 n) { return glm::dot(n, light); }, kBlue, 2 * thin});
  // A light straight behind the sphere has no highlight.
  if (glm::length(half) > 1e-6) {
    constexpr double kRingDegrees = 6.0;
    const glm::dvec3 mirror = glm::normalize(half);
    const double ring = std::cos(glm::radians(kRingDegrees));
    lines.push_back({[=](glm::dvec3 n) { return glm::dot(n, mirror) - ring; }, kRed, 1.5 * thin});
  }
  Picture picture = Empty(size);
  DrawOnSphere(picture, size, lines);
  return picture;
}

Picture DrawContourLines(int size) {
  constexpr double kLean = 25.0, kStep = 15.0,
                   kLastLatitude = 75.0;  // closer to the pole longitudes would run together
  const double lean = glm::radians(kLean), step = glm::radians(kStep), last = glm::radians(kLastLatitude);
  const glm::dvec3 pole(0, std::cos(lean), std::sin(lean)), front(0, -std::sin(lean), std::cos(lean));
  const auto latitude = [=](glm::dvec3 n) { return std::asin(std::clamp(glm::dot(n, pole), -1.0, 1.0)); };
  const auto longitude = [=](glm::dvec3 n) { return std::atan2(n.x, glm::dot(n, front)); };
  // A wave that is 0 at every multiple of the step, and smooth all round the globe.
  const auto wave = [=](double angle) { return std::sin(std::numbers::pi * angle / step); };
  Picture picture = Empty(size);
  DrawOnSphere(picture, size,
               {{[=](glm::dvec3 n) { return wave(latitude(n)); }, kGreen, LineWidth(size),
                 [=](glm::dvec3 n) { return std::abs(latitude(n)) < last + step / 2; }},
                {[=](glm::dvec3 n) { return wave(longitude(n)); }, kGreen, LineWidth(size),
                 [=](glm::dvec3 n) { return std::abs(latitude(n)) < last; }}});
  return picture;
}

Picture DrawFiveTones(const KitLight& light) {
  constexpr int kTones = 5;
  const Picture lit = DrawLitSphere(light);
  const int size = light.guides.width(), margin = TemplateMargin(size);
  const auto grey = [&](std::size_t i) {
    return lit.At(margin + int(i % std::size_t(size)), margin + int(i / std::size_t(size)))[0];
  };
  std::uint16_t darkest = 65535, lightest = 0;
  for (std::size_t i = 0; i < light.guides.pixel_count(); ++i) {
    if (light.guides.Plane(Layer::kCoverage)[i] < 1.0f) continue;
    darkest = std::min(darkest, grey(i)), lightest = std::max(lightest, grey(i));
  }
  const double range = std::max(1.0, double(lightest) - darkest);
  return DrawCovered(light, [&](std::size_t i) {
    const int tone = std::clamp(int((grey(i) - darkest) / range * kTones), 0, kTones - 1);
    const auto value = static_cast<std::uint16_t>(std::lround(darkest + range * (tone + 0.5) / kTones));
    return Color{value, value, value};
  });
}

Picture DrawNormalColors(const KitLight& light) {
  return DrawCovered(light, [&](std::size_t i) {
    const glm::vec3 normal = light.guides.Vec3(Layer::kNormal, i);
    Color color;
    for (int c = 0; c < 3; ++c) {
      color[c] = static_cast<std::uint16_t>(std::lround(std::clamp(0.5f + 0.5f * normal[c], 0.0f, 1.0f) * 65535.0f));
    }
    return color;
  });
}

}  // namespace scumble
