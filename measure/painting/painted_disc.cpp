#include "measure/painting/painted_disc.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <optional>

#include "core/image/check.h"
#include "core/image/color.h"
#include "core/image/hash.h"
#include "core/image/oklab.h"

namespace scumble {
namespace {

constexpr int kDirections = 720;

// The mean of the 3×3 texels around one, so that a paper's grain is no paint.
std::array<std::uint16_t, 4> MeanTexel(const Picture& picture, int x, int y) {
  std::array<std::uint32_t, 4> sums{};
  std::uint32_t count = 0;
  for (int j = std::max(0, y - 1); j <= std::min(picture.height - 1, y + 1); ++j) {
    for (int i = std::max(0, x - 1); i <= std::min(picture.width - 1, x + 1); ++i) {
      for (std::size_t c = 0; c < 4; ++c) sums[c] += picture.At(i, j)[c];
      ++count;
    }
  }
  std::array<std::uint16_t, 4> mean{};
  for (std::size_t c = 0; c < 4; ++c) mean[c] = static_cast<std::uint16_t>(sums[c] / count);
  return mean;
}

glm::vec3 LinearOf(const std::uint16_t* texel) {
  return {Srgb16ToLinear(texel[0]), Srgb16ToLinear(texel[1]), Srgb16ToLinear(texel[2])};
}

struct Circle {
  double x = 0, y = 0, radius = 0;
  double Off(glm::dvec2 point) const { return std::fabs(std::hypot(point.x - x, point.y - y) - radius); }
};

std::optional<Circle> Through(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  b -= a, c -= a;
  const double d = 2.0 * (b.x * c.y - b.y * c.x);
  if (std::fabs(d) < 1e-9) return std::nullopt;
  const double bb = glm::dot(b, b), cc = glm::dot(c, c);
  const double x = (c.y * bb - b.y * cc) / d, y = (b.x * cc - c.x * bb) / d;
  return Circle{a.x + x, a.y + y, std::hypot(x, y)};
}

// Least squares in x² + y² = p·x + q·y + r (Kåsa 1976).
std::optional<Circle> Fit(const std::vector<glm::dvec2>& points, const Circle& start) {
  glm::dmat3 normal(0.0);
  glm::dvec3 right(0.0);
  for (const glm::dvec2 point : points) {
    const glm::dvec3 row((point.x - start.x) / start.radius, (point.y - start.y) / start.radius, 1.0);
    normal += glm::outerProduct(row, row);
    right += row * (row.x * row.x + row.y * row.y);
  }
  if (points.size() < 3 || std::fabs(glm::determinant(normal)) < 1e-9) return std::nullopt;
  const glm::dvec3 solved = glm::inverse(normal) * right;
  const double x = 0.5 * solved.x, y = 0.5 * solved.y, square = solved.z + x * x + y * y;
  if (!(square > 0.0)) return std::nullopt;
  return Circle{start.x + x * start.radius, start.y + y * start.radius, std::sqrt(square) * start.radius};
}

// The direction of number i, and the pixel that lies so far from the middle in it.
struct Ray {
  double cosine, sine;
  glm::dvec2 At(double middle, double distance) const { return {middle + cosine * distance, middle + sine * distance}; }
};
Ray RayOf(int i) {
  const double angle = 2.0 * std::numbers::pi * i / kDirections;
  return {std::cos(angle), std::sin(angle)};
}

// The first paint of each ray inward from the picture's edge. Rays on which paint reaches the edge have no outline.
std::vector<glm::dvec2> Outline(const PaintOnGround& paint) {
  const int size = paint.sheet().width();
  const double middle = 0.5 * size;
  std::vector<glm::dvec2> points;
  for (int i = 0; i < kDirections; ++i) {
    const Ray ray = RayOf(i);
    const double longest = middle / std::max(std::fabs(ray.cosine), std::fabs(ray.sine)) - 0.5;
    // Three pixels of paint in a row, so that a speck of grain is none; and three of ground before them.
    int run = 0, ground = 0;
    for (double distance = longest; distance > 0.0; distance -= 0.5) {
      const glm::dvec2 at = ray.At(middle, distance);
      const int x = std::clamp(static_cast<int>(at.x), 0, size - 1),
                y = std::clamp(static_cast<int>(at.y), 0, size - 1);
      if (!paint.IsPaint(x, y)) {
        run = 0, ++ground;
        continue;
      }
      if (++run < 6) continue;
      // The mask's mean over 3×3 texels moves the outline half a pixel to a pixel outward.
      if (ground >= 6) points.push_back(ray.At(middle, distance + 2.5 - 0.5));
      break;
    }
  }
  return points;
}

// Whether ground lies between the usable rim and paint of a clearly different colour.
bool HasFringe(const PaintOnGround& paint, const Ray& ray) {
  const PaintSheet& sheet = paint.sheet();
  const double middle = 0.5 * sheet.width(), usable = middle - std::max(1.0, sheet.rim());
  const double least = std::max(1.0, 0.004 * middle), widest = 0.1 * middle, beside = std::max(2.0, 0.03 * middle);
  constexpr float kOtherColour = 0.15f;  // in Oklab
  // If the rim leaves almost none of the sphere, there is no room for a fringe.
  if (!(usable > widest + beside + 2.0)) return false;
  const auto pixel_at = [&](double depth) {
    return glm::clamp(glm::ivec2(ray.At(middle, usable - depth)), 0, sheet.width() - 1);
  };
  double width = 0.0;
  while (width <= widest && !paint.IsPaint(pixel_at(width).x, pixel_at(width).y)) width += 0.5;
  if (width < least || width > widest) return false;
  if (paint.ground().kind == BarePaper::Kind::kTransparent) return true;
  glm::vec3 sum(0.0f);
  float count = 0.0f;
  for (double depth = width + 1.0; depth < width + 1.0 + beside; depth += 1.0, count += 1.0f) {
    const glm::ivec2 at = pixel_at(depth);
    sum += LinearOf(sheet.picture().At(at.x, at.y));
  }
  return glm::length(OklabFromLinear(sum / count) - OklabFromLinear(paint.ground().color)) >= kOtherColour;
}

}  // namespace

PaintOnGround::PaintOnGround(const PaintSheet& sheet) : sheet_(sheet), mask_(sheet.lightness().size(), 1) {
  SCUMBLE_CHECK(sheet.is_sphere());
  ground_ = FindBarePaper(sheet.picture());
  if (!known()) return;
  // Paint that continues into the corners may have nearly one colour there; on paper there is almost none of it.
  constexpr double kCornersFrom = 1.15, kMostPaint = 0.15;
  const double middle = 0.5 * sheet.width();
  std::size_t corners = 0, painted = 0;
  for (int y = 0; y < sheet.height(); ++y) {
    for (int x = 0; x < sheet.width(); ++x) {
      std::array<std::uint16_t, 4> texel = MeanTexel(sheet.picture(), x, y);
      if (ground_.kind == BarePaper::Kind::kPaper) LiftPaint(ground_, texel.data());
      const bool is_paint = ground_.kind == BarePaper::Kind::kPaper ? texel[3] > 0 : texel[3] > 32767;
      mask_[sheet.Index(x, y)] = is_paint;
      if (std::hypot(x + 0.5 - middle, y + 0.5 - middle) < kCornersFrom * middle) continue;
      ++corners, painted += is_paint;
    }
  }
  if (static_cast<double>(painted) <= kMostPaint * static_cast<double>(corners)) return;
  ground_ = {};
  std::fill(mask_.begin(), mask_.end(), std::uint8_t{1});
}

PaintedDisc FindPaintedDisc(const PaintOnGround& paint) {
  if (!paint.known()) return {};
  constexpr double kLeastOutline = 0.5;
  const std::vector<glm::dvec2> points = Outline(paint);
  const double size = paint.sheet().width(), tolerance = std::max(1.0, 0.004 * size);
  if (static_cast<double>(points.size()) < kLeastOutline * kDirections) return {};
  const auto on_circle = [&](const Circle& circle) {
    std::vector<glm::dvec2> on;
    for (const glm::dvec2 point : points) {
      if (circle.Off(point) <= tolerance) on.push_back(point);
    }
    return on;
  };
  Circle best;
  std::size_t most = 0;
  for (std::uint64_t sample = 0; sample < 400; ++sample) {
    std::array<glm::dvec2, 3> of;
    for (std::uint64_t k = 0; k < 3; ++k) of[k] = points[Hash(sample, k) % points.size()];
    const auto circle = Through(of[0], of[1], of[2]);
    if (!circle || circle->radius < 0.1 * size || circle->radius > size) continue;
    const std::size_t agree = on_circle(*circle).size();
    if (agree > most) best = *circle, most = agree;
  }
  for (int round = 0; round < 3 && most > 0; ++round) {
    if (const auto better = Fit(on_circle(best), best)) best = *better;
  }
  const double outline = static_cast<double>(on_circle(best).size()) / kDirections;
  if (most == 0 || outline < kLeastOutline) return {};
  return {true, best.x, best.y, best.radius, outline};
}

double FringeOfRim(const PaintOnGround& paint) {
  if (!paint.known()) return 0.0;
  std::vector<bool> fringed;
  for (int i = 0; i < kDirections; ++i) fringed.push_back(HasFringe(paint, RayOf(i)));
  // Gaps between strokes are no fringe: a fringe is at least 5 degrees long.
  constexpr int kLeastRun = kDirections * 5 / 360;
  int share = 0;
  for (int i = 0; i < kDirections; ++i) {
    bool in_run = false;
    for (int start = i - kLeastRun + 1; start <= i && !in_run; ++start) {
      in_run = true;
      for (int k = start; k < start + kLeastRun && in_run; ++k) {
        in_run = fringed[std::size_t((k + kDirections) % kDirections)];
      }
    }
    share += in_run;
  }
  return static_cast<double>(share) / kDirections;
}

Patches BareShade(const PaintOnGround& paint, const glm::vec3& light) {
  const PaintSheet& sheet = paint.sheet();
  if (paint.ground().kind != BarePaper::Kind::kPaper) return {};
  const int size = sheet.width();
  const double inner = 0.9 * 0.5 * size;
  std::vector<std::uint8_t> bare(paint.mask().size(), 0);
  std::size_t lighter = 0, painted = 0;
  const float ground = OklabFromLinear(paint.ground().color).x;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      if (!sheet.Usable(x, y)) continue;
      if (paint.IsPaint(x, y)) {
        ++painted;
        lighter += OklabFromLinear(LinearOf(sheet.picture().At(x, y))).x > ground;
        continue;
      }
      if (std::hypot(x + 0.5 - 0.5 * size, y + 0.5 - 0.5 * size) > inner) continue;
      bare[sheet.Index(x, y)] = glm::dot(sheet.Normal(x, y), light) < 0.0f;
    }
  }
  if (4 * lighter > painted) return {};
  const int reach = std::max(1, static_cast<int>(std::lround(0.015 * size)));
  return FindPatches(MostlySet(bare, size, size, reach, 1.0), size, size);
}

}  // namespace scumble
