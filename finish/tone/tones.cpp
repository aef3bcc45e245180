#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "core/filter/wide_loops.h"
#include "core/image/exact_math.h"
#include "finish/tone/point_effect.h"

namespace scumble::internal {
namespace {

double Tanh(double x) {
  const double e = Exp2(2.0 * x * 1.4426950408889634);  // of |x| up to 128
  return (e - 1.0) / (e + 1.0);
}

// The soft steps of Winnemöller, Olsen and Gooch ("Real-Time Video Abstraction", 2006, section 3.2), with two changes:
// the first level is black and the last is white, and the curve of each step is stretched so that it meets the next
// one. It is continuous and rises; levels and the middles between them keep their lightness. f is 0 … 1.
double SoftStep(double f, int levels, double sharpness) {
  if (!(sharpness > 0.0)) return f;
  const double width = 1.0 / (levels - 1);
  const double border = (std::clamp(std::floor(f / width), 0.0, levels - 2.0) + 0.5) * width;
  return border + 0.5 * width * Tanh(2.0 * sharpness * (f - border) / width) / Tanh(sharpness);
}

constexpr int kCells = 1 << 12;  // 16 KiB stay in the nearest cache

// By straight lines between the cells of a table of kCells + 2 values.
SCUMBLE_WIDE_LOOPS void TakeFrom(const float* table, std::size_t count, float* lightness) {
  for (std::size_t i = 0; i < count; ++i) {
    const float given = lightness[i] < 0.0f ? 0.0f : 1.0f < lightness[i] ? 1.0f : lightness[i];
    const float at = given * kCells;
    const int cell = static_cast<int>(at);
    const float from = table[cell], to = table[cell + 1];
    lightness[i] = from + (to - from) * (at - static_cast<float>(cell));
  }
}

}  // namespace

PointEffect MakeTones(const TonesPass& pass) {
  const auto curve = std::make_shared<std::vector<float>>();
  for (int i = 0; i <= kCells; ++i) {
    curve->push_back(static_cast<float>(SoftStep(double(i) / kCells, pass.bins, pass.sharpness)));
  }
  curve->push_back(curve->back());
  return [curve](std::size_t, std::size_t count, OklabBlock& block) {
    TakeFrom(curve->data(), count, block.lightness.data());
  };
}

}  // namespace scumble::internal
