// Ink on East Asian rice paper: few broad strokes. Pale washes run into one another while the paper is wet, a dry brush
// sweeps along the turn of the form and leaves streaks of white, black pools in the core; the light is bare paper.
#include <algorithm>
#include <cmath>

#include "exemplars/paint/engine/hairs.h"
#include "exemplars/paint/engine/media.h"
#include "exemplars/paint/engine/paper.h"
#include "exemplars/paint/engine/strokes.h"
#include "exemplars/paint/sphere.h"
#include "exemplars/paint/styles.h"

namespace scumble::paint {
namespace {

constexpr Stock kPaper{Tooth::kFine, 5.0f, {0.955f, 0.94f, 0.905f}, 0.025f};
constexpr glm::vec3 kInk{0.073f, 0.065f, 0.062f};      // warm where it is thick
constexpr glm::vec3 kThinInk{0.059f, 0.063f, 0.068f};  // and cooler where water thins it
constexpr DryMedia kDryBrush{.bite = 0.6f, .softness = 0.25f, .density = 1.0f};
constexpr glm::vec3 kSweep{-0.56f, 0.65f, 0.51f};  // the strokes' circles go round it

enum Pass : std::uint64_t { kFibres = kFirstStream, kContour = 4, kFirstWash = 50 };

// Long fibres in the pulp, some lighter and some darker.
Status LayFibres(Ground& ground, const Studio& studio) {
  SCUMBLE_ASSIGN(Brush fibre, Brush::Load(studio.brushes, "deevad/rigger_brush"));
  Canvas canvas(ground.paper.sheet);
  Chance chance(studio.seed, kFibres);
  for (const glm::vec2 middle : SowEvenly(chance, 30.0f, ground.paper.sheet.units, 0.0f)) {
    const float angle = chance.Uniform(0.0f, 6.2831853f);
    const float curl = chance.Bell(0.006f);
    const Flow flow = [=](glm::vec2 at) {
      const float turned = angle + curl * (at.x - middle.x) - 0.7f * curl * (at.y - middle.y);
      return glm::vec2(std::cos(turned), std::sin(turned));
    };
    fibre.Radius(chance.Uniform(0.4f, 0.7f));
    fibre.Color(kPaper.color * (chance.Happens(0.7f) ? 1.04f : 0.85f));
    fibre.Set(MYPAINT_BRUSH_SETTING_OPAQUE, chance.Uniform(0.02f, 0.06f));
    Stroke line = TraceStroke(flow, middle, chance.Uniform(50.0f, 140.0f));
    for (StrokePoint& point : line) point.pressure = 0.6f;
    fibre.Paint(canvas, line);
  }
  const Layer layer = canvas.Read();
  for (std::size_t i = 0; i < layer.pixels.size(); ++i) {
    const glm::vec4 over = layer.pixels[i];
    ground.paper.pixels[i] = ground.paper.pixels[i] * (1.0f - over.w) + glm::vec3(over);
  }
  return Ok();
}

Expected<Ground> RicePaper(const Sheet& sheet, const Studio& studio) {
  Ground ground = PrepareGround(sheet, kPaper, studio.seed);
  SCUMBLE_RETURN_IF_ERROR(LayFibres(ground, studio));
  return ground;
}

// One brush and one bowl of ink.
struct Wash {
  float from, below;  // strokes have their middles where the value is between these
  float ragged;       // the random shift of the upper border
  float spacing;      // of the strokes' middles
  glm::vec2 width;
  glm::vec2 length;
  Tuft tuft;       // but for its width
  float wetness;   // the spread of the ink in the wet paper, in units; 0: dry brush
  float strength;  // of the ink in the picture
  float inside;    // share of the width that strokes keep inside the rim
};
constexpr Wash kWashes[] = {
    // Pale, wet in wet.
    {.from = 0.0f,
     .below = 0.46f,
     .ragged = 0.08f,
     .spacing = 120.0f,
     .width{100.0f, 150.0f},
     .length{360.0f, 640.0f},
     .tuft{.width = 0.0f, .hair = 5.0f, .ink = 0.30f},
     .wetness = 15.0f,
     .strength = 0.36f,
     .inside = 0.2f},
    // Pale, on paper that has nearly dried: the strokes keep their edges.
    {.from = 0.0f,
     .below = 0.40f,
     .ragged = 0.10f,
     .spacing = 104.0f,
     .width{60.0f, 110.0f},
     .length{300.0f, 620.0f},
     .tuft{.width = 0.0f, .hair = 2.4f, .gap = 1.6f, .ink = 0.36f, .dryness = 0.30f},
     .wetness = 2.5f,
     .strength = 0.48f,
     .inside = 0.2f},
    // Middle grey, into the shade.
    {.from = 0.0f,
     .below = 0.22f,
     .ragged = 0.04f,
     .spacing = 86.0f,
     .width{70.0f, 110.0f},
     .length{320.0f, 560.0f},
     .tuft{.width = 0.0f, .hair = 2.6f, .gap = 1.6f, .ink = 0.42f, .dryness = 0.35f},
     .wetness = 5.0f,
     .strength = 0.78f,
     .inside = 0.1f},
    // Black pools in the core.
    {.from = 0.0f,
     .below = 0.112f,
     .ragged = 0.01f,
     .spacing = 62.0f,
     .width{50.0f, 86.0f},
     .length{260.0f, 480.0f},
     .tuft{.width = 0.0f, .hair = 2.2f, .gap = 1.6f, .ink = 0.66f, .dryness = 0.38f},
     .wetness = 8.0f,
     .strength = 1.5f,
     .inside = 0.5f},
    // Streaks of white along the turn.
    {.from = 0.04f,
     .below = 0.32f,
     .ragged = 0.07f,
     .spacing = 112.0f,
     .width{70.0f, 120.0f},
     .length{380.0f, 680.0f},
     .tuft{.width = 0.0f, .hair = 0.8f, .gap = 2.0f, .ink = 0.95f, .dryness = 0.88f},
     .wetness = 0.0f,
     .strength = 1.0f,
     .inside = 0.3f},
};

void BrushWash(Canvas& canvas, Brush& brush, const Wash& wash, std::uint64_t stream) {
  Chance chance(stream, 0);
  brush.Radius(wash.tuft.hair);
  std::uint64_t strokes = 0;
  for (const glm::vec2 middle : SowEvenly(chance, wash.spacing, kSide, 0.0f)) {
    Chance hand(stream, ++strokes);
    const float value = ShadingAt(middle).value;
    if (RimDistance(middle) > 1.0f || value < wash.from || value > wash.below + hand.Bell(wash.ragged)) continue;
    const Flow flow = AroundAxis(kSweep + hand.Bell3(0.08f));
    Stroke line = TraceStroke(flow, middle, hand.Uniform(wash.length.x, wash.length.y));
    if (hand.Happens(0.2f)) std::reverse(line.begin(), line.end());
    Tuft tuft = wash.tuft;
    tuft.width = hand.Uniform(wash.width.x, wash.width.y);
    tuft.ink *= 1.0f + hand.Bell(0.15f);
    tuft.side = hand.Uniform(-0.5f, 0.5f);
    // A sweep does not follow the tone under it, but it avoids the light and ends soon past the rim.
    const float limit = wash.below + 0.14f;
    const float past = 1.02f + hand.Bell(0.015f) - wash.inside * tuft.width / kRadius;
    const Touch touch = [&](glm::vec2 at) {
      return Ramp(limit, limit - 0.12f, ShadingAt(at).value) * Ramp(past + 0.02f, past - 0.04f, RimDistance(at));
    };
    for (const Stroke& piece : Press(line, touch, 1.0f, 0.12f)) {
      // Short pieces would dry as blots.
      const float length = glm::distance(piece.front().at, piece.back().at);
      if (length > std::max(1.8f * tuft.width, 140.0f)) brush.Paint(canvas, PartIntoHairs(hand, piece, tuft));
    }
  }
}

// Ink in wet paper: it runs along the fibres, farther where the sheet is wetter, and leaves a darker line where it
// stops.
void Soak(Ground& ground, const Field& ink, const Wash& wash, std::uint64_t stream) {
  const Field near = Blur(ink, std::max(1.0f, 0.12f * wash.wetness));
  const Field far = Blur(ink, wash.wetness);
  Colors& picture = ground.paper;
  const float scale = static_cast<float>(picture.size) / kSide;
  for (int y = 0; y < picture.size; ++y) {
    for (int x = 0; x < picture.size; ++x) {
      const glm::vec2 at = picture.Place(x, y);
      const glm::vec2 run(CloudNoise(at / 7.0f, 3, Hash(stream, 1)), CloudNoise(at / 7.0f, 3, Hash(stream, 2)));
      const glm::vec2 from = (at + 0.7f * wash.wetness * (run - 0.5f)) * scale;
      const int from_x = static_cast<int>(from.x);
      const int from_y = static_cast<int>(from.y);
      const float crisp = near.Near(from_x, from_y);
      const float bled = far.Near(from_x, from_y);
      const float wet = Ramp(0.40f, 0.70f, CloudNoise(at / 140.0f, 2, Hash(stream, 3)));
      const float amount = glm::mix(crisp, bled, wet);
      if (amount < 0.003f) continue;
      // Saturated paper takes little more where strokes overlap.
      const float drunk = 1.25f * wash.tuft.ink * (1.0f - std::exp(-amount / wash.tuft.ink));
      const float gathered = (1.0f - wet) * 0.5f * std::max(crisp - bled, 0.0f);
      const float grain = 1.0f + 0.22f * (0.5f - ground.tooth.At(x, y));
      picture.At(x, y) *= glm::pow(kThinInk, glm::vec3(wash.strength * (drunk + gathered) * grain));
    }
  }
}

// The contour in a few sweeps: thin and pale towards the light, heavier in the shade.
void DrawContour(Canvas& canvas, Brush& brush, const Studio& studio) {
  Chance chance(studio.seed, kContour);
  const Touch weight = [](glm::vec2 at) { return 0.06f + 0.94f * Ramp(0.15f, 0.9f, DarknessAt(at)); };
  Tuft tuft{.width = 0.0f, .hair = 0.8f, .gap = 1.8f, .ink = 0.75f, .dryness = 0.55f, .narrowest = 0.15f};
  brush.Radius(tuft.hair);
  for (const Stroke& line :
       PlanRim(chance, weight, {.lines = 13, .inset = 1.0f, .length_min = 0.8f, .length_max = 1.9f})) {
    tuft.width = chance.Uniform(14.0f, 26.0f);
    brush.Paint(canvas, PartIntoHairs(chance, line, tuft));
  }
}

}  // namespace

Expected<Picture> PaintSumiE(const Studio& studio) {
  SCUMBLE_ASSIGN(Brush brush, Brush::Load(studio.brushes, "deevad/rigger_brush"));
  brush.Color(kInk).Set(MYPAINT_BRUSH_SETTING_OPAQUE, 1.0f).Set(MYPAINT_BRUSH_SETTING_OPAQUE_LINEARIZE, 0.9f);
  SCUMBLE_ASSIGN(Ground ground, RicePaper({studio.size}, studio));
  std::uint64_t pass = kFirstWash;
  for (const Wash& wash : kWashes) {
    const std::uint64_t stream = Hash(studio.seed, pass++);
    Canvas canvas({studio.size});
    BrushWash(canvas, brush, wash, stream);
    const Layer layer = canvas.Read();
    if (wash.wetness > 0.0f) {
      Soak(ground, Plane(layer, 3), wash, Hash(stream, 0));
    } else {
      RubInto(ground.paper, layer, ground.tooth, kDryBrush);
    }
  }
  Canvas contour({studio.size});
  DrawContour(contour, brush, studio);
  RubInto(ground.paper, contour.Read(), ground.tooth, kDryBrush);
  return ToPicture(ground.paper);
}

Expected<Picture> SumiEPaper(const Studio& studio) {
  SCUMBLE_ASSIGN(const Ground ground, RicePaper(TileFor(studio.size), studio));
  return ToPicture(ground.paper);
}

}  // namespace scumble::paint
