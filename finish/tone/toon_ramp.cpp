#include "finish/tone/toon_ramp.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "core/image/exact_math.h"

namespace scumble::internal {
namespace {

// Where the line of sight through a place of the picture, in pixels, meets the plane one metre before the eye.
glm::dvec2 SightAt(const glm::dmat4& view_from_clip, double x, double y, int width, int height) {
  const glm::dvec4 clip(2.0 * x / width - 1.0, 1.0 - 2.0 * y / height, 0.0, 1.0);
  const glm::dvec4 at = view_from_clip * clip;
  return glm::dvec2(at.x, at.y) / -at.z;  // in homogeneous coordinates
}

}  // namespace

RampRows::RampRows(const ToonPass& pass, const FinishFrame& frame)
    : width_(static_cast<std::size_t>(frame.guides->width())) {
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
  for (int c = 0; c < 3; ++c) normal_[c] = guides.Plane(Layer::kNormal, c);
  const auto frame_of_normals = guides.attributes.find("scumble:normal_frame");
  const bool face_eye = frame_of_normals != guides.attributes.end() && frame_of_normals->second == "eye";
  if (!guides.camera || guides.camera->IsOrthographic() || face_eye) return;
  const glm::dmat4 view_from_clip = glm::inverse(guides.camera->clip_from_view);
  const auto sight = [&](double x, double y) { return SightAt(view_from_clip, x, y, guides.width(), guides.height()); };
  const glm::dvec2 first = sight(0.5, 0.5), right = sight(1.5, 0.5) - first, down = sight(0.5, 1.5) - first;
  if (!std::isfinite(first.x + first.y + right.x + right.y + down.x + down.y)) return;  // no camera that sees
  x_[0] = float(first.x), x_[1] = float(right.x), x_[2] = float(down.x);
  y_[0] = float(first.y), y_[1] = float(right.y), y_[2] = float(down.y);
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
  const auto column = static_cast<float>(first % width_), row = static_cast<float>(first / width_);
  const float x0 = x_[0] + x_[1] * column + x_[2] * row, y0 = y_[0] + y_[1] * column + y_[2] * row;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = x0 + x_[1] * static_cast<float>(i), y = y0 + y_[1] * static_cast<float>(i);
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
