#include "core/painting/circle_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/image/hash.h"

namespace scumble {
namespace {

double Length(double x, double y) { return std::sqrt(x * x + y * y); }

std::optional<Circle> Through(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  b -= a, c -= a;
  const double d = 2.0 * (b.x * c.y - b.y * c.x);
  if (std::fabs(d) < 1e-9) return std::nullopt;
  const double bb = glm::dot(b, b), cc = glm::dot(c, c);
  const double x = (c.y * bb - b.y * cc) / d, y = (b.x * cc - c.x * bb) / d;
  return Circle{a.x + x, a.y + y, Length(x, y)};
}

// Least squares in x² + y² = p·x + q·y + r.
std::optional<Circle> LeastSquares(const std::vector<glm::dvec2>& points, const Circle& start) {
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

// a x² + b x y + c y² + d x + e y = 1
using Conic = std::array<double, 5>;

// Gauss's elimination with pivots. Empty if the matrix is singular.
std::optional<Conic> Solve(std::array<std::array<double, 6>, 5> rows) {
  for (std::size_t k = 0; k < 5; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < 5; ++i) {
      if (std::fabs(rows[i][k]) > std::fabs(rows[pivot][k])) pivot = i;
    }
    if (std::fabs(rows[pivot][k]) < 1e-12) return std::nullopt;
    std::swap(rows[k], rows[pivot]);
    for (std::size_t i = 0; i < 5; ++i) {
      if (i == k) continue;
      const double by = rows[i][k] / rows[k][k];
      for (std::size_t j = k; j < 6; ++j) rows[i][j] -= by * rows[k][j];
    }
  }
  Conic solved{};
  for (std::size_t k = 0; k < 5; ++k) solved[k] = rows[k][5] / rows[k][k];
  return solved;
}

// In coordinates from `around`, divided by `unit`.
std::optional<Conic> LeastSquares(const std::vector<glm::dvec2>& points) {
  std::array<std::array<double, 6>, 5> normal{};
  for (const glm::dvec2 p : points) {
    const Conic row{p.x * p.x, p.x * p.y, p.y * p.y, p.x, p.y};
    for (std::size_t i = 0; i < 5; ++i) {
      for (std::size_t j = 0; j < 5; ++j) normal[i][j] += row[i] * row[j];
      normal[i][5] += row[i];
    }
  }
  return Solve(normal);
}

// The distance to first order: the value by its gradient (Sampson 1982).
double Off(const Conic& q, glm::dvec2 p) {
  const double value = q[0] * p.x * p.x + q[1] * p.x * p.y + q[2] * p.y * p.y + q[3] * p.x + q[4] * p.y - 1.0;
  const double along = Length(2.0 * q[0] * p.x + q[1] * p.y + q[3], q[1] * p.x + 2.0 * q[2] * p.y + q[4]);
  return along > 0.0 ? std::fabs(value) / along : std::fabs(value);
}

}  // namespace

double Circle::Off(glm::dvec2 point) const { return std::fabs(Length(point.x - x, point.y - y) - radius); }

std::optional<CircleFit> FitCircle(std::span<const glm::dvec2> points, double tolerance, double least_radius,
                                   double most_radius) {
  if (points.empty()) return std::nullopt;
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
    if (!circle || circle->radius < least_radius || circle->radius > most_radius) continue;
    const std::size_t agree = on_circle(*circle).size();
    if (agree > most) best = *circle, most = agree;
  }
  if (most == 0) return std::nullopt;
  for (int round = 0; round < 3; ++round) {
    if (const auto better = LeastSquares(on_circle(best), best)) best = *better;
  }
  return CircleFit{best, on_circle(best).size()};
}

std::optional<EllipseFit> FitEllipse(std::span<const glm::dvec2> points, glm::dvec2 around, double tolerance) {
  if (points.size() < 5) return std::nullopt;
  std::vector<glm::dvec2> scaled(points.begin(), points.end());
  double unit = 0.0;
  for (glm::dvec2& p : scaled) p -= around, unit += Length(p.x, p.y) / static_cast<double>(points.size());
  if (!(unit > 0.0)) return std::nullopt;
  for (glm::dvec2& p : scaled) p /= unit;
  std::vector<glm::dvec2> near = scaled;
  std::optional<Conic> conic;
  // The tolerance narrows, so that what lies elsewhere drops out step by step.
  for (const double widen : {8.0, 4.0, 2.0, 1.0}) {
    conic = LeastSquares(near);
    if (!conic) return std::nullopt;
    near.clear();
    for (const glm::dvec2 p : scaled) {
      if (Off(*conic, p) * unit <= widen * tolerance) near.push_back(p);
    }
    if (near.size() < 5) return std::nullopt;
  }
  const auto [a, b, c, d, e] = *conic;
  const double determinant = 4.0 * a * c - b * b;
  if (!(determinant > 1e-9)) return std::nullopt;
  const double x = (b * e - 2.0 * c * d) / determinant, y = (b * d - 2.0 * a * e) / determinant;
  const double level = 1.0 + a * x * x + b * x * y + c * y * y;
  const double mean = 0.5 * (a + c), apart = 0.5 * Length(a - c, b);
  if (!(level > 0.0 && mean - apart > 0.0)) return std::nullopt;
  return EllipseFit{2.0 * unit * std::sqrt(level / (mean - apart)), 2.0 * unit * std::sqrt(level / (mean + apart)),
                    near.size()};
}

}  // namespace scumble
