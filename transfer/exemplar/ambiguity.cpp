#include "transfer/ambiguity.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "transfer/lookup_table.h"

namespace scumble {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr int kGrid = 64;  // cells a side: the disc has π/4 of its square, so each cell is 8/64² sr, 2.53° across
constexpr int kSamples = 128;  // directions a side

// Whether cell (i, j) overlaps the disc.
bool TouchesDisc(int i, int j) {
  const auto nearest = [](int cell) { return std::max(0, std::max(cell - kGrid / 2, kGrid / 2 - 1 - cell)); };
  const int dx = nearest(i), dy = nearest(j);
  return 4 * (dx * dx + dy * dy) < kGrid * kGrid;
}

double AngleBetween(glm::vec3 a, glm::vec3 b) {
  const glm::dvec3 d = glm::normalize(glm::dvec3(a)) - glm::normalize(glm::dvec3(b));
  return 2.0 * std::asin(std::min(1.0, 0.5 * glm::length(d))) * kDegrees;
}

void MeasureErrors(const PreparedExemplar& exemplar, AmbiguityReport& report) {
  int directions = 0, covered = 0;
  double sum = 0.0;
  for (int j = 0; j < kSamples; ++j) {
    for (int i = 0; i < kSamples; ++i) {
      const double px = (2.0 * i + 1.0) / kSamples - 1.0, py = 1.0 - (2.0 * j + 1.0) / kSamples;
      if (px * px + py * py > 1.0) continue;
      const glm::vec3 direction = DirectionAt(px, py);
      const Source source = exemplar.NearestNeighbour(direction);
      const double error = AngleBetween(direction, exemplar.Normal(source.x, source.y));
      ++directions;
      covered += error < kCoveredDegrees;
      sum += error;
      report.largest_error_degrees = std::max(report.largest_error_degrees, error);
    }
  }
  report.covered_percent = 100.0 * covered / directions;
  report.mean_error_degrees = sum / directions;
}

}  // namespace

AmbiguityReport MeasureAmbiguity(const PreparedExemplar& exemplar) {
  AmbiguityReport report;
  MeasureErrors(exemplar, report);
  std::vector<std::size_t> cells(std::size_t(kGrid) * kGrid);
  for (int y = 0; y < exemplar.height(); ++y) {
    for (int x = 0; x < exemplar.width(); ++x) {
      if (!exemplar.Usable(x, y)) continue;
      const glm::vec2 p = ProjectDirection(FacingDirection(exemplar.Normal(x, y)));
      const int i = std::clamp(static_cast<int>((p.x + 1.0f) * (kGrid / 2)), 0, kGrid - 1);
      const int j = std::clamp(static_cast<int>((1.0f - p.y) * (kGrid / 2)), 0, kGrid - 1);
      ++cells[std::size_t(j) * kGrid + i];
      ++report.usable_pixels;
    }
  }
  for (int j = 0; j < kGrid; ++j) {
    for (int i = 0; i < kGrid; ++i) {
      report.cells += TouchesDisc(i, j);
      report.cells_shown += cells[std::size_t(j) * kGrid + i] > 0;
    }
  }
  // A sphere shows a cell of solid angle 2π/cells that faces the viewer with 2/cells of its pixels, and every other
  // cell with fewer.
  const double fullest_of_a_sphere = 2.0 * static_cast<double>(report.usable_pixels) / report.cells;
  std::size_t flat = 0;
  for (const std::size_t pixels : cells) {
    report.most_repeats = std::max(report.most_repeats, pixels);
    if (static_cast<double>(pixels) > std::max(4.0, 4.0 * fullest_of_a_sphere)) flat += pixels;
  }
  report.mean_repeats = static_cast<double>(report.usable_pixels) / std::max(1, report.cells_shown);
  report.flat_percent = 100.0 * static_cast<double>(flat) / static_cast<double>(report.usable_pixels);
  return report;
}

SpaceAmbiguity MeasureAmbiguity(const GuideSpace& space, const PreparedExemplar& exemplar, int k,
                                const GuideTest& test) {
  SpaceAmbiguity report;
  constexpr int kSide = 32;  // of the grid of directions
  std::size_t covered = 0, asked = 0;
  for (int step = 0; step < kLightSteps; ++step) {
    std::vector<float> extra_values(std::size_t(space.extra_dimensions()) + 1);
    space.Blend(k, static_cast<float>(step) / (kLightSteps - 1), extra_values.data());
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i) {
        const double px = (2.0 * i + 1.0) / kSide - 1.0, py = 1.0 - (2.0 * j + 1.0) / kSide;
        if (px * px + py * py > 1.0) continue;
        const glm::vec3 direction = DirectionAt(px, py);
        const Source source = space.Nearest(k, direction, extra_values.data());
        covered += space.Alike(test, k, direction, extra_values.data(), source, 0.0f);
        report.mean_error += space.Distance(test, k, direction, extra_values.data(), source);
        ++asked;
      }
    }
  }
  report.covered_percent = 100.0 * static_cast<double>(covered) / static_cast<double>(asked);
  report.mean_error /= static_cast<double>(asked);
  std::map<std::vector<int>, std::size_t> cells;
  std::size_t pixels = 0;
  for (const Source& source : exemplar.UsablePixels()) {
    std::vector<int> cell;
    space.ForEachCoordinate(k, source,
                            [&](float value) { cell.push_back(static_cast<int>(std::floor(value / kGuideCell))); });
    report.most_repeats = std::max(report.most_repeats, ++cells[std::move(cell)]);
    ++pixels;
  }
  report.cells_shown = cells.size();
  report.mean_repeats = static_cast<double>(pixels) / static_cast<double>(std::max<std::size_t>(1, cells.size()));
  return report;
}

}  // namespace scumble
