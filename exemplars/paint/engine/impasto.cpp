#include "exemplars/paint/engine/impasto.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "exemplars/paint/engine/media.h"
#include "exemplars/paint/engine/paper.h"
#include "exemplars/paint/engine/strokes.h"

namespace scumble::paint {
namespace {

enum Pass : std::uint64_t { kCanvas, kHighlight, kFirstLayer, kGround = 100 };

constexpr const char* kBristle = "tanda/oil-01-paint";

// Each stroke gets its own colour from the palette, never twice the same.
glm::vec3 BreakColor(Chance& chance, const Palette& palette, const Shading& shading, float amount) {
  const bool first = chance.Happens(0.5f);
  const glm::vec3 warm = palette.warm[first ? 0 : 1];
  const glm::vec3 cool = palette.cool[first ? 0 : 1];
  const float weight = std::fabs(chance.Bell(amount));
  const float brightness = 1.0f + chance.Bell(0.6f * amount);
  return glm::mix(palette.At(shading), glm::mix(cool, warm, Ramp(0.10f, 0.5f, shading.light)), weight) * brightness;
}

// Bristles start almost together and end one by one, the outer ones first.
Stroke OneBristle(Chance& chance, const Stroke& path, float offset, float outer, float press) {
  const int count = static_cast<int>(path.size());
  const int begin = chance.Whole(0, 2);
  const float dry = chance.Happens(0.15f) ? chance.Uniform(1.0f, 5.0f) : 0.0f;
  const int end = count - static_cast<int>(chance.Uniform() * outer * 3.0f + dry);
  Stroke line;
  for (int i = begin; i < end; ++i) {
    const float u = static_cast<float>(i) / static_cast<float>(count - 1);
    const float pressure = press * (0.5f + 0.5f * Ramp(0.0f, 0.15f, u)) * Ramp(1.04f, 0.8f, u);
    line.push_back({Beside(path, static_cast<std::size_t>(i), offset), pressure});
  }
  return line;
}

}  // namespace

glm::vec3 Palette::At(const Shading& shading) const {
  glm::vec3 color = glm::mix(core, turn, Ramp(0.0f, 0.24f, shading.light));
  color = glm::mix(color, middle, Ramp(0.14f, 0.46f, shading.light));
  color = glm::mix(color, light, Ramp(0.40f, 0.86f, shading.light));
  color = glm::mix(color, high, Ramp(0.80f, 1.0f, shading.light) * (0.55f + 0.4f * shading.highlight));
  return glm::mix(color, reflected, 0.95f * Ramp(0.10f, 0.95f, shading.reflected));
}

Expected<Impasto> Impasto::Begin(const Sheet& sheet, const Studio& studio, glm::vec3 undertone, float thickness) {
  SCUMBLE_ASSIGN(Brush paint, Brush::Load(studio.brushes, kBristle));
  SCUMBLE_ASSIGN(Brush relief, Brush::Load(studio.brushes, kBristle));
  return Impasto(sheet, studio, undertone, thickness, std::move(paint), std::move(relief));
}

Impasto::Impasto(const Sheet& sheet, const Studio& studio, glm::vec3 undertone, float thickness, Brush paint,
                 Brush relief)
    : seed_(studio.seed),
      light_(studio.light),
      thickness_(thickness),
      paint_(std::move(paint)),
      relief_(std::move(relief)),
      colors_(std::make_unique<Canvas>(sheet)),
      heights_(std::make_unique<Canvas>(sheet)) {
  for (Brush* brush : {&paint_, &relief_}) {
    brush->Set(MYPAINT_BRUSH_SETTING_DABS_PER_ACTUAL_RADIUS, 2.0f)
        .Set(MYPAINT_BRUSH_SETTING_DABS_PER_BASIC_RADIUS, 0.0f);
  }
  // Thickness is laid, not mixed.
  relief_.Set(MYPAINT_BRUSH_SETTING_SMUDGE, 0.0f);
  colors_->Fill(undertone);
  heights_->Fill(glm::vec3(0.3f));
}

void Impasto::WorkOver(const Palette& palette, std::span<const BrushLayer> layers) {
  std::uint64_t stream = kFirstLayer;
  for (const BrushLayer& layer : layers) {
    Chance chance(seed_, stream++);
    for (const glm::vec2 middle : SowEvenly(chance, layer.spacing)) {
      const Shading shading = ShadingAt(middle, light_);
      const float turning = Ramp(0.45f, 0.05f, std::fabs(shading.light - 0.15f)) + Ramp(0.78f, 0.95f, shading.light) +
                            Ramp(0.86f, 1.0f, RimDistance(middle));
      if (layer.details_only && !chance.Happens(0.18f + 0.6f * turning)) continue;
      // Round the light, or now and then across the form.
      const glm::vec3 axis = Towards(light_) + chance.Bell3(layer.sway);
      const Flow flow = chance.Happens(1.0f - layer.across) ? AroundAxis(axis) : TowardsAxis(axis);
      const float width = chance.Uniform(layer.width_min, layer.width_max);
      Stroke path = TraceStroke(flow, middle, chance.Uniform(layer.length_min, layer.length_max));
      if (chance.Happens(0.5f)) std::reverse(path.begin(), path.end());
      const glm::vec3 color = BreakColor(chance, palette, shading, layer.broken);
      const float load = thickness_ * (0.35f + 0.65f * Ramp(0.1f, 0.9f, shading.light));
      DragBristles(chance, path, {width, layer.bristle, load}, color);
    }
  }
}

void Impasto::PlaceHighlight(glm::vec3 color, int dabs) {
  Chance chance(seed_, kHighlight);
  const glm::vec3 halfway = glm::normalize(kKeyLight + glm::vec3(0, 0, 1));
  for (int i = 0; i < dabs; ++i) {
    const glm::vec3 normal = glm::normalize(halfway + chance.Bell3(0.06f));
    const Flow flow = AroundAxis(kKeyLight + chance.Bell3(0.2f));
    const Stroke path = TraceStroke(flow, PlaceOf(normal), chance.Uniform(22.0f, 44.0f));
    const glm::vec3 broken = color * (1.0f + chance.Bell(0.02f));
    DragBristles(chance, path, {chance.Uniform(10.0f, 16.0f), 2.2f, 1.0f}, broken);
  }
}

void Impasto::BrushGround(glm::vec3 color) {
  Chance chance(seed_, kGround);
  for (const float spacing : {25.6f, 18.3f}) {
    for (const glm::vec2 middle : SowEvenly(chance, spacing, colors_->sheet().units, 0.0f)) {
      const float heading = chance.Happens(0.5f) ? 0.75f : -0.35f;
      const float angle = heading + chance.Bell(0.4f);
      const float curve = chance.Bell(0.003f);
      const Flow flow = [=](glm::vec2 at) {
        const float turned = angle + curve * (at.x - middle.x + at.y - middle.y);
        return glm::vec2(std::cos(turned), std::sin(turned));
      };
      Stroke path = TraceStroke(flow, middle, chance.Uniform(45.0f, 80.0f));
      if (chance.Happens(0.5f)) std::reverse(path.begin(), path.end());
      const float brightness = 1.0f + chance.Bell(0.012f);
      const float warmth = chance.Bell(0.004f);
      const glm::vec3 broken = color * brightness * glm::vec3(1.0f + warmth, 1.0f, 1.0f - warmth);
      DragBristles(chance, path, {chance.Uniform(14.0f, 26.0f), 2.4f, 0.1f, 0.6f}, broken);
    }
  }
}

Colors Impasto::Finish(float depth) const {
  Colors colors(colors_->sheet());
  const Layer layer = colors_->Read();
  for (std::size_t i = 0; i < colors.pixels.size(); ++i) colors.pixels[i] = glm::vec3(layer.pixels[i]);
  Field height = Plane(heights_->Read(), 0);
  // Thin paint shows the weave of the canvas.
  const Field weave = MakeTooth(colors.sheet, {Tooth::kLaid, 6.0f}, Hash(seed_, kCanvas));
  for (std::size_t i = 0; i < height.pixels.size(); ++i) height.pixels[i] += 0.05f * weave.pixels[i];
  LightRelief(colors, height, {.shade = 0.72f * depth, .sheen = 0.12f * depth});
  return colors;
}

void Impasto::DragBristles(Chance& chance, const Stroke& path, const Tuft& tuft, glm::vec3 color) {
  const int bristles = std::max(4, static_cast<int>(tuft.width / (1.2f * tuft.bristle)));
  paint_.Radius(tuft.bristle);
  relief_.Radius(tuft.bristle);
  const float press = chance.Uniform(0.55f, 0.85f);
  const float lean = chance.Bell(0.08f);  // more paint on one side of the brush
  for (int k = 0; k < bristles; ++k) {
    const float across = (static_cast<float>(k) + 0.5f) / static_cast<float>(bristles) - 0.5f;
    const float outer = 2.0f * std::fabs(across);
    const float offset = across * tuft.width + chance.Bell(0.5f);
    const Stroke line = OneBristle(chance, path, offset, outer, press);
    if (line.size() < 3) continue;
    const float shift = chance.Bell(0.035f * tuft.streaks);
    paint_.Color(
        color * glm::vec3(1.0f + shift, 1.0f + 0.9f * shift, 1.0f + 0.7f * shift + chance.Bell(0.025f * tuft.streaks)));
    paint_.Paint(*colors_, line);
    const float ridge = 0.30f * Ramp(0.65f, 1.0f, outer);
    const float height =
        0.34f + tuft.load * (0.12f + ridge) + (0.05f + 0.06f * tuft.load) * chance.Bell() + lean * across;
    relief_.Color(glm::vec3(glm::clamp(height, 0.0f, 1.0f)));
    relief_.Paint(*heights_, line);
  }
}

}  // namespace scumble::paint
