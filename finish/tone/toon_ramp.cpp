#include "finish/tone/toon_ramp.h"

#include <algorithm>
#include <cmath>

#include "core/image/color.h"
#include "core/image/exact_math.h"

namespace scumble::internal {
RampRows::RampRows(const ToonPass& pass, const FinishFrame& frame)
    : rays_(*frame.guides), width_(static_cast<std::size_t>(frame.guides->width())) {
  const GuideSet& guides = *frame.guides;
  if (pass.ramp_rows == ToonPass::Rows::kDepth) {
    depth_ = guides.Plane(Layer::kDepth);
    near_ = frame.measures.near, far_ = frame.measures.far;
    if (!(near_ > 0.0)) near_ = std::min(far_, 1e-3);  // a surface at the eye
    if (far_ > near_) {
      const double log_near = Log2(near_), per_log = 1.0 / (Log2(far_) - log_near);
      of_depth_ = Curve(far_, [=](double depth) { return (Log2(depth) - log_near) * per_log; });
    }
    return;
  }
  const bool by_highlight = pass.ramp_rows == ToonPass::Rows::kHighlight;
  for (int c = 0; c < 3; ++c) {
    (by_highlight ? highlight_ : normal_)[c] = guides.Plane(by_highlight ? Layer::kLpeLSE : Layer::kNormal, c);
  }
  bright_ = static_cast<float>(frame.measures.bright);
}

float RampRows::Depth(std::size_t pixel) const {
  const double depth = depth_[pixel];
  if (!(depth > near_) || !(far_ > near_)) return 0.0f;
  return depth < far_ ? static_cast<float>(of_depth_.At(depth)) : 1.0f;
}

void RampRows::At(std::size_t first, std::size_t count, float* rows) const {
  if (!depth_.empty()) {
    for (std::size_t i = 0; i < count; ++i) rows[i] = Depth(first + i);
    return;
  }
  if (!highlight_[0].empty()) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t p = first + i;
      const float row = Luminance(highlight_[0][p], highlight_[1][p], highlight_[2][p]) / bright_;
      rows[i] = row > 0.0f ? row < 1.0f ? row : 1.0f : 0.0f;  // NaN is no highlight
    }
    return;
  }
  const int column = static_cast<int>(first % width_), row = static_cast<int>(first / width_);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec2 sight = rays_.SightAt(column + static_cast<int>(i), row);
    const float x = sight.x, y = sight.y;
    const float along = normal_[2][first + i] - normal_[0][first + i] * x - normal_[1][first + i] * y;
    const float away = 1.0f - std::fabs(along) / std::sqrt(1.0f + x * x + y * y);
    rows[i] = away > 0.0f ? away : 0.0f;  // NaN faces the viewer
  }
}

RampColors::RampColors(const ColorRamp& ramp) : columns_(ramp.columns), rows_(ramp.rows) {
  for (const Rgb16& color : ramp.colors) colors_.push_back(ToOklab(color));
}

LabColor RampColors::At(float tone, float row) const {
  const float x = tone * static_cast<float>(columns_ - 1), y = row * static_cast<float>(rows_ - 1);
  const int left = std::min(static_cast<int>(x), columns_ - 1), top = std::min(static_cast<int>(y), rows_ - 1);
  const float u = x - static_cast<float>(left), v = y - static_cast<float>(top);
  const auto mix = [](const LabColor& from, const LabColor& to, float share) {
    return LabColor{from.lightness + (to.lightness - from.lightness) * share, from.a + (to.a - from.a) * share,
                    from.b + (to.b - from.b) * share};
  };
  const auto across = [&](int line) {
    const LabColor* const colors = colors_.data() + std::ptrdiff_t(line) * columns_;
    return mix(colors[left], colors[std::min(left + 1, columns_ - 1)], u);
  };
  return v > 0.0f ? mix(across(top), across(std::min(top + 1, rows_ - 1)), v) : across(top);
}

}  // namespace scumble::internal
