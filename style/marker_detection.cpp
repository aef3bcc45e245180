#include "style/marker_detection.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <optional>

#include "image/color.h"
#include "style/dark_squares.h"
#include "style/homography.h"

namespace scumble {
namespace {

constexpr int kModules = kFiducialModules;
// Five bits part any two markers: what is one bit off is still told surely.
constexpr int kMostWrongBits = 1, kMostWrongBorder = 2;
// Where the layout says which marker it must be, more may be hidden by paint.
constexpr int kMostHiddenBits = 4, kMostHiddenBorder = 6;

// The picture's brightness at 1 / `factor` of its size, each pixel the mean of factor² encoded ones.
GreyPlane Reduced(const Picture& picture, int factor) {
  GreyPlane plane{picture.width / factor, picture.height / factor, {}};
  plane.values.reserve(std::size_t(plane.width) * plane.height);
  for (int y = 0; y < plane.height; ++y) {
    for (int x = 0; x < plane.width; ++x) {
      std::uint64_t sum = 0;
      for (int j = 0; j < factor; ++j) {
        const std::uint16_t* pixel = picture.At(x * factor, y * factor + j);
        for (int i = 0; i < factor; ++i, pixel += 4) sum += 2 * pixel[0] + 5 * pixel[1] + pixel[2];
      }
      plane.values.push_back(float(double(sum) / (8.0 * 65535.0 * factor * factor)));
    }
  }
  return plane;
}

// Linear luminance between pixel centres of the whole picture. Linear, because there blur moves no edge.
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

// A marker as its modules' brightness shows it.
struct Reading {
  std::array<bool, kModules * kModules> black{};
  int wrong_border = 0;
  bool clear = false;  // dark and light are well apart
  std::uint16_t Bits() const {
    std::uint16_t bits = 0;
    for (int row = 1; row <= 4; ++row) {
      for (int column = 1; column <= 4; ++column)
        bits = static_cast<std::uint16_t>(bits << 1 | !black[row * kModules + column]);
    }
    return bits;
  }
};

// The level that parts the values best into two groups (Otsu 1979).
double BestSplit(std::vector<double> values, double& between) {
  std::sort(values.begin(), values.end());
  const double total = std::accumulate(values.begin(), values.end(), 0.0);
  double below = 0, best = -1, level = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    below += values[i - 1];
    const double low = below / double(i), high = (total - below) / double(values.size() - i);
    const double gain = double(i) * double(values.size() - i) * (high - low) * (high - low);
    if (gain > best) best = gain, level = (values[i - 1] + values[i]) / 2, between = high - low;
  }
  return level;
}

// `brightness` at points of the plane in which the quad's corners lie.
template <class Brightness>
std::optional<Reading> Read(const Quad& quad, const Brightness& brightness) {
  const std::array<glm::dvec2, 4> square{{{0, 0}, {kModules, 0}, {kModules, kModules}, {0, kModules}}};
  const auto map = FitHomography(square, quad);
  if (!map) return std::nullopt;
  std::vector<double> means(kModules * kModules, 0.0);
  for (int i = 0; i < kModules * kModules; ++i) {
    for (int k = 0; k < 9; ++k) {
      const glm::dvec2 at(i % kModules + 0.5 + 0.22 * (k % 3 - 1), i / kModules + 0.5 + 0.22 * (k / 3 - 1));
      means[i] += brightness(Project(*map, at)) / 9;
    }
  }
  double apart = 0;
  const double level = BestSplit(means, apart);
  Reading reading;
  reading.clear = apart > 0.08 && apart > 0.15 * *std::max_element(means.begin(), means.end());
  for (int i = 0; i < kModules * kModules; ++i) {
    reading.black[i] = means[i] < level;
    const int column = i % kModules, row = i / kModules;
    const bool border = std::min(column, row) == 0 || std::max(column, row) == kModules - 1;
    reading.wrong_border += border && !reading.black[i];
  }
  return reading;
}

// The bits after a quarter turn clockwise.
std::uint16_t Turned(std::uint16_t bits) {
  std::uint16_t turned = 0;
  for (int i = 0; i < 16; ++i)
    turned = static_cast<std::uint16_t>(turned << 1 | (bits >> (15 - (4 * (3 - i % 4) + i / 4)) & 1));
  return turned;
}

// The marker that a quad holds, corners put in printed order.
std::optional<FoundMark> Identify(const Quad& quad, std::uint16_t bits, bool mirrored) {
  for (int id = 0; id < kFiducialCount; ++id) {
    std::uint16_t turned = FiducialBits(id);
    for (std::size_t turn = 0; turn < 4; ++turn, turned = Turned(turned)) {
      const int wrong = std::popcount(unsigned(turned ^ bits));
      if (wrong > kMostWrongBits) continue;
      FoundMark mark;
      mark.id = id, mark.mirrored = mirrored, mark.wrong_bits = wrong;
      for (std::size_t i = 0; i < 4; ++i) mark.corners[i] = quad[(i + turn) % 4];
      return mark;
    }
  }
  return std::nullopt;
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

// Tukey's weights, so that paint or dirt on a side does not bend it. Returns the spread of the points that count.
double FitRobustLine(std::span<const glm::dvec2> points, Line& line) {
  std::vector<double> weights(points.size(), 1.0), distances(points.size());
  double spread = 0;
  for (int round = 0; round < 8; ++round) {
    line = FitLine(points, weights);
    for (std::size_t i = 0; i < points.size(); ++i) distances[i] = std::abs(points[i].y - line.At(points[i].x));
    spread = std::max(0.01, 1.4826 * Median(distances));
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double t = distances[i] / (4.0 * spread);
      weights[i] = t < 1 ? (1 - t * t) * (1 - t * t) : 0.0;
    }
  }
  return spread;
}

// One side of a mark: where, across the line between two corners, dark becomes light.
struct Side {
  glm::dvec2 start, along, across;  // unit vectors; `across` points outward
  Line line;
  double error = 0;  // of the line's ends
  double blur = 0;
  glm::dvec2 PointAt(double t) const { return start + t * along + line.At(t) * across; }
};

// A profile of light across the side: the place of the change (the light that is missing, as a length, which blur and
// noise do not move) and how blurred it is.
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
  const double spread = FitRobustLine(points, side.line);
  side.error = 2.0 * spread / std::sqrt(double(points.size()));
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
  return around / (4 * kModules);
}

// Lays the corners anew through the sides. False, and the mark as it was, where a side cannot be made out.
bool Refine(const Picture& picture, FoundMark& mark) {
  // A mirrored mark's printed order runs the other way round.
  Quad quad = mark.corners;
  if (mark.mirrored) std::reverse(quad.begin(), quad.end());
  const double module = ModulePixels(quad);
  double error = 0, blur = 0;
  for (int round = 0; round < 3; ++round) {
    std::array<Side, 4> sides;
    error = blur = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto side = MeasureSide(picture, quad[i], quad[(i + 1) % 4], module);
      if (!side) return false;
      sides[i] = *side;
      error = std::max(error, side->error), blur += side->blur / 4;
    }
    Quad moved;
    for (std::size_t i = 0; i < 4; ++i) {
      moved[i] = Crossing(sides[(i + 3) % 4], sides[i]);
      if (!(glm::length(moved[i] - quad[i]) < 1.5 * module)) return false;
    }
    quad = moved;
  }
  mark.module_pixels = ModulePixels(quad), mark.blur_pixels = blur, mark.corner_pixels = error;
  if (mark.mirrored) std::reverse(quad.begin(), quad.end());
  mark.corners = quad;
  return true;
}

glm::dvec2 Middle(const Quad& quad) { return (quad[0] + quad[1] + quad[2] + quad[3]) / 4.0; }

// All marks at one scale of the picture.
void SearchAt(const Picture& picture, int factor, MarkSearch& search, std::vector<glm::dvec2>& unknown) {
  const GreyPlane plane = Reduced(picture, factor);
  const auto brightness = [&](glm::dvec2 at) { return double(plane.Between(at)); };
  constexpr double kLeastSide = 9;
  for (const int radius : {5, 14, 40}) {
    for (Quad quad : FindDarkSquares(plane, radius, kLeastSide)) {
      const auto reading = Read(quad, brightness);
      if (!reading || !reading->clear || reading->wrong_border > kMostWrongBorder) continue;
      // The same seen in a mirror: the corners the other way round.
      const Quad reversed{quad[1], quad[0], quad[3], quad[2]};
      std::optional<FoundMark> mark = Identify(quad, reading->Bits(), false);
      if (!mark) mark = Identify(reversed, Read(reversed, brightness)->Bits(), true);
      const auto near = [&](glm::dvec2 other) {
        return glm::length(Middle(quad) * double(factor) - other) < 2.0 * ModulePixels(quad) * factor;
      };
      if (!mark) {
        if (std::none_of(unknown.begin(), unknown.end(), near)) unknown.push_back(Middle(quad) * double(factor));
        continue;
      }
      for (glm::dvec2& corner : mark->corners) corner *= factor;
      const bool known = std::any_of(search.marks.begin(), search.marks.end(),
                                     [&](const FoundMark& other) { return near(Middle(other.corners)); });
      if (!known && Refine(picture, *mark)) search.marks.push_back(*mark);
    }
  }
}

}  // namespace

MarkSearch FindMarks(const Picture& picture) {
  MarkSearch search;
  std::vector<glm::dvec2> unknown;
  int last_factor = 0;
  // From small to large: most marks are seen soonest in a small picture, where noise is gone; small ones need more
  // pixels.
  for (const int longest : {900, 1800, 3600, 7200}) {
    const int factor = (std::max(picture.width, picture.height) + longest - 1) / longest;
    if (factor == last_factor || picture.empty()) continue;
    last_factor = factor;
    SearchAt(picture, factor, search, unknown);
    if (search.marks.size() >= std::size_t(kFiducialCount)) break;
  }
  const auto is_mark = [&](glm::dvec2 middle) {
    return std::any_of(search.marks.begin(), search.marks.end(), [&](const FoundMark& mark) {
      return glm::length(Middle(mark.corners) - middle) < 2.0 * mark.module_pixels;
    });
  };
  search.unknown_squares = int(unknown.size() - std::size_t(std::count_if(unknown.begin(), unknown.end(), is_mark)));
  std::sort(search.marks.begin(), search.marks.end(), [](const FoundMark& a, const FoundMark& b) {
    return std::pair(a.corners[0].y, a.corners[0].x) < std::pair(b.corners[0].y, b.corners[0].x);
  });
  return search;
}

std::vector<FoundMark> FindMarksAt(const Picture& picture, std::span<const FoundMark> expected) {
  std::vector<FoundMark> found;
  const auto brightness = [&](glm::dvec2 at) { return std::sqrt(LightAt(picture, at)); };
  for (FoundMark mark : expected) {
    const bool inside = std::all_of(mark.corners.begin(), mark.corners.end(), [&](glm::dvec2 p) {
      return p.x > 0 && p.y > 0 && p.x < picture.width && p.y < picture.height;
    });
    if (!inside || !Refine(picture, mark)) continue;
    const auto reading = Read(mark.corners, brightness);
    if (!reading || !reading->clear || reading->wrong_border > kMostHiddenBorder) continue;
    mark.wrong_bits = std::popcount(unsigned(reading->Bits() ^ FiducialBits(mark.id)));
    if (mark.wrong_bits <= kMostHiddenBits) found.push_back(mark);
  }
  return found;
}

}  // namespace scumble
