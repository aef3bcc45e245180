// The one test of whether two guides are alike.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>

#include "core/image/style.h"

namespace scumble {

// ‖a - b‖ + extra < threshold, strictly, in float without contraction: ties fall the same way on every machine.
class GuideTest {
 public:
  GuideTest(float threshold, ThresholdMetric metric) : threshold_(threshold), metric_(metric) {
    // The Euclidean test compares squares. `bound_` is the smallest float not below threshold², so that a float d²
    // satisfies d² < bound_ exactly when d² < threshold² holds without rounding, denormal thresholds included.
    const double exact = metric == ThresholdMetric::kL2 ? double(threshold) * threshold : double(threshold);
    bound_ = static_cast<float>(exact);
    if (static_cast<double>(bound_) < exact) bound_ = std::nextafter(bound_, std::numeric_limits<float>::infinity());
  }

  bool Alike(glm::vec3 a, glm::vec3 b) const {
    const float dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
    if (metric_ == ThresholdMetric::kL2) return dx * dx + dy * dy + dz * dz < bound_;
    return std::fabs(dx) + std::fabs(dy) + std::fabs(dz) < bound_;
  }

  // `extra` is 0 or more; with 0 this equals Alike(a, b).
  bool Alike(glm::vec3 a, glm::vec3 b, float extra) const {
    if (!(extra > 0.0f)) return Alike(a, b);
    const float left = threshold_ - extra;
    if (!(left > 0.0f)) return false;
    const float dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
    if (metric_ == ThresholdMetric::kL2) return dx * dx + dy * dy + dz * dz < SquareOf(left);
    return std::fabs(dx) + std::fabs(dy) + std::fabs(dz) < left;
  }

  // Alike with extra dimensions: `extra_distance` is their ExtraDistance, 0 or more.
  bool Alike(glm::vec3 a, glm::vec3 b, float extra_distance, float extra) const {
    const float dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
    const float left = threshold_ - extra;
    if (!(left > 0.0f)) return false;
    if (metric_ == ThresholdMetric::kL2) {
      return dx * dx + dy * dy + dz * dz + extra_distance < (extra > 0.0f ? SquareOf(left) : bound_);
    }
    return std::fabs(dx) + std::fabs(dy) + std::fabs(dz) + extra_distance < (extra > 0.0f ? left : bound_);
  }

  // The part of the extra dimensions: squares for kL2, absolute differences for kL1.
  float ExtraDistance(const float* a, const float* b, int dimensions) const {
    float sum = 0.0f;
    for (int d = 0; d < dimensions; ++d) {
      const float off = a[d] - b[d];
      sum += metric_ == ThresholdMetric::kL2 ? off * off : std::fabs(off);
    }
    return sum;
  }

  // The square of the threshold less the light's part, which is above 0: so is the square, where rounding would make it
  // 0.
  static float SquareOf(float left) { return std::max(left * left, kLeastSquare); }
  static constexpr float kLeastSquare = std::numeric_limits<float>::denorm_min();

  float threshold() const { return threshold_; }
  ThresholdMetric metric() const { return metric_; }
  // The bound for a sum of squares (kL2) or of absolute differences, without extra parts.
  float bound() const { return bound_; }

  // The approximate threshold between unit normals, by the Euclidean metric.
  float EuclideanThreshold() const { return metric_ == ThresholdMetric::kL2 ? threshold_ : threshold_ * (2.0f / 3.0f); }

  // ‖a - b‖ in the test's metric.
  float Distance(glm::vec3 a, glm::vec3 b) const {
    const float dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
    if (metric_ == ThresholdMetric::kL2) return std::sqrt(dx * dx + dy * dy + dz * dz);
    return std::fabs(dx) + std::fabs(dy) + std::fabs(dz);
  }
  float Distance(glm::vec3 a, glm::vec3 b, float extra_distance) const {
    const float dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
    if (metric_ == ThresholdMetric::kL2) return std::sqrt(dx * dx + dy * dy + dz * dz + extra_distance);
    return std::fabs(dx) + std::fabs(dy) + std::fabs(dz) + extra_distance;
  }

 private:
  float threshold_;
  ThresholdMetric metric_;
  float bound_;
};

}  // namespace scumble
