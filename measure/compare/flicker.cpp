#include "measure/flicker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "measure/compare/on_white.h"

namespace scumble {
namespace {

using MeanColor = std::array<double, 3>;

constexpr float kCovered = 0.999f;
constexpr double kDepthChange = 0.05;

MeanColor In255OnWhite(const Picture& picture, int x, int y) {
  MeanColor color = OnWhite(picture, x, y);
  for (double& value : color) value *= 255.0;
  return color;
}

void Add(MeanColor& sum, double weight, const MeanColor& color) {
  for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * color[c];
}

double MeanDifference(const MeanColor& a, const MeanColor& b) {
  return (std::fabs(a[0] - b[0]) + std::fabs(a[1] - b[1]) + std::fabs(a[2] - b[2])) / 3.0;
}

// The target of a pixel: the upper left of the four pixels there, and the fraction beyond it.
struct Target {
  int x = 0, y = 0;
  double along_x = 0.0, along_y = 0.0;  // [0, 1)

  double Weight(int dx, int dy) const {
    return (dx == 0 ? 1.0 - along_x : along_x) * (dy == 0 ? 1.0 - along_y : along_y);
  }
};

class Flicker {
 public:
  Flicker(const Picture& a, const Picture& b, const GuideSet& guides, const GuideSet* next)
      : a_(a), b_(b), guides_(guides), next_(next) {
    has_object_ = guides.Has(Layer::kObject) && (!next || next->Has(Layer::kObject));
    has_depth_ = next && guides.Has(Layer::kDepth) && next->Has(Layer::kDepth);
    has_pref_ = next && guides.Has(Layer::kPref) && next->Has(Layer::kPref);
  }

  FlickerReport Measure() const {
    FlickerReport report;
    report.changes.assign(guides_.pixel_count(), std::numeric_limits<float>::quiet_NaN());
    double sum = 0.0, floor = 0.0;
    for (int y = 0; y < guides_.height(); ++y) {
      for (int x = 0; x < guides_.width(); ++x) {
        if (!(guides_.Plane(Layer::kCoverage)[guides_.Index(x, y)] >= kCovered)) continue;
        Target target;
        if (!IsInside(x, y) || !FindTarget(x, y, target) || (next_ && !IsSeen(x, y, target))) {
          ++report.hidden;
          continue;
        }
        const MeanColor from = In255OnWhite(a_, x, y);
        const double change = MeanDifference(from, Moved(target));
        report.changes[guides_.Index(x, y)] = static_cast<float>(change);
        sum += change;
        floor += MeanDifference(from, MovedByItself(x, y, target));
        ++report.pixels;
      }
    }
    if (report.pixels == 0) return report;
    report.mean = sum / static_cast<double>(report.pixels);
    report.floor = floor / static_cast<double>(report.pixels);
    return report;
  }

 private:
  bool Shows(const GuideSet& guides, int x, int y, float object) const {
    if (x < 0 || y < 0 || x >= guides.width() || y >= guides.height()) return false;
    const std::size_t i = guides.Index(x, y);
    return guides.Plane(Layer::kCoverage)[i] >= kCovered && (!has_object_ || guides.Plane(Layer::kObject)[i] == object);
  }

  float ObjectAt(int x, int y) const { return has_object_ ? guides_.Plane(Layer::kObject)[guides_.Index(x, y)] : 0.0f; }

  bool IsInside(int x, int y) const {
    const float object = ObjectAt(x, y);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (!Shows(guides_, x + dx, y + dy, object)) return false;
      }
    }
    return true;
  }

  bool FindTarget(int x, int y, Target& target) const {
    const std::size_t i = guides_.Index(x, y);
    const double to_x = x + double(guides_.Plane(Layer::kMotion, 0)[i]);
    const double to_y = y + double(guides_.Plane(Layer::kMotion, 1)[i]);
    if (!(to_x >= 0.0 && to_y >= 0.0 && to_x <= guides_.width() - 1 && to_y <= guides_.height() - 1)) return false;
    target.x = static_cast<int>(to_x), target.y = static_cast<int>(to_y);
    target.along_x = to_x - target.x, target.along_y = to_y - target.y;
    return true;
  }

  bool IsSeen(int x, int y, const Target& target) const {
    const std::size_t here = guides_.Index(x, y);
    glm::dvec3 place(0.0);
    for (int dy = 0; dy < 2; ++dy) {
      for (int dx = 0; dx < 2; ++dx) {
        const double weight = target.Weight(dx, dy);
        if (!(weight > 0.0)) continue;
        if (!Shows(*next_, target.x + dx, target.y + dy, ObjectAt(x, y))) return false;
        const std::size_t there = next_->Index(target.x + dx, target.y + dy);
        if (has_pref_) place += weight * glm::dvec3(next_->Vec3(Layer::kPref, there));
        if (has_pref_ || !has_depth_) continue;
        const double depth = guides_.Plane(Layer::kDepth)[here];
        if (!(std::fabs(next_->Plane(Layer::kDepth)[there] - depth) <= kDepthChange * depth)) return false;
      }
    }
    return !has_pref_ || glm::distance(place, PrefAt(x, y)) <= StepAround(x, y);
  }

  glm::dvec3 PrefAt(int x, int y) const { return glm::dvec3(guides_.Vec3(Layer::kPref, guides_.Index(x, y))); }

  double StepAround(int x, int y) const {
    double step = 0.0;
    for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      step = std::max(step, glm::distance(PrefAt(x, y), PrefAt(x + dx, y + dy)));
    }
    return step;
  }

  MeanColor Moved(const Target& target) const {
    MeanColor sum{};
    for (int dy = 0; dy < 2; ++dy) {
      for (int dx = 0; dx < 2; ++dx) {
        const double weight = target.Weight(dx, dy);
        if (weight > 0.0) Add(sum, weight, In255OnWhite(b_, target.x + dx, target.y + dy));
      }
    }
    return sum;
  }

  // `a` shifted bilinearly by that fraction of a pixel, then sampled like b.
  MeanColor MovedByItself(int x, int y, const Target& target) const {
    const auto weights = [](double t) {
      return std::array<double, 3>{t * (1 - t), (1 - t) * (1 - t) + t * t, t * (1 - t)};
    };
    const auto across = weights(target.along_x), down = weights(target.along_y);
    MeanColor sum{};
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        Add(sum, across[std::size_t(dx + 1)] * down[std::size_t(dy + 1)], In255OnWhite(a_, x + dx, y + dy));
      }
    }
    return sum;
  }

  const Picture &a_, &b_;
  const GuideSet& guides_;
  const GuideSet* next_;
  bool has_object_ = false, has_depth_ = false, has_pref_ = false;
};

Status CheckSize(const char* what, int width, int height, const GuideSet& guides) {
  if (width == guides.width() && height == guides.height()) return Ok();
  return InputError(std::string(what) + " is " + std::to_string(width) + "×" + std::to_string(height) +
                    ", the guides with the motion are " + std::to_string(guides.width()) + "×" +
                    std::to_string(guides.height()) + ": flicker is measured between frames of one size");
}

}  // namespace

Expected<FlickerReport> MeasureFlicker(const Picture& a, const Picture& b, const GuideSet& guides,
                                       const GuideSet* next_guides) {
  SCUMBLE_RETURN_IF_ERROR(CheckSize("the first picture", a.width, a.height, guides));
  SCUMBLE_RETURN_IF_ERROR(CheckSize("the second picture", b.width, b.height, guides));
  if (next_guides) {
    SCUMBLE_RETURN_IF_ERROR(
        CheckSize("the next frame's guide set", next_guides->width(), next_guides->height(), guides));
  }
  if (!guides.Has(Layer::kMotion)) {
    return InputError("the first frame's guides have no layer motion, but " + guides.layers().ToString() +
                      ": cast them with --frames and --layers motion");
  }
  return Flicker(a, b, guides, next_guides).Measure();
}

}  // namespace scumble
