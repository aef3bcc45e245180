// Depth as a share of the way from near to far, for what distance does.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "core/filter/wide_loops.h"
#include "core/image/exact_math.h"
#include "finish/finish.h"

namespace scumble::internal {

// A function of 0 … `most` from a table, by straight lines between 4096 cells; beyond, and in the lowest 64, where
// powers bend most, it is computed.
class Curve {
 public:
  Curve() = default;
  Curve(double most, std::function<double(double)> function) : most_(most), function_(std::move(function)) {
    for (int i = 0; i <= kCells + 1; ++i) values_.push_back(function_(most * i / kCells));
  }
  double At(double x) const {
    const double at = x / most_ * kCells;
    if (!(at >= 64.0 && at < kCells)) return function_(x);
    const auto cell = static_cast<std::size_t>(at);
    return values_[cell] + (values_[cell + 1] - values_[cell]) * (at - static_cast<double>(cell));
  }

 private:
  static constexpr int kCells = 4096;
  double most_ = 1.0;
  std::function<double(double)> function_;
  std::vector<double> values_;
};

// |-1 / x - from|, or |x - from|, times `per`, 1 at most and where it is no number.
SCUMBLE_WIDE_LOOPS inline void InverseDistances(const float* x, float from, float per, std::size_t count, float* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const float u = std::fabs(-1.0f / x[i] - from) * per;
    out[i] = u < 1.0f ? u : 1.0f;
  }
}
SCUMBLE_WIDE_LOOPS inline void Distances(const float* x, float from, float per, std::size_t count, float* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const float u = std::fabs(x[i] - from) * per;
    out[i] = u < 1.0f ? u : 1.0f;
  }
}

// The u of DepthPass.
class DepthScale {
 public:
  DepthScale(const DepthPass& pass, const FinishMeasures& measures)
      : inverse_(pass.metric == DepthPass::Metric::kInverse) {
    const double near = pass.near > 0.0 ? pass.near : measures.near, far = pass.far > 0.0 ? pass.far : measures.far;
    near_ = Of(near);
    const double span = Of(far) - near_;
    per_span_ = span != 0.0 ? 1.0 / span : 0.0;
    focus_depth_ = static_cast<float>(pass.focus > 0.0 ? pass.focus : near);
    focus_ = Of(focus_depth_);
    gamma_ = pass.gamma;
    if (gamma_ != 1.0)
      power_ = Curve(1.0, [gamma = pass.gamma](double u) { return u > 0.0 ? Exp2(gamma * Log2(u)) : 0.0; });
    layers_ = pass.layers;
  }
  // Depth above 0, infinity allowed. 0 near, 1 far; unclamped, or in layers from 0 to 1, but for infinity.
  double Distance(float depth) const {
    const double distance = (Of(depth) - near_) * per_span_;
    if (layers_ < 2 || std::isinf(depth)) return distance;
    return Layered(static_cast<float>(std::clamp(distance, 0.0, 1.0)));
  }
  bool IsBeforeFocus(float depth) const { return depth < focus_depth_; }
  // 0 … 1, of many.
  void Shares(const float* depth, std::size_t count, float* out) const {
    const auto focus = static_cast<float>(focus_), per_span = static_cast<float>(std::fabs(per_span_));
    (inverse_ ? InverseDistances : Distances)(depth, focus, per_span, count, out);
    for (std::size_t i = 0; i < count && gamma_ != 1.0; ++i) out[i] = static_cast<float>(power_.At(double(out[i])));
    for (std::size_t i = 0; i < count && layers_ > 1; ++i) out[i] = Layered(out[i]);
  }

 private:
  float Layered(float u) const {
    const auto layers = static_cast<float>(layers_);
    return std::min(static_cast<float>(static_cast<int>(u * layers)), layers - 1.0f) / (layers - 1.0f);
  }
  double Of(double depth) const { return inverse_ ? -1.0 / depth : depth; }

  bool inverse_;
  double near_ = 0.0, per_span_ = 0.0, focus_ = 0.0, gamma_ = 1.0;
  float focus_depth_ = 0.0f;
  int layers_ = 0;
  Curve power_;
};

}  // namespace scumble::internal
