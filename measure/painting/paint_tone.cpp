#include "measure/painting/paint_tone.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "core/image/direction.h"

namespace scumble {
namespace {

constexpr int kToneCells = 48;  // along the longer side

struct Cell {
  glm::vec3 normal{0.0f};
  double lightness = 0.0;
  int pixels = 0;
};

std::vector<Cell> CellsOf(const PaintSheet& sheet) {
  const int side = std::max(1, (std::max(sheet.width(), sheet.height()) + kToneCells - 1) / kToneCells);
  const int columns = (sheet.width() + side - 1) / side;
  std::vector<Cell> cells(std::size_t(columns) * ((sheet.height() + side - 1) / side));
  for (int y = 0; y < sheet.height(); ++y) {
    for (int x = 0; x < sheet.width(); ++x) {
      if (!sheet.Usable(x, y) || !sheet.Shows(x, y)) continue;
      Cell& cell = cells[std::size_t(y / side) * columns + x / side];
      cell.normal += sheet.Normal(x, y);
      cell.lightness += sheet.lightness()[sheet.Index(x, y)];
      ++cell.pixels;
    }
  }
  cells.erase(std::remove_if(cells.begin(), cells.end(), [](const Cell& cell) { return cell.pixels == 0; }),
              cells.end());
  for (Cell& cell : cells) cell.normal = glm::normalize(cell.normal), cell.lightness /= cell.pixels;
  return cells;
}

double CorrelationWith(const std::vector<Cell>& cells, double azimuth, double elevation) {
  const glm::vec3 light(DirectionFromAngles(azimuth, elevation));
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  for (const Cell& cell : cells) {
    const double w = cell.pixels, p = std::max(0.0f, glm::dot(cell.normal, light)), q = cell.lightness;
    n += w, a += w * p, b += w * q, aa += w * p * p, bb += w * q * q, ab += w * p * q;
  }
  // In lightness less than half a step from black to white in 8 bits is no shading.
  const double variance_p = aa / n - a * a / n / n, variance_q = bb / n - b * b / n / n;
  if (!(variance_p > 1e-9) || !(variance_q > 0.04)) return 0.0;
  return (ab / n - a * b / n / n) / std::sqrt(variance_p * variance_q);
}

}  // namespace

ToneReport MeasureTone(const PaintSheet& sheet) {
  std::vector<float> tones;
  double sum = 0.0;
  for (int y = 0; y < sheet.height(); ++y) {
    for (int x = 0; x < sheet.width(); ++x) {
      if (!sheet.Usable(x, y) || !sheet.Shows(x, y)) continue;
      tones.push_back(sheet.lightness()[sheet.Index(x, y)]);
      sum += tones.back();
    }
  }
  if (tones.empty()) return {};
  const auto percentile = [&](double share) {
    const auto at = tones.begin() + std::ptrdiff_t(share * static_cast<double>(tones.size() - 1) + 0.5);
    std::nth_element(tones.begin(), at, tones.end());
    return double(*at);
  };
  return {percentile(0.01), percentile(0.99), sum / static_cast<double>(tones.size())};
}

PaintedLight FindPaintedLight(const PaintSheet& sheet) {
  const std::vector<Cell> cells = CellsOf(sheet);
  PaintedLight best;
  if (cells.empty()) return best;
  const auto look = [&](double azimuth, double elevation) {
    if (elevation < -90.0 || elevation > 90.0) return;
    const double value = CorrelationWith(cells, azimuth, elevation);
    if (value > best.correlation) best = {azimuth, elevation, value};
  };
  for (int elevation = -80; elevation <= 80; elevation += 10) {
    for (int azimuth = -170; azimuth <= 180; azimuth += 10) look(azimuth, elevation);
  }
  for (const double step : {3.0, 1.0}) {
    const PaintedLight middle = best;
    if (!(middle.correlation > 0.0)) return {};
    for (int i = -4; i <= 4; ++i) {
      for (int j = -4; j <= 4; ++j) look(middle.azimuth + step * i, middle.elevation + step * j);
    }
  }
  if (best.azimuth > 180.0) best.azimuth -= 360.0;
  if (best.azimuth <= -180.0) best.azimuth += 360.0;
  return best;
}

double AngleBetween(const PaintedLight& a, const PaintedLight& b) {
  const double cosine =
      glm::dot(DirectionFromAngles(a.azimuth, a.elevation), DirectionFromAngles(b.azimuth, b.elevation));
  return glm::degrees(std::acos(std::clamp(cosine, -1.0, 1.0)));
}

}  // namespace scumble
