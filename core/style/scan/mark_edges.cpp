#include "core/style/scan/mark_edges.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "core/image/color.h"

namespace scumble {
namespace {

using Quad = std::array<glm::dvec2, 4>;

// Linear luminance between pixel centres of the whole picture. In linear light blur moves no edge.
double LightAt(const Picture& picture, glm::dvec2 at) {
  const double u = std::clamp(at.x - 0.5, 0.0, picture.width - 1.0),
               v = std::clamp(at.y - 0.5, 0.0, picture.height - 1.0);
  const int x = int(u), y = int(v), x1 = std::min(x + 1, picture.width - 1), y1 = std::min(y + 1, picture.height - 1);
  const auto light = [&](int i, int j) {
    const std::uint16_t* p = picture.At(i, j);
    return double(Luminance(Srgb16ToLinear(p[0]), Srgb16ToLinear(p[1]), Srgb16ToLinear(p[2])));
  };
  const double fx = u - x, fy = v - y;
  return (light(x, y) * (1 - fx) + light(x1, y) * fx) * (1 - fy) + (light(x, y1) * (1 - fx) + light(x1, y1) * fx) * fy;
}

// A straight line through points (along, across), each with its weight.
struct Line {
  double offset = 0, slope = 0;
  double At(double along) const { return offset + slope * along; }
};

Line FitLine(std::span<const glm::dvec2> points, std::span<const double> weights) {
  double w = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double k = weights[i];
    w += k, x += k * points[i].x, y += k * points[i].y, xx += k * points[i].x * points[i].x,
        xy += k * points[i].x * points[i].y;
  }
  const double determinant = w * xx - x * x;
  if (!(determinant > 1e-9 * w * w)) return {w > 0 ? y / w : 0.0, 0.0};
  const double slope = (w * xy - x * y) / determinant;
  return {(y - slope * x) / w, slope};
}

double Median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Tukey's weights, so that paint or dirt on a side does not bend the line.
void FitRobustLine(std::span<const glm::dvec2> points, Line& line) {
  std::vector<double> weights(points.size(), 1.0), distances(points.size());
  for (int round = 0; round < 8; ++round) {
    line = FitLine(points, weights);
    for (std::size_t i = 0; i < points.size(); ++i) distances[i] = std::abs(points[i].y - line.At(points[i].x));
    const double spread = std::max(0.01, 1.4826 * Median(distances));
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double t = distances[i] / (4.0 * spread);
      weights[i] = t < 1 ? (1 - t * t) * (1 - t * t) : 0.0;
    }
  }
}

// One side of a mark: the place, across the line between two corners, where dark becomes light.
struct Side {
  glm::dvec2 start, along, across;  // unit vectors; `across` points outward
  Line line;
  double blur = 0;
  glm::dvec2 PointAt(double t) const { return start + t * along + line.At(t) * across; }
};

// Measures a profile of light across the side. Its place is the missing light, as a length, which blur and noise do not
// move. The other result is the width of the blur.
bool MeasureEdge(const Picture& picture, glm::dvec2 at, glm::dvec2 across, double reach, double& place, double& blur) {
  const int steps = std::clamp(int(std::ceil(4 * reach)), 12, 120);
  std::vector<double> light(steps);
  double inside = 0, outside = 0;
  const int end = steps / 5;
  for (int i = 0; i < steps; ++i) {
    light[i] = LightAt(picture, at + across * (reach * (2.0 * (i + 0.5) / steps - 1.0)));
    if (i < end) inside += light[i] / end;
    if (i >= steps - end) outside += light[i] / end;
  }
  if (!(outside - inside > 0.03) || !(outside - inside > 0.2 * outside)) return false;
  const double step = 2 * reach / steps;
  double missing = 0, width = 0;
  for (const double value : light) {
    const double share = (value - inside) / (outside - inside);
    missing += (1 - share) * step;
    width += share * (1 - share) * step;
  }
  place = missing - reach;
  blur = std::max(0.0, width) * std::sqrt(std::acos(-1.0));  // of a Gaussian
  return std::abs(place) < 0.8 * reach;
}

std::optional<Side> MeasureSide(const Picture& picture, glm::dvec2 a, glm::dvec2 b, double module) {
  constexpr int kPoints = 40;
  Side side;
  const double length = glm::length(b - a);
  if (!(length > 0)) return std::nullopt;
  side.start = a, side.along = (b - a) / length;
  side.across = {side.along.y, -side.along.x};  // outward of a clockwise outline
  std::vector<glm::dvec2> points;
  std::vector<double> blurs;
  for (int i = 0; i < kPoints; ++i) {
    const double t = length * (0.06 + 0.88 * (i + 0.5) / kPoints);
    double place = 0, blur = 0;
    if (!MeasureEdge(picture, a + t * side.along, side.across, 0.75 * module, place, blur)) continue;
    points.emplace_back(t, place);
    blurs.push_back(blur);
  }
  if (points.size() < kPoints / 2) return std::nullopt;
  FitRobustLine(points, side.line);
  side.blur = Median(blurs);
  return side;
}

glm::dvec2 Crossing(const Side& a, const Side& b) {
  const glm::dvec2 p = a.PointAt(0), r = a.PointAt(1) - p, q = b.PointAt(0), s = b.PointAt(1) - q;
  const double cross = r.x * s.y - r.y * s.x;
  const glm::dvec2 d = q - p;
  return p + r * ((d.x * s.y - d.y * s.x) / cross);
}

double ModulePixels(const Quad& quad) {
  double around = 0;
  for (std::size_t i = 0; i < 4; ++i) around += glm::length(quad[(i + 1) % 4] - quad[i]);
  return around / (4 * kFiducialModules);
}

}  // namespace

bool RefineMark(const Picture& picture, FoundMark& mark) {
  Quad quad = mark.corners;
  const double module = ModulePixels(quad);
  double blur = 0;
  for (int round = 0; round < 3; ++round) {
    std::array<Side, 4> sides;
    blur = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto side = MeasureSide(picture, quad[i], quad[(i + 1) % 4], module);
      if (!side) return false;
      sides[i] = *side;
      blur += side->blur / 4;
    }
    Quad moved;
    for (std::size_t i = 0; i < 4; ++i) {
      moved[i] = Crossing(sides[(i + 3) % 4], sides[i]);
      if (!(glm::length(moved[i] - quad[i]) < 1.5 * module)) return false;
    }
    quad = moved;
  }
  mark.corners = quad, mark.module_pixels = ModulePixels(quad), mark.blur_pixels = blur;
  return true;
}

}  // namespace scumble
