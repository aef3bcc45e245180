// Oil, alla prima: bundles of bristles drag wet paint round the light, big brushes first. A second canvas takes the
// thickness that each bristle leaves, and light across it shows the relief.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "exemplars/paint/brush.h"
#include "exemplars/paint/media.h"
#include "exemplars/paint/paper.h"
#include "exemplars/paint/sphere.h"
#include "exemplars/paint/strokes.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

enum Pass : std::uint64_t { kCanvas, kHighlight, kFirstLayer, kGround = 100 };

constexpr const char* kBristle = "tanda/oil-01-paint";

// One size of brush, worked over the whole picture.
struct BrushLayer {
  float spacing;  // of the strokes' middles
  float width_min, width_max;
  float length_min, length_max;
  float sway;         // how far strokes leave the circles round the light
  float broken;       // variation of colour from stroke to stroke
  float bristle;      // radius of one; they lie a little more than that apart
  bool details_only;  // only where the tones turn fast
};
constexpr std::array<BrushLayer, 4> kLayers{{
    {34.0f, 38.0f, 50.0f, 90.0f, 150.0f, 0.30f, 0.16f, 4.0f, false},
    {21.0f, 22.0f, 32.0f, 60.0f, 110.0f, 0.28f, 0.22f, 2.6f, false},
    {16.0f, 15.0f, 21.0f, 40.0f, 80.0f, 0.28f, 0.24f, 2.2f, false},
    {15.0f, 9.0f, 13.0f, 26.0f, 50.0f, 0.22f, 0.18f, 2.0f, true},
}};

// Warm light, cool shade: ochre over terracotta, plum in the core, blue-green where light comes back.
glm::vec3 PaletteAt(glm::vec2 at) {
  constexpr glm::vec3 kHigh{1.00f, 0.94f, 0.74f}, kLight{0.95f, 0.70f, 0.33f}, kMiddle{0.82f, 0.40f, 0.19f},
      kTurn{0.52f, 0.19f, 0.21f}, kCore{0.17f, 0.09f, 0.20f}, kReflected{0.25f, 0.37f, 0.46f};
  const Shading shading = ShadingAt(at);
  glm::vec3 color = glm::mix(kCore, kTurn, Ramp(0.0f, 0.24f, shading.light));
  color = glm::mix(color, kMiddle, Ramp(0.14f, 0.46f, shading.light));
  color = glm::mix(color, kLight, Ramp(0.40f, 0.86f, shading.light));
  color = glm::mix(color, kHigh, Ramp(0.80f, 1.0f, shading.light) * (0.55f + 0.4f * shading.highlight));
  return glm::mix(color, kReflected, 0.95f * Ramp(0.10f, 0.95f, shading.reflected));
}

// Each stroke is loaded afresh from the palette and never twice the same.
glm::vec3 BreakColor(Chance& chance, glm::vec3 color, float light, float amount) {
  constexpr glm::vec3 kRose{0.86f, 0.42f, 0.42f}, kLemon{0.98f, 0.84f, 0.42f}, kTeal{0.16f, 0.36f, 0.40f},
      kCrimson{0.46f, 0.10f, 0.20f};
  const bool first = chance.Happens(0.5f);
  const glm::vec3 warm = first ? kRose : kLemon;
  const glm::vec3 cool = first ? kTeal : kCrimson;
  const float weight = std::fabs(chance.Bell(amount));
  const float brightness = 1.0f + chance.Bell(0.6f * amount);
  return glm::mix(color, glm::mix(cool, warm, Ramp(0.10f, 0.5f, light)), weight) * brightness;
}

class OilPainter {
 public:
  // `undertone` is what shows where no stroke comes.
  OilPainter(const Sheet& sheet, std::uint64_t seed, glm::vec3 undertone, Brush paint, Brush thickness)
      : seed_(seed), paint_(std::move(paint)), thickness_(std::move(thickness)), colors_(sheet), heights_(sheet) {
    for (Brush* brush : {&paint_, &thickness_}) {
      brush->Set(MYPAINT_BRUSH_SETTING_DABS_PER_ACTUAL_RADIUS, 2.0f)
          .Set(MYPAINT_BRUSH_SETTING_DABS_PER_BASIC_RADIUS, 0.0f);
    }
    // Thickness is laid, not mixed.
    thickness_.Set(MYPAINT_BRUSH_SETTING_SMUDGE, 0.0f);
    colors_.Fill(undertone);
    heights_.Fill(glm::vec3(0.3f));
  }

  void WorkOver(const BrushLayer& layer, std::uint64_t stream) {
    Chance chance(seed_, stream);
    for (const glm::vec2 middle : SowEvenly(chance, layer.spacing)) {
      const Shading shading = ShadingAt(middle);
      const float turning = Ramp(0.45f, 0.05f, std::fabs(shading.light - 0.15f)) + Ramp(0.78f, 0.95f, shading.light) +
                            Ramp(0.86f, 1.0f, RimDistance(middle));
      if (layer.details_only && !chance.Happens(0.18f + 0.6f * turning)) continue;
      // Round the light, or now and then across the form.
      const glm::vec3 axis = kKeyLight + chance.Bell3(layer.sway);
      const Flow flow = chance.Happens(0.82f) ? AroundAxis(axis) : TowardsAxis(axis);
      const float width = chance.Uniform(layer.width_min, layer.width_max);
      Stroke path = TraceStroke(flow, middle, chance.Uniform(layer.length_min, layer.length_max));
      if (chance.Happens(0.5f)) std::reverse(path.begin(), path.end());
      const glm::vec3 color = BreakColor(chance, PaletteAt(middle), shading.light, layer.broken);
      const float load = 0.35f + 0.65f * Ramp(0.1f, 0.9f, shading.light);
      DragBristles(chance, path, {width, layer.bristle, load}, color);
    }
  }

  // Thick dabs of the lightest colour where the light mirrors.
  void PlaceHighlight() {
    Chance chance(seed_, kHighlight);
    const glm::vec3 halfway = glm::normalize(kKeyLight + glm::vec3(0, 0, 1));
    for (int i = 0; i < 40; ++i) {
      const glm::vec3 normal = glm::normalize(halfway + chance.Bell3(0.06f));
      const Flow flow = AroundAxis(kKeyLight + chance.Bell3(0.2f));
      const Stroke path = TraceStroke(flow, PlaceOf(normal), chance.Uniform(22.0f, 44.0f));
      const glm::vec3 color = glm::vec3(1.0f, 0.955f, 0.84f) * (1.0f + chance.Bell(0.02f));
      DragBristles(chance, path, {chance.Uniform(10.0f, 16.0f), 2.2f, 1.0f}, color);
    }
  }

  // Loose strokes of one quiet colour, slanting now this way, now that. No stroke stands out: the eye would find it
  // again in the next tile.
  void BrushGround(glm::vec3 color) {
    Chance chance(seed_, kGround);
    for (const float spacing : {25.6f, 18.3f}) {
      for (const glm::vec2 middle : SowEvenly(chance, spacing, colors_.sheet().units, 0.0f)) {
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

  // Light across the relief; `depth` weakens it for what is to recede.
  Colors Finish(float depth = 1.0f) const {
    Colors colors(colors_.sheet());
    const Layer layer = colors_.Read();
    for (std::size_t i = 0; i < colors.pixels.size(); ++i) colors.pixels[i] = glm::vec3(layer.pixels[i]);
    Field height = Plane(heights_.Read(), 0);
    // Thin paint lets the weave of the canvas through.
    const Field weave = MakeTooth(colors.sheet, {Tooth::kLaid, 6.0f}, Hash(seed_, kCanvas));
    for (std::size_t i = 0; i < height.pixels.size(); ++i) height.pixels[i] += 0.05f * weave.pixels[i];
    LightRelief(colors, height, {.shade = 0.72f * depth, .sheen = 0.12f * depth});
    return colors;
  }

 private:
  struct Tuft {
    float width;
    float bristle;
    float load;            // how thick the paint is, 0 … 1
    float streaks = 1.0f;  // how far the colours of its bristles part
  };

  void DragBristles(Chance& chance, const Stroke& path, const Tuft& tuft, glm::vec3 color) {
    const int bristles = std::max(4, static_cast<int>(tuft.width / (1.2f * tuft.bristle)));
    paint_.Radius(tuft.bristle);
    thickness_.Radius(tuft.bristle);
    const float press = chance.Uniform(0.55f, 0.85f);
    const float lean = chance.Bell(0.08f);  // more paint on one side of the brush
    for (int k = 0; k < bristles; ++k) {
      const float across = (static_cast<float>(k) + 0.5f) / static_cast<float>(bristles) - 0.5f;
      const float outer = 2.0f * std::fabs(across);
      const float offset = across * tuft.width + chance.Bell(0.5f);
      const Stroke line = OneBristle(chance, path, offset, outer, press);
      if (line.size() < 3) continue;
      const float shift = chance.Bell(0.035f * tuft.streaks);
      paint_.Color(color * glm::vec3(1.0f + shift, 1.0f + 0.9f * shift,
                                     1.0f + 0.7f * shift + chance.Bell(0.025f * tuft.streaks)));
      paint_.Paint(colors_, line);
      const float ridge = 0.30f * Ramp(0.65f, 1.0f, outer);
      const float height =
          0.34f + tuft.load * (0.12f + ridge) + (0.05f + 0.06f * tuft.load) * chance.Bell() + lean * across;
      thickness_.Color(glm::vec3(glm::clamp(height, 0.0f, 1.0f)));
      thickness_.Paint(heights_, line);
    }
  }

  // Bristles start almost together and run dry one by one, the outer ones first.
  static Stroke OneBristle(Chance& chance, const Stroke& path, float offset, float outer, float press) {
    const int count = static_cast<int>(path.size());
    const int begin = chance.Whole(0, 2);
    const float dry = chance.Happens(0.15f) ? chance.Uniform(1.0f, 5.0f) : 0.0f;
    const int end = count - static_cast<int>(chance.Uniform() * outer * 3.0f + dry);
    Stroke line;
    for (int i = begin; i < end; ++i) {
      const glm::vec2 before = path[static_cast<std::size_t>(std::max(0, i - 1))].at;
      const glm::vec2 after = path[static_cast<std::size_t>(std::min(count - 1, i + 1))].at;
      const glm::vec2 along = (after - before) / std::max(glm::distance(after, before), 1e-5f);
      const float u = static_cast<float>(i) / static_cast<float>(count - 1);
      const float pressure = press * (0.5f + 0.5f * Ramp(0.0f, 0.15f, u)) * Ramp(1.04f, 0.8f, u);
      line.push_back({path[static_cast<std::size_t>(i)].at + glm::vec2(-along.y, along.x) * offset, pressure});
    }
    return line;
  }

  std::uint64_t seed_;
  Brush paint_;
  Brush thickness_;
  Canvas colors_;
  Canvas heights_;
};

}  // namespace

Expected<Picture> PaintOil(const Studio& studio) {
  SCUMBLE_ASSIGN(Brush paint, Brush::Load(studio.brushes, kBristle));
  SCUMBLE_ASSIGN(Brush thickness, Brush::Load(studio.brushes, kBristle));
  constexpr glm::vec3 kUndertone{0.42f, 0.30f, 0.24f};
  OilPainter painter({studio.size}, studio.seed, kUndertone, std::move(paint), std::move(thickness));
  std::uint64_t stream = kFirstLayer;
  for (const BrushLayer& layer : kLayers) painter.WorkOver(layer, stream++);
  painter.PlaceHighlight();
  return ToPicture(painter.Finish());
}

Expected<Picture> OilGround(const Studio& studio) {
  SCUMBLE_ASSIGN(Brush paint, Brush::Load(studio.brushes, kBristle));
  SCUMBLE_ASSIGN(Brush thickness, Brush::Load(studio.brushes, kBristle));
  constexpr glm::vec3 kGrey{0.561f, 0.639f, 0.651f};
  OilPainter painter(TileFor(studio.size), studio.seed, 0.96f * kGrey, std::move(paint), std::move(thickness));
  painter.BrushGround(kGrey);
  return ToPicture(painter.Finish(0.5f));
}

}  // namespace scumble::paint
