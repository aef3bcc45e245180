#include "exemplars/paint/engine/flat_brush.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scumble::paint {
namespace {

constexpr float kFine = 1.6f;  // units between the points of a short path

glm::vec2 Aside(const Stroke& path, std::size_t i) {
  const glm::vec2 along = path[std::min(i + 1, path.size() - 1)].at - path[i > 0 ? i - 1 : 0].at;
  return glm::vec2(-along.y, along.x) / std::max(glm::length(along), 1e-5f);
}

}  // namespace

FlatBrush::FlatBrush(Brush paint, Brush relief) : paint_(std::move(paint)), relief_(std::move(relief)) {
  for (Brush* brush : {&paint_, &relief_}) {
    // Opaque paint covers and does not mix with the paint under it.
    brush->Set(MYPAINT_BRUSH_SETTING_SMUDGE, -1.0f)
        .Set(MYPAINT_BRUSH_SETTING_DABS_PER_ACTUAL_RADIUS, 2.0f)
        .Set(MYPAINT_BRUSH_SETTING_DABS_PER_BASIC_RADIUS, 0.0f);
  }
}

Expected<FlatBrush> FlatBrush::Cut(const Studio& studio, const std::string& hair) {
  SCUMBLE_ASSIGN(Brush paint, Brush::Load(studio.brushes, hair));
  SCUMBLE_ASSIGN(Brush relief, Brush::Load(studio.brushes, hair));
  return FlatBrush(std::move(paint), std::move(relief));
}

void FlatBrush::Drag(Canvas& colors, Canvas* heights, Chance& chance, const Stroke& path, const Load& load,
                     const Touch& touch) {
  const int bristles = std::max(3, static_cast<int>(std::lround(load.width / (1.25f * load.bristle))));
  const float step = glm::distance(path[0].at, path[1].at);
  for (int k = 0; k < bristles; ++k) {
    const float across = (static_cast<float>(k) + 0.5f) / static_cast<float>(bristles) - 0.5f;
    const float outer = 4.0f * across * across;
    const float offset = across * load.width + chance.Bell(0.2f * load.bristle);
    const float curve = 0.5f * load.rounded * load.width * (1.0f - std::sqrt(1.0f - outer));
    const float first = (curve + chance.Uniform(0.0f, 0.4f + 0.6f * outer) * load.ragged) / step;
    const float last =
        static_cast<float>(path.size()) - (curve + chance.Uniform(0.0f, 0.4f + 0.6f * outer) * load.ragged) / step;
    const float gain = 1.0f + chance.Bell(0.12f);
    const float radius = load.bristle * (1.0f + chance.Bell(0.15f));
    Stroke line;
    for (std::size_t i = static_cast<std::size_t>(first); i < path.size() && static_cast<float>(i) < last; ++i) {
      const float along = static_cast<float>(i) / static_cast<float>(path.size() - 1);
      line.push_back({path[i].at + Aside(path, i) * offset,
                      gain * path[i].pressure * glm::mix(load.press.x, load.press.y, along)});
    }
    const float shift = chance.Bell(0.035f * load.streaks);
    const glm::vec3 streak(1.0f + shift, 1.0f + 0.9f * shift, 1.0f + 0.7f * shift + chance.Bell(0.02f * load.streaks));
    const float height = load.height + load.ridge * (Ramp(0.5f, 1.0f, outer) + chance.Bell(0.35f));
    const glm::vec2 beside = load.tremble * glm::vec2(chance.Bell3(1.0f));
    const Touch asked = [&](glm::vec2 at) { return touch ? touch(at + beside) : 1.0f; };
    const std::vector<Stroke> pieces = Press(line, asked, 1.0f, 0.06f);
    paint_.Radius(radius).Color(load.color * streak);
    paint_.Paint(colors, pieces);
    if (!heights) continue;
    relief_.Radius(radius).Color(glm::vec3(glm::clamp(height, 0.0f, 1.0f)));
    relief_.Paint(*heights, pieces);
  }
}

Stroke ShortPath(Chance& chance, glm::vec2 middle, glm::vec2 direction, float length, float bend) {
  const glm::vec2 along = direction / std::max(glm::length(direction), 1e-5f);
  const glm::vec2 aside(-along.y, along.x);
  const float sag = chance.Bell(bend) * length;
  const int steps = std::max(7, static_cast<int>(std::lround(length / kFine)));
  Stroke path;
  for (int i = 0; i <= steps; ++i) {
    const float u = static_cast<float>(i) / static_cast<float>(steps) - 0.5f;
    path.push_back({middle + along * (u * length) + aside * (sag * (0.25f - u * u)), 1.0f});
  }
  return path;
}

}  // namespace scumble::paint
