// A brush of libmypaint, loaded from a preset of MyPaint's users.
#pragma once

extern "C" {
#include <mypaint-brush-settings.h>
#include <mypaint-brush.h>
}

#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "core/image/status.h"
#include "exemplars/paint/engine/canvas.h"

namespace scumble::paint {

struct StrokePoint {
  glm::vec2 at;           // units of kSide
  float pressure = 0.0f;  // 0 … 1
};
using Stroke = std::vector<StrokePoint>;

class Brush {
 public:
  // `preset` is a path under `folder` without its ending: "tanda/charcoal-03".
  static Expected<Brush> Load(const std::filesystem::path& folder, const std::string& preset);

  // Units of kSide; the preset's pressure response is added.
  Brush& Radius(float units);
  Brush& Color(glm::vec3 srgb);
  Brush& Set(MyPaintBrushSetting setting, float value);

  // Draws through the points, at least two, at an even speed.
  void Paint(Canvas& canvas, const Stroke& stroke);
  void Paint(Canvas& canvas, const std::vector<Stroke>& strokes);

 private:
  struct Unref {
    void operator()(MyPaintBrush* brush) const { mypaint_brush_unref(brush); }
  };
  std::unique_ptr<MyPaintBrush, Unref> brush_;
  float radius_ = 1.0f;
};

}  // namespace scumble::paint
