#include "measure/painting/regularity.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <numbers>

#include "core/filter/gaussian_blur.h"
#include "core/filter/wide_loops.h"
#include "core/image/check.h"

namespace scumble {
namespace {

// Normalised autocorrelation at shifts (dx, dy), |dx| ≤ reach, 0 ≤ dy ≤ reach; the other half mirrors it.
class Autocorrelation {
 public:
  explicit Autocorrelation(int reach) : reach_(reach), values_(std::size_t(2 * reach + 1) * (reach + 1), 0.0) {}

  int reach() const { return reach_; }
  double& Of(int dx, int dy) { return values_[std::size_t(dy) * (2 * reach_ + 1) + dx + reach_]; }
  double At(int dx, int dy) const {
    if (dy < 0) dx = -dx, dy = -dy;
    return values_[std::size_t(dy) * (2 * reach_ + 1) + dx + reach_];
  }
  void Add(const Autocorrelation& other) {
    for (std::size_t i = 0; i < values_.size(); ++i) values_[i] += other.values_[i];
  }
  void Scale(double factor) {
    for (double& value : values_) value *= factor;
  }

 private:
  int reach_;
  std::vector<double> values_;
};

struct Texture {
  std::vector<std::int16_t> values;
  double spread = 0.0;
};

// Steps of lightness 1, and the row of pixels whose products add up to 32 bits: 128 · (100 · 40)² < 2³¹.
constexpr float kSteps = 40.0f, kMost = 100.0f * kSteps;
constexpr int kRun = 128;

// The window without its slow changes, as integers of 1/40: sums of them are exact, and fast.
Texture HighPassed(const std::vector<float>& plane, int width, const PictureRegion& region) {
  std::vector<float> tones;
  for (int y = 0; y < region.height; ++y) {
    const auto row = plane.begin() + (std::ptrdiff_t(region.y) + y) * width + region.x;
    tones.insert(tones.end(), row, row + region.width);
  }
  const std::vector<float> blurred = GaussianBlur(tones, region.width, region.height, 3.0 * region.width / 32.0);
  double mean = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < tones.size(); ++i) tones[i] -= blurred[i], mean += tones[i];
  mean /= static_cast<double>(tones.size());
  Texture texture;
  for (const float tone : tones) {
    const double value = tone - mean;
    squares += value * value;
    texture.values.push_back(
        static_cast<std::int16_t>(std::lround(std::clamp(double(kSteps) * value, -double(kMost), double(kMost)))));
  }
  texture.spread = std::sqrt(squares / static_cast<double>(tones.size()));
  return texture;
}

// Σ a[x, y] · b[x, y] over `columns` × `rows` pixels of rows of `side`.
SCUMBLE_WIDE_LOOPS std::int64_t SumOfProducts(const std::int16_t* a, const std::int16_t* b, int columns, int rows,
                                              int side) {
  std::int64_t sum = 0;
  for (int y = 0; y < rows; ++y) {
    const std::ptrdiff_t row = std::ptrdiff_t(y) * side;
    for (int from = 0; from < columns; from += kRun) {
      const int to = std::min(columns, from + kRun);
      std::int32_t run = 0;
      for (int x = from; x < to; ++x) run += std::int32_t(a[row + x]) * b[row + x];
      sum += run;
    }
  }
  return sum;
}

Autocorrelation Correlate(const std::vector<std::int16_t>& values, int side, int reach) {
  Autocorrelation result(reach);
  const auto sum_at = [&](int dx, int dy) {
    const int from = std::max(0, -dx), columns = side - std::abs(dx), rows = side - dy;
    const std::int16_t* const a = values.data() + from;
    const std::int16_t* const b = a + std::ptrdiff_t(dy) * side + dx;
    return static_cast<double>(SumOfProducts(a, b, columns, rows, side)) / (static_cast<double>(columns) * rows);
  };
  const double power = sum_at(0, 0);
  for (int dy = 0; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) result.Of(dx, dy) = power > 0.0 ? sum_at(dx, dy) / power : 0.0;
  }
  return result;
}

// The lowest value between the middle and the shift, along a direction of length 1.
double LowestOnTheWay(const Autocorrelation& values, double cosine, double sine, double length) {
  double lowest = 1.0;
  for (int step = 1; step <= length; ++step) {
    lowest = std::min(
        lowest, values.At(static_cast<int>(std::lround(cosine * step)), static_cast<int>(std::lround(sine * step))));
  }
  return lowest;
}

struct Peak {
  double value = 0.0;
  int dx = 0, dy = 0;
};

bool IsPeak(const Autocorrelation& values, int dx, int dy) {
  const double value = values.At(dx, dy);
  if (value < 0.02) return false;
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) {
      if (values.At(dx + i, dy + j) > value) return false;
    }
  }
  const double length = std::hypot(dx, dy);
  return LowestOnTheWay(values, dx / length, dy / length, length) <= 0.5 * value;
}

struct Pattern {
  Peak highest;
  Peak nearest;  // of the peaks nearly as high: a pattern repeats at every multiple of its period
  double echo = 0.0;
};

double LengthOf(const Peak& peak) { return std::hypot(peak.dx, peak.dy); }

Pattern FindPattern(const Autocorrelation& values) {
  std::vector<Peak> peaks;
  Pattern pattern;
  const int reach = values.reach() - 1;  // local maxima have neighbours
  for (int dy = 0; dy <= reach; ++dy) {
    for (int dx = dy == 0 ? 1 : -reach; dx <= reach; ++dx) {
      const int square = dx * dx + dy * dy;
      if (square < 4 || square > reach * reach || !IsPeak(values, dx, dy)) continue;
      peaks.push_back({std::min(1.0, values.At(dx, dy)), dx, dy});
      if (peaks.back().value > pattern.highest.value) pattern.highest = peaks.back();
    }
  }
  for (const Peak& peak : peaks) {
    const bool nearer = pattern.nearest.value == 0.0 || LengthOf(peak) < LengthOf(pattern.nearest);
    if (peak.value >= 0.8 * pattern.highest.value && nearer) pattern.nearest = peak;
  }
  // Shifts are whole pixels, so twice a period may fall short by one.
  const double far = std::max(2.0 * LengthOf(pattern.nearest) - 1.0, 0.625 * reach);
  for (const Peak& peak : peaks) {
    if (LengthOf(peak) >= far) pattern.echo = std::max(pattern.echo, peak.value);
  }
  return pattern;
}

// Degrees from the right, turning up, 0 … 180, of a direction in the picture, whose y runs down.
double DirectionOf(double dx, double dy) {
  const double degrees = std::atan2(-dy, dx) * 180.0 / std::numbers::pi;
  return degrees < 0.0 ? degrees + 180.0 : degrees >= 180.0 ? degrees - 180.0 : degrees;
}

void Describe(const Autocorrelation& values, const Peak& peak, RegularityReport& report) {
  if (peak.value == 0.0) return;
  report.period = LengthOf(peak);
  report.direction = DirectionOf(peak.dx, peak.dy);
  // Along a line the texture is constant, over at least the period across it.
  const double length = std::max(report.period, values.reach() / 3.0);
  double most = -1.0, along_x = 0.0, along_y = 0.0;
  for (int degrees = 0; degrees < 180; degrees += 2) {
    const double angle = degrees * std::numbers::pi / 180.0, cosine = std::cos(angle), sine = std::sin(angle);
    const double lowest = LowestOnTheWay(values, cosine, sine, length);
    if (lowest > most) most = lowest, along_x = cosine, along_y = sine;
  }
  report.grid = most < 0.3 * peak.value;
  if (report.grid) return;
  // The nearest shift in whole pixels to the next line may not be perpendicular to the lines.
  report.period = std::fabs(peak.dx * along_y - peak.dy * along_x);
  report.direction = DirectionOf(-along_y, along_x);
}

}  // namespace

RegularityReport MeasureRegularity(const std::vector<float>& plane, int width,
                                   const std::vector<PictureRegion>& windows, const RegularityOptions& options) {
  SCUMBLE_CHECK(options.window >= 16 && width > 0);
  const int reach = options.window * 3 / 8 + 1;
  Autocorrelation mean(reach), best(reach);
  std::vector<double> echoes;
  RegularityReport report;
  Pattern best_pattern;
  best_pattern.echo = -1.0;
  for (const PictureRegion& region : windows) {
    SCUMBLE_CHECK(region.width == options.window && region.height == options.window);
    SCUMBLE_CHECK(region.x >= 0 && region.y >= 0 && region.x + region.width <= width &&
                  std::size_t(region.y + region.height) * width <= plane.size());
    const Texture texture = HighPassed(plane, width, region);
    if (texture.spread < options.least_spread) continue;
    const Autocorrelation values = Correlate(texture.values, options.window, reach);
    const Pattern pattern = FindPattern(values);
    mean.Add(values);
    echoes.push_back(pattern.echo);
    if (pattern.echo <= best_pattern.echo) continue;
    best = values, best_pattern = pattern;
    report.x = region.x + region.width / 2, report.y = region.y + region.height / 2;
  }
  report.windows = static_cast<int>(echoes.size());
  if (echoes.empty()) return report;
  mean.Scale(1.0 / report.windows);
  const Pattern pattern = FindPattern(mean);
  std::sort(echoes.begin(), echoes.end());
  report.peak = pattern.highest.value;
  report.echo = pattern.echo;
  report.local_echo = echoes[echoes.size() * 3 / 4];
  if (report.peak >= report.local_echo)
    Describe(mean, pattern.nearest, report);
  else
    Describe(best, best_pattern.nearest, report);
  return report;
}

}  // namespace scumble
