// The exact Euclidean distance transform. It finds the nearest feature pixel, not only the distance to it. Private to
// Scumble.
#pragma once

#include <tbb/parallel_for.h>

#include <cstdint>
#include <limits>
#include <vector>

namespace scumble::internal {

inline constexpr std::uint16_t kNoRow = std::numeric_limits<std::uint16_t>::max();

// For every pixel, the row of the nearest pixel in its column for which feature(i) holds. kNoRow where there is none;
// ties go to the upper row.
template <class Feature>
std::vector<std::uint16_t> NearestRows(int width, int height, const Feature& feature) {
  std::vector<std::uint16_t> rows(std::size_t(width) * height, kNoRow);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = std::size_t(y) * width + x;
      if (feature(i))
        rows[i] = static_cast<std::uint16_t>(y);
      else if (y > 0)
        rows[i] = rows[i - width];
    }
  }
  for (int y = height - 2; y >= 0; --y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = std::size_t(y) * width + x;
      const std::uint16_t below = rows[i + width];
      if (below == kNoRow || below <= y) continue;
      if (rows[i] == kNoRow || below - y < y - rows[i]) rows[i] = below;
    }
  }
  return rows;
}

// The distance transform of Meijster, Roerdink, Hesselink, "A General Algorithm for Computing Distance Transforms in
// Linear Time", ISMM 2000, in integers. Calls visit(i, x, y, u, v) for every pixel with its nearest feature pixel (u,
// v); ties go to the lowest (u, v). Without any feature pixel nothing is called. Rows run in parallel: visit is called
// from several threads. Width and height are at most 32768. O(width · height).
template <class Feature, class Visit>
void ForNearestFeature(int width, int height, const Feature& feature, const Visit& visit) {
  const std::vector<std::uint16_t> rows = NearestRows(width, height, feature);
  tbb::parallel_for(0, height, [&](int y) {
    // The lower envelope of one parabola a column: the nearest column, and the x from which it is nearest.
    std::vector<int> column, from;
    const auto squared = [&](int x, int u) {
      const std::int64_t dx = x - u, dy = y - rows[std::size_t(y) * width + u];
      return dx * dx + dy * dy;
    };
    for (int u = 0; u < width; ++u) {
      if (rows[std::size_t(y) * width + u] == kNoRow) continue;
      while (!column.empty() && squared(from.back(), column.back()) > squared(from.back(), u)) {
        column.pop_back(), from.pop_back();
      }
      if (column.empty()) {
        column.push_back(u), from.push_back(0);
        continue;
      }
      // The last x at which the parabola on top is the lowest.
      const std::int64_t k = column.back();
      const std::int64_t numerator =
          std::int64_t(u) * u - k * k + squared(u, u) - squared(column.back(), column.back());
      const std::int64_t denominator = 2 * (u - k);
      const std::int64_t last =
          numerator >= 0 ? numerator / denominator : -((-numerator + denominator - 1) / denominator);
      if (last + 1 < width) column.push_back(u), from.push_back(static_cast<int>(last + 1));
    }
    std::size_t top = 0;
    for (int x = 0; x < width && !column.empty(); ++x) {
      while (top + 1 < column.size() && from[top + 1] <= x) ++top;
      const int u = column[top];
      visit(std::size_t(y) * width + x, x, y, u, static_cast<int>(rows[std::size_t(y) * width + u]));
    }
  });
}

}  // namespace scumble::internal
