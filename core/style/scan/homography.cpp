#include "core/style/scan/homography.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/image/check.h"

namespace scumble {
namespace {

// Moves and scales points to lie around the origin at a distance of about one: equations in pixels are badly
// conditioned.
glm::dmat3 Normaliser(std::span<const glm::dvec2> points) {
  glm::dvec2 mean(0.0);
  for (const glm::dvec2 p : points) mean += p / double(points.size());
  double distance = 0;
  for (const glm::dvec2 p : points) distance += glm::length(p - mean) / double(points.size());
  const double scale = distance > 0 ? 1.0 / distance : 1.0;
  return glm::dmat3(scale, 0, 0, 0, scale, 0, -mean.x * scale, -mean.y * scale, 1);
}

}  // namespace

bool SolveLinear(double* a, double* b, int n) {
  double largest = 0;
  for (int i = 0; i < n * n; ++i) largest = std::max(largest, std::abs(a[i]));
  for (int column = 0; column < n; ++column) {
    int pivot = column;
    for (int row = column + 1; row < n; ++row) {
      if (std::abs(a[row * n + column]) > std::abs(a[pivot * n + column])) pivot = row;
    }
    if (!(std::abs(a[pivot * n + column]) > 1e-13 * largest)) return false;
    for (int i = 0; i < n; ++i) std::swap(a[column * n + i], a[pivot * n + i]);
    std::swap(b[column], b[pivot]);
    for (int row = 0; row < n; ++row) {
      if (row == column) continue;
      const double factor = a[row * n + column] / a[column * n + column];
      for (int i = column; i < n; ++i) a[row * n + i] -= factor * a[column * n + i];
      b[row] -= factor * b[column];
    }
  }
  for (int i = 0; i < n; ++i) b[i] /= a[i * n + i];
  return true;
}

std::optional<glm::dmat3> FitHomography(std::span<const glm::dvec2> from, std::span<const glm::dvec2> to) {
  SCUMBLE_CHECK_EQ(from.size(), to.size());
  if (from.size() < 4) return std::nullopt;
  const glm::dmat3 before = Normaliser(from), after = Normaliser(to);
  std::array<double, 64> a{};
  std::array<double, 8> b{};
  for (std::size_t i = 0; i < from.size(); ++i) {
    const glm::dvec2 p = Project(before, from[i]), q = Project(after, to[i]);
    const std::array<std::array<double, 8>, 2> rows{
        {{p.x, p.y, 1, 0, 0, 0, -p.x * q.x, -p.y * q.x}, {0, 0, 0, p.x, p.y, 1, -p.x * q.y, -p.y * q.y}}};
    for (int k = 0; k < 2; ++k) {
      for (int r = 0; r < 8; ++r) {
        for (int c = 0; c < 8; ++c) a[r * 8 + c] += rows[k][r] * rows[k][c];
        b[r] += rows[k][r] * q[k];
      }
    }
  }
  if (!SolveLinear(a.data(), b.data(), 8)) return std::nullopt;
  const glm::dmat3 solved(b[0], b[3], b[6], b[1], b[4], b[7], b[2], b[5], 1.0);
  const glm::dmat3 map = glm::inverse(after) * solved * before;
  if (!(std::abs(map[2][2]) > 0.0) || !std::isfinite(map[2][2])) return std::nullopt;
  return map / map[2][2];
}

}  // namespace scumble
