#include "exemplars/paint/engine/brush.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

namespace scumble::paint {
namespace {

constexpr float kSpeed = 900.0f;    // units a second: a fast hand; some presets depend on it
constexpr float kBrushStep = 3.0f;  // pixels between the positions that the brush receives

glm::vec3 HsvFromRgb(glm::vec3 color) {
  const float high = std::max({color.r, color.g, color.b});
  const float chroma = high - std::min({color.r, color.g, color.b});
  float hue = 0.0f;
  if (chroma > 1e-6f) {
    if (high == color.r) {
      hue = (color.g - color.b) / chroma;
    } else if (high == color.g) {
      hue = (color.b - color.r) / chroma + 2.0f;
    } else {
      hue = (color.r - color.g) / chroma + 4.0f;
    }
  }
  if (hue < 0.0f) hue += 6.0f;
  return {hue / 6.0f, high > 0.0f ? chroma / high : 0.0f, high};
}

}  // namespace

Expected<Brush> Brush::Load(const std::filesystem::path& folder, const std::string& preset) {
  const std::filesystem::path path = folder / (preset + ".myb");
  std::ifstream file(path);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file || text.empty()) {
    return InputError(path.string() +
                      " cannot be read: expected a brush of the package mypaint-brushes; "
                      "install it or point --brushes at its folder");
  }
  Brush brush;
  brush.brush_.reset(mypaint_brush_new());
  mypaint_brush_from_defaults(brush.brush_.get());
  if (!mypaint_brush_from_string(brush.brush_.get(), text.c_str())) {
    return InputError(path.string() + " is not a brush that libmypaint understands: expected its JSON of version 3");
  }
  brush.radius_ = std::exp(mypaint_brush_get_base_value(brush.brush_.get(), MYPAINT_BRUSH_SETTING_RADIUS_LOGARITHMIC));
  // Tracking lag pulls strokes inwards and cuts their ends short, and the planner has smoothed them already.
  brush.Set(MYPAINT_BRUSH_SETTING_SLOW_TRACKING, 0.0f);
  // Tracking noise starts from memory that libmypaint leaves uninitialised: two runs would differ.
  brush.Set(MYPAINT_BRUSH_SETTING_TRACKING_NOISE, 0.0f);
  return brush;
}

Brush& Brush::Radius(float units) {
  radius_ = units;
  return *this;
}

Brush& Brush::Color(glm::vec3 srgb) {
  const glm::vec3 hsv = HsvFromRgb(glm::clamp(srgb, 0.0f, 1.0f));
  Set(MYPAINT_BRUSH_SETTING_COLOR_H, hsv.x);
  Set(MYPAINT_BRUSH_SETTING_COLOR_S, hsv.y);
  return Set(MYPAINT_BRUSH_SETTING_COLOR_V, hsv.z);
}

Brush& Brush::Set(MyPaintBrushSetting setting, float value) {
  mypaint_brush_set_base_value(brush_.get(), setting, value);
  return *this;
}

void Brush::Paint(Canvas& canvas, const Stroke& stroke) {
  if (stroke.size() < 2) return;
  const float scale = canvas.pixels_per_unit();
  MyPaintBrush* brush = brush_.get();
  MyPaintSurface* surface = canvas.surface();
  Set(MYPAINT_BRUSH_SETTING_RADIUS_LOGARITHMIC, std::log(radius_ * scale));

  mypaint_surface_begin_atomic(surface);
  mypaint_brush_reset(brush);
  mypaint_brush_new_stroke(brush);
  const auto move_to = [&](glm::vec2 at, float pressure, double seconds) {
    mypaint_brush_stroke_to(brush, surface, at.x * scale, at.y * scale, pressure, 0.0f, 0.0f, seconds);
  };
  // A long pause above the paper moves the brush to its start without leaving a mark.
  move_to(stroke.front().at, 0.0f, 10.0);
  for (std::size_t i = 1; i < stroke.size(); ++i) {
    const StrokePoint& from = stroke[i - 1];
    const StrokePoint& to = stroke[i];
    const float length = glm::distance(from.at, to.at);
    const int steps = std::max(1, static_cast<int>(std::ceil(length * scale / kBrushStep)));
    for (int k = 1; k <= steps; ++k) {
      const float t = static_cast<float>(k) / static_cast<float>(steps);
      move_to(glm::mix(from.at, to.at, t), glm::mix(from.pressure, to.pressure, t),
              length / static_cast<float>(steps) / kSpeed + 1e-4);
    }
  }
  MyPaintRectangle touched;
  mypaint_surface_end_atomic(surface, &touched);
}

void Brush::Paint(Canvas& canvas, const std::vector<Stroke>& strokes) {
  for (const Stroke& stroke : strokes) Paint(canvas, stroke);
}

}  // namespace scumble::paint
